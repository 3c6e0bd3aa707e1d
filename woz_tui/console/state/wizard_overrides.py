"""The wizard's overrides of the engagement model: keys, requests, legend, sentences."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, field

from woz_tui.config.engagement_words import STATES
from woz_tui.config.performers import ENGAGEMENT
from woz_tui.config.screen_language import say, word
from woz_tui.console.drawing.cells import Row, clean, cut, length
from woz_tui.console.drawing.glyphs import Glyphs
from woz_tui.console.state.engagement import HOLD, OFF, EngagementView
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import EngagementShown, Json
from woz_tui.protocol.requests import AskVerb
from woz_tui.protocol.sentence import Sentence
from woz_tui.sensing.state_machine import State, named_from


@dataclass(frozen=True, slots=True)
class Override:
    """One thing that the wizard can do to the model: its id and key, one or two words for the
    legend, what it does, the request. Without a verb a dialog must be filled in first.
    """

    id: str
    key: str
    brief: Sentence
    does: Sentence
    verb: str = ""
    args: Mapping[str, Json] = field(default_factory=dict)

    @property
    def text(self) -> str:
        """What it does, for lists that have other things, too."""
        return say("engagement.of_model", "engagement: {does}", does=word(self.does))


OVERRIDES = (
    Override(
        "presence",
        "p",
        Sentence("engagement.person", "person"),
        Sentence("engagement.does_presence", "somebody is there, or nobody (by hand)"),
        "toggle",
        {"sign": "presence"},
    ),
    Override(
        "gaze",
        "g",
        Sentence("engagement.looks", "looks"),
        Sentence("engagement.does_gaze", "looks at the robot, or away (by hand)"),
        "toggle",
        {"sign": "gaze"},
    ),
    Override(
        "near",
        "d",
        Sentence("engagement.near", "near"),
        Sentence("engagement.does_near", "near enough, or too far (by hand)"),
        "toggle",
        {"sign": "distance"},
    ),
    Override(
        "sensors",
        "s",
        Sentence("engagement.key_sensors", "sensors"),
        Sentence("engagement.does_sensors", "all signs back to their sensors"),
        "sense",
        {"sign": "all", "value": "sensor"},
    ),
    Override(
        "identity",
        "i",
        Sentence("engagement.key_identity", "identity"),
        Sentence("engagement.does_identity", "who it is (by hand)"),
    ),
    Override(
        "hold",
        "h",
        Sentence("engagement.key_hold", "hold/run"),
        Sentence("engagement.does_hold", "hold it in this state, or let it run"),
        "engagement",
        {"run": HOLD},
    ),
    Override(
        "step",
        "n",
        Sentence("engagement.key_step", "step"),
        Sentence("engagement.does_step", "make the one change that is held back"),
        "engagement",
        {"run": "step"},
    ),
    Override(
        "force",
        "f",
        Sentence("engagement.key_force", "force"),
        Sentence("engagement.does_force", "force a state, whatever the signs say"),
    ),
    Override(
        "off",
        "o",
        Sentence("engagement.key_off", "off/run"),
        Sentence("engagement.does_off", "switch the model off, or on"),
        "engagement",
        {"run": OFF},
    ),
    Override(
        "visitor",
        "v",
        Sentence("engagement.visitor", "visitor"),
        Sentence("engagement.does_visitor", "name the visitor who stands there"),
    ),
    Override(
        "greeted",
        "k",
        Sentence("engagement.key_greeted", "known"),
        Sentence("engagement.does_greeted", "the visitor has said a name"),
        "handshake",
        {"what": "ok"},
    ),
    Override(
        "unknown",
        "x",
        Sentence("meters.unknown", "unknown"),
        Sentence("engagement.does_unknown", "the visitor has said no name"),
        "handshake",
        {"what": "fail"},
    ),
)
BY_KEY = {order.key: order for order in OVERRIDES}
KEYS = frozenset(BY_KEY)


def is_offered(engaged: EngagementView, verbs: dict[str, list[str]]) -> bool:
    """Whether this session has a model that takes overrides."""
    return engaged.session.model.shown is not None or ENGAGEMENT in verbs


def verb_request(name: str, args: dict[str, Json], key: str = "") -> AskVerb:
    """The request for one of the model's verbs."""
    source = "key" if key else "palette"
    return AskVerb(verb=name, args=args, on=ENGAGEMENT, source=source, key=key)


def override_request(order: Override, engaged: EngagementView, key: str = "") -> AskVerb:
    """What `order` asks for as things stand; only for those that need no dialog."""
    args = dict(order.args)
    shown = engaged.session.model.shown
    if shown is not None and shown.run == args.get("run"):
        args["run"] = "run"  # pressed again it lets the machine run
    return verb_request(order.verb, args, key)


def needs_name(engaged: EngagementView) -> bool:
    """Whether a handshake cannot end well because nobody has a name yet."""
    shown = engaged.session.model.shown
    if shown is None:
        return False
    identity = shown.signs.get("identity")
    named = identity is not None and identity.name not in ("", "Unknown")
    return not shown.visitor and not named


def forceable(shown: EngagementShown | None) -> list[tuple[str, str]]:
    """What may be forced: outcomes that leave the present state with the state that each leads
    to, then all other states with nothing behind them.
    """
    here = shown.state if shown is not None else ""
    edges = named_from(State(here)) if here in set(State) else ()
    found = dict.fromkeys((edge.outcome, edge.target.value) for edge in edges)
    reached = {state for _, state in found}
    rest = [state for state in STATES if state not in reached and state != here]
    return [*found, *((state, "") for state in rest)]


#: How the model runs.
_RUNS: Mapping[str, Sentence] = {
    "run": Sentence("engagement.runs", "runs"),
    "hold": Sentence("engagement.held", "held"),
    "off": Sentence("engagement.is_switched_off", "off"),
    "step": Sentence("engagement.one_step", "one step"),
}
#: What a sign is set to.
_FLAGS: Mapping[str, Sentence] = {
    "on": Sentence("meters.says_yes", "yes"),
    "off": Sentence("meters.says_no", "no"),
    "sensor": Sentence("engagement.to_sensor", "back to its sensor"),
}
Args = Mapping[str, Json]
#: A sign by its name.
SIGN_NAMES: Mapping[str, Sentence] = {
    "presence": Sentence("engagement.presence", "presence"),
    "gaze": Sentence("engagement.gaze", "gaze"),
    "distance": Sentence("engagement.distance", "distance"),
    "identity": Sentence("engagement.identity", "identity"),
}


def override_text(verb: str, args: Args) -> str:
    """`gaze the other way, by hand`; any arguments do, the log of another version may hold any."""
    texts = _texts(args)
    match verb:
        case "sense":
            return _sense(texts)
        case "filter":
            given = (texts[each] for each in ("kind", "samples", "threshold"))
            values = " ".join(filter(None, (_sign(texts), *given)))
            return say("engagement.filter_of", "filter of {values}", values=values)
        case "visitor":
            named = say("engagement.visitor_named", "visitor {name}", name=texts["code"])
            return ", ".join(filter(None, (named, texts["age_group"], texts["address"])))
        case "engagement":
            how = word(_RUNS.get(texts["run"], texts["run"]))
            return say("engagement.model_runs", "engagement {how}", how=how)
        case "toggle":
            sign = _sign(texts)
            return say("engagement.toggled", "{sign} the other way, by hand", sign=sign)
        case "force":
            return say("engagement.forced", "force {to}", to=texts["to"]).rstrip()
        case "social_distance":
            metres = texts["metres"]
            return say("engagement.near_up_to", "near: up to {metres} m", metres=metres)
        case "attend":
            return say("engagement.attention", "attention {mode}", mode=texts["mode"]).rstrip()
        case "handshake":
            what, code = texts["what"], texts["code"]
            told = say("engagement.handshake", "handshake {what} {code}", what=what, code=code)
            return told.rstrip()
    return " ".join(str(part) for part in (verb, *args.values()) if part not in ("", None))


def toggled_text(message: m.Message) -> str:
    """How a sign is after the wizard has turned it the other way; else nothing."""
    if isinstance(message, m.Done) and message.driver == ENGAGEMENT and "value" in message.sent:
        return _sense(_texts(message.sent))
    return ""


def _texts(args: Args) -> defaultdict[str, str]:
    return defaultdict(
        str,
        {
            name: f"{value:g}" if isinstance(value, float) else "" if value is None else str(value)
            for name, value in args.items()
        },
    )


def _sense(texts: Mapping[str, str]) -> str:
    sign, value = texts["sign"], texts["value"]
    if sign == "all" and value == "sensor":
        return say("engagement.does_sensors", "all signs back to their sensors")
    shown = word(_FLAGS.get(value, f"{value} m" if sign == "distance" else value))
    named = f"{_sign(texts)} {shown}"
    if value == "sensor":
        return named
    return say("engagement.set_by_hand", "{sign}, by hand", sign=named)


def _sign(texts: Mapping[str, str]) -> str:
    """The sign that is named, as the screen calls it."""
    return word(SIGN_NAMES.get(texts["sign"], texts["sign"]))


def is_override(command: m.Command | m.FilledCall) -> bool:
    """Whether a command is for the engagement model."""
    return command.driver == ENGAGEMENT


#: Lines of the legend at the most.
HEIGHT = 4


def legend_rows(
    engaged: EngagementView, covered: Mapping[str, str], width: int, glyphs: Glyphs, *, steers: bool
) -> list[Row]:
    """What the keys do, on as few lines as they fill; quiet where one would do nothing now.
    `covered`: key of an override that else plays an action -> its label.
    """
    rows: list[Row] = [()]
    if not steers:
        keys = " ".join(order.key for order in OVERRIDES)
        rows[0] = (
            (f"{say('engagement.keys_play', 'Keys play the robot.')} ", "muted"),
            (" tab ", "key"),
            (f" {say('engagement.tab_steers', 'lets you set the model by hand:')} ", "plain"),
            (keys, "muted"),
        )
        return [cut(rows[0], width, glyphs.ellipsis)]
    shown = engaged.session.model.shown
    for order in OVERRIDES:
        does = shown is not None
        if order.id == "step":
            does = engaged.held
        elif order.id in ("greeted", "unknown"):
            does = shown is not None and shown.state == "Handshake"
        piece: Row = (
            (f" {order.key} ", "key" if does else "muted"),
            (f" {word(order.brief)}  ", "plain" if does else "muted"),
        )
        if rows[-1] and length(rows[-1]) + length(piece) > width:
            rows.append(())
        rows[-1] += piece
    if covered:
        told = ", ".join(f"{key} {clean(label)}" for key, label in covered.items())
        told = say("engagement.covered", "these play nothing meanwhile: {keys}", keys=told)
        rows.append(((f"{glyphs.warning} {told}", "warn"),))
    return [cut(row, width, glyphs.ellipsis) for row in rows[:HEIGHT]]
