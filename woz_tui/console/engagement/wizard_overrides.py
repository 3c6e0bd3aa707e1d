"""The wizard's hand on the model: each of its keys, and what it asks of the robot process."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from woz_tui.config.engagement import STATES
from woz_tui.config.session_verbs import ENGAGEMENT
from woz_tui.console.engagement.engagement_view import HOLD, OFF, EngagementView
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
