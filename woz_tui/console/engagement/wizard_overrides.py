"""The wizard's overrides of the engagement model: keys, requests, legend, sentences."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from woz_tui.config.engagement import STATES
from woz_tui.config.session_verbs import ENGAGEMENT
from woz_tui.console.cells import Row, clean, cut, length
from woz_tui.console.engagement.engagement_view import HOLD, OFF, EngagementView
from woz_tui.console.glyphs import Glyphs
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import EngagementShown, Json
from woz_tui.protocol.requests import AskVerb
from woz_tui.sensing.state_machine import State, named_from

RUN, STEP, SENSOR = "run", "step", "sensor"


@dataclass(frozen=True, slots=True)
class Override:
    """One thing that the hand does: its id and key, one or two words for the legend, a sentence
    for the lists. `asks`: a dialog must be filled in first.
    """

    id: str
    key: str
    word: str
    text: str
    asks: bool = False


OVERRIDES = (
    Override("presence", "p", "person", "engagement: somebody is there, or nobody (by hand)"),
    Override("gaze", "g", "looks", "engagement: looks at the robot, or away (by hand)"),
    Override("near", "d", "near", "engagement: near enough, or too far (by hand)"),
    Override("sensors", "s", "sensors", "engagement: all signs back to their sensors"),
    Override("identity", "i", "identity", "engagement: who it is (by hand)", asks=True),
    Override("hold", "h", "hold/run", "engagement: hold the machine, or let it run"),
    Override("step", "n", "step", "engagement: take the edge that is held back"),
    Override("force", "f", "force", "engagement: force a state or an outcome", asks=True),
    Override("off", "o", "off/run", "engagement: switch the machine off, or on"),
    Override("visitor", "v", "visitor", "engagement: name the visitor who stands there", asks=True),
    Override("greeted", "k", "known", "engagement: the handshake worked"),
    Override("unknown", "x", "unknown", "engagement: the handshake failed"),
)
BY_KEY = {order.key: order for order in OVERRIDES}
BY_ID = {order.id: order for order in OVERRIDES}
KEYS = frozenset(BY_KEY)


def is_offered(engaged: EngagementView, verbs: dict[str, list[str]]) -> bool:
    """Whether this session has a model that can be told anything."""
    return engaged.shown is not None or ENGAGEMENT in verbs


def verb_request(name: str, args: dict[str, Json], key: str = "") -> AskVerb:
    """The request for one of the model's verbs."""
    source = "key" if key else "palette"
    return AskVerb(verb=name, args=args, on=ENGAGEMENT, source=source, key=key)


def override_request(order: Override, engaged: EngagementView, key: str = "") -> AskVerb:
    """What `order` asks for as things stand; only for those that need no dialog."""
    name, args = _REQUESTS[order.id](engaged)
    return verb_request(name, args, key)


def needs_name(engaged: EngagementView) -> bool:
    """Whether a handshake cannot end well because nobody has a name yet."""
    shown = engaged.shown
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


_Made = tuple[str, dict[str, Json]]


def _toggle(sign: str) -> Callable[[EngagementView], _Made]:
    return lambda engaged: ("toggle", {"sign": sign})


def _run(to: str) -> Callable[[EngagementView], _Made]:
    def made(engaged: EngagementView) -> _Made:
        there = engaged.shown is not None and engaged.shown.run == to
        return "engagement", {"run": RUN if there else to}

    return made


_REQUESTS: dict[str, Callable[[EngagementView], _Made]] = {
    "presence": _toggle("presence"),
    "gaze": _toggle("gaze"),
    "near": _toggle("distance"),
    "sensors": lambda engaged: ("sense", {"sign": "all", "value": SENSOR}),
    "hold": _run(HOLD),
    "off": _run(OFF),
    "step": lambda engaged: ("engagement", {"run": STEP}),
    "greeted": lambda engaged: ("handshake", {"what": "ok"}),
    "unknown": lambda engaged: ("handshake", {"what": "fail"}),
}


_RUNS = {"run": "runs", "hold": "held", "off": "off", "step": "one step"}
_FLAGS = {"on": "yes", "off": "no", "sensor": "back to its sensor"}
Args = Mapping[str, Json]


def override_text(verb: str, args: Args) -> str:
    """`gaze the other way, by hand`; any arguments do, the log of another version may hold any."""
    tell = _SENTENCES.get(verb)
    if tell is not None:
        return tell(args)
    return " ".join(str(part) for part in (verb, *args.values()) if part not in ("", None))


def toggled_text(message: m.Message) -> str:
    """How a sign is after the wizard has turned it the other way; else nothing."""
    if isinstance(message, m.Done) and message.driver == ENGAGEMENT and "value" in message.sent:
        return _sense(message.sent)
    return ""


def _text(args: Args, name: str) -> str:
    value = args.get(name, "")
    return f"{value:g}" if isinstance(value, float) else "" if value is None else str(value)


def _sense(args: Args) -> str:
    sign, value = _text(args, "sign"), _text(args, "value")
    if sign == "all" and value == "sensor":
        return "all signs back to their sensors"
    said = _FLAGS.get(value, f"{value} m" if sign == "distance" else value)
    return f"{sign} {said}" if value == "sensor" else f"{sign} {said}, by hand"


def _filter(args: Args) -> str:
    told = [_text(args, name) for name in ("kind", "samples", "threshold")]
    return " ".join(["filter of", _text(args, "sign"), *(part for part in told if part)])


def _visitor(args: Args) -> str:
    about = [_text(args, name) for name in ("age_group", "address")]
    return ", ".join([f"visitor {_text(args, 'code')}", *(part for part in about if part)])


_SENTENCES: Mapping[str, Callable[[Args], str]] = {
    "toggle": lambda args: f"{_text(args, 'sign')} the other way, by hand",
    "sense": _sense,
    "force": lambda args: f"force {_text(args, 'to')}",
    "engagement": lambda args: f"engagement {_RUNS.get(_text(args, 'run'), _text(args, 'run'))}",
    "filter": _filter,
    "social_distance": lambda args: f"near: up to {_text(args, 'metres')} m",
    "attend": lambda args: f"attention {_text(args, 'mode')}",
    "handshake": lambda args: f"handshake {_text(args, 'what')} {_text(args, 'code')}".rstrip(),
    "visitor": _visitor,
}


def is_override(command: m.Command | m.FilledCall) -> bool:
    """Whether it is for the model, as far as it says for whom it is."""
    return command.driver == ENGAGEMENT or (not command.driver and command.verb in _SENTENCES)


#: Lines of the legend at the most.
HEIGHT = 4


def legend_rows(
    engaged: EngagementView, covered: Mapping[str, str], width: int, glyphs: Glyphs, *, steers: bool
) -> list[Row]:
    """`covered`: keys of the hand that else play an action -> the action's label."""
    if steers:
        rows = _orders(engaged, width)
        rows += [_covered(covered, glyphs)] if covered else []
    else:
        keys = " ".join(order.key for order in OVERRIDES)
        rows = [
            (
                ("Keys play the robot. ", "muted"),
                (" tab ", "key"),
                (" takes the model in hand: ", "plain"),
                (keys, "muted"),
            )
        ]
    return [cut(row, width, glyphs.ellipsis) for row in rows[:HEIGHT]]


def _orders(engaged: EngagementView, width: int) -> list[Row]:
    """The hand's keys on as few lines as they fill; those that would do nothing now are pale."""
    rows: list[Row] = [()]
    for order in OVERRIDES:
        now = _counts(order, engaged)
        piece: Row = (
            (f" {order.key} ", "key" if now else "muted"),
            (f" {order.word}  ", "plain" if now else "faint"),
        )
        if rows[-1] and length(rows[-1]) + length(piece) > width:
            rows.append(())
        rows[-1] += piece
    return rows


def _counts(order: Override, engaged: EngagementView) -> bool:
    shown = engaged.shown
    if shown is None:
        return False
    if order.id == "step":
        return engaged.held
    if order.id in ("greeted", "unknown"):
        return shown.state == "Handshake"
    return True


def _covered(covered: Mapping[str, str], glyphs: Glyphs) -> Row:
    told = ", ".join(f"{key} {clean(label)}" for key, label in covered.items())
    return ((f"{glyphs.warning} not played meanwhile: {told}", "warn"),)
