"""The nine states of a conversation as a table: which edge is taken, when, and why.

After Fig. 9 of Maniscalco, Storniolo and Messina (Int. J. of Social Robotics 14, 2022, doi
10.1007/s12369-021-00855-w); outcomes are named as in the program they published, letters as in
the figure. The table is all there is: the diagram in `docs/explanation/engagement.md` is drawn
from it.
"""

from __future__ import annotations

import enum
from collections.abc import Callable
from dataclasses import dataclass, field, replace

from woz_tui.config.engagement import HandshakeSettings, Timeouts
from woz_tui.config.engagement_words import VISITOR
from woz_tui.protocol.sentence import Sentence


class State(enum.StrEnum):
    """Where the conversation is."""

    WAIT = "Wait"
    DETECTED = "PersonDetected"
    UNKNOWN = "EngagedWithUnknown"
    HANDSHAKE = "Handshake"
    KNOWN = "EngagedWithKnown"
    USER_SPEAKS = "UserSpeaks"
    THINKS = "RobotThinks"
    REPLIES = "RobotReplies"
    ROBOT_SPEAKS = "RobotSpeaks"
    STOP = "stop"


class Event(enum.StrEnum):
    """What happens at a moment, beside what is sensed all the time."""

    HANDSHAKE_FAIL = "handshake_fail"
    HANDSHAKE_OK = "handshake_ok"
    REPLY_DONE = "reply_done"
    ROBOT_INITIATIVE = "robot_initiative"
    SAY_DONE = "say_done"
    SPEECH_END = "speech_end"
    SPEECH_ERROR = "speech_error"
    SPEECH_START = "speech_start"
    STOP = "stop"
    THINK_DONE = "think_done"


@dataclass(frozen=True, slots=True)
class ModelView:
    """All that an edge may look at.

    `engaged`: the condition E as it stands now; `lost_for`: seconds for which it has failed, 0
    while it holds. `nameless_for`: seconds for which E has held without a name. `absent_for`:
    seconds for which nobody has been there, 0 while somebody is. `elapsed`: seconds in this state.
    `tries_left`: handshakes that this visitor may still have. `known`: there is a name.
    `replaced`: it is another one than that of whoever spoke. `reason`: what the signs say, in
    words.
    """

    event: Event | None
    presence: bool
    engaged: bool
    known: bool
    reason: str = ""
    elapsed: float = 0.0
    lost_for: float = 0.0
    nameless_for: float = 0.0
    absent_for: float = 0.0
    tries_left: int = 1
    replaced: bool = False
    turns: str = VISITOR
    timeouts: Timeouts = field(default_factory=Timeouts)
    handshake: HandshakeSettings = field(default_factory=HandshakeSettings)


#: What a reason leaves open until its edge is taken.
_REASON = {"reason": "{reason}"}
_ABSENCE = {"absence": "{absence}"}
#: Reasons that are nothing but what the signs say.
BY_SIGNS = Sentence("why.signs", "{reason}", **_REASON)
_BY_ABSENCE = Sentence("why.absence", "{absence}", **_ABSENCE)


@dataclass(frozen=True, slots=True)
class Edge:
    """One arrow. `when` decides; `why` says it in words, where `reason` is open for what the signs
    say and `absence` for those by which nobody is there.

    `letter` is the figure's; an edge without one comes from the published program (`listing`) or
    is an extension of this one, which a setting switches on or off. `unnamed`: nobody means it who
    names its state or outcome: `force` had its own meaning there before the edge was added.
    """

    source: State
    target: State
    outcome: str
    when: Callable[[ModelView], bool]
    why: Sentence
    letter: str = ""
    listing: bool = False
    unnamed: bool = False


def always(view: ModelView) -> bool:
    """Of an edge that is taken by hand, or when another participant comes."""
    return True


def _on(event: Event) -> Callable[[ModelView], bool]:
    return lambda view: view.event is event


def _after(name: str) -> Callable[[ModelView], bool]:
    """The time limit `name` of this state has passed."""

    def passed(view: ModelView) -> bool:
        limit: float | None = getattr(view.timeouts, name)
        return limit is not None and view.elapsed >= limit

    return passed


def _lost(view: ModelView) -> bool:
    return not view.engaged and view.lost_for >= view.timeouts.lost


def _nameless(view: ModelView) -> bool:
    return view.engaged and not view.known and view.nameless_for >= view.timeouts.unrecognized


def _absent(view: ModelView) -> bool:
    limit = view.timeouts.absent
    if limit is None:
        return view.turns == VISITOR and not view.presence
    return view.absent_for >= limit


def _nobody_there(state: State) -> Edge:
    """Out of a state that the paper does not leave before it is over, though the visitor has."""
    why = Sentence("why.nobody_left", "nobody is there any more: {absence}", **_ABSENCE)
    return Edge(state, State.WAIT, "human_absence", _absent, why, unnamed=True)


def _replaced(view: ModelView) -> bool:
    return view.turns == VISITOR and view.replaced


def _unengaged(view: ModelView) -> bool:
    """For so long, and as long as a visitor may be out of engagement outside of a turn, too."""
    limit = view.timeouts.turn_lost
    if limit is None or view.turns != VISITOR or view.engaged:
        return False
    return view.lost_for >= limit


def _left_by_visitor(state: State) -> tuple[Edge, ...]:
    """Out of a turn of whoever spoke, who has gone, was replaced, or attends to something else."""
    another = Sentence("why.another", "somebody else is there: {reason}", **_REASON)
    lost = Sentence("why.unengaged", "not engaged any more: {reason}", **_REASON)
    return (
        _nobody_there(state),
        Edge(state, State.DETECTED, "error", _replaced, another, unnamed=True),
        Edge(state, State.DETECTED, "error", _unengaged, lost, unnamed=True),
    )


def _greets(view: ModelView) -> bool:
    return view.engaged and view.tries_left > 0 and view.handshake.by != "nobody"


# fmt: off
#: Every arrow, in the order in which those of one state are tried: the first that holds is taken.
EDGES: tuple[Edge, ...] = (
    Edge(
        State.WAIT, State.STOP, "end", _on(Event.STOP),
        Sentence("why.by_hand", "ended by hand"), listing=True,
    ),
    Edge(State.WAIT, State.DETECTED, "human_presence", lambda view: view.presence, BY_SIGNS, "a"),
    Edge(
        State.DETECTED, State.WAIT, "human_absence",
        lambda view: not view.presence, _BY_ABSENCE, "b",
    ),
    Edge(
        State.DETECTED, State.KNOWN, "recognized",
        lambda view: view.engaged and view.known, BY_SIGNS, "e",
    ),
    Edge(State.DETECTED, State.UNKNOWN, "unrecognized", _nameless, BY_SIGNS, "c"),
    Edge(
        State.DETECTED, State.WAIT, "human_absence",
        _after("approach"),
        Sentence("why.too_slow", "did not engage in time: {reason}", **_REASON), listing=True,
    ),
    Edge(
        State.UNKNOWN, State.DETECTED, "error", _lost,
        Sentence("why.lost", "engagement lost: {reason}", **_REASON), "d",
    ),
    Edge(
        State.UNKNOWN, State.HANDSHAKE, "handshake", _greets,
        Sentence("why.introduction", "to be introduced"), "g",
    ),
    # Where no handshake leads on (any more), a name that turns up does.
    Edge(
        State.UNKNOWN, State.KNOWN, "recognized",
        lambda view: view.engaged and view.known, BY_SIGNS,
    ),
    Edge(
        State.HANDSHAKE, State.KNOWN, "eng2know",
        _on(Event.HANDSHAKE_OK), Sentence("why.introduced", "introduced"), "i",
    ),
    Edge(
        State.HANDSHAKE, State.UNKNOWN, "eng2unknow",
        _on(Event.HANDSHAKE_FAIL), Sentence("why.handshake_failed", "the handshake failed"), "h",
    ),
    Edge(
        State.HANDSHAKE, State.UNKNOWN, "eng2unknow",
        lambda view: view.elapsed >= view.handshake.seconds,
        Sentence("why.handshake_long", "the handshake took too long"), "h",
    ),
    _nobody_there(State.HANDSHAKE),
    Edge(
        State.KNOWN, State.DETECTED, "error", _lost,
        Sentence("why.lost", "engagement lost: {reason}", **_REASON), "f",
    ),
    Edge(
        State.KNOWN, State.USER_SPEAKS, "listening", _on(Event.SPEECH_START),
        Sentence("why.speaks", "somebody speaks"), "l"
    ),
    Edge(
        State.KNOWN, State.ROBOT_SPEAKS, "speaking",
        _on(Event.ROBOT_INITIATIVE), Sentence("why.robot_begins", "the robot begins"), "p",
    ),
    Edge(
        State.USER_SPEAKS, State.THINKS, "done", _on(Event.SPEECH_END),
        Sentence("why.speech_over", "speech has ended"), "m",
    ),
    Edge(
        State.USER_SPEAKS, State.KNOWN, "error",
        _on(Event.SPEECH_ERROR),
        Sentence("why.not_understood", "nothing was understood"), listing=True,
    ),
    Edge(
        State.USER_SPEAKS, State.KNOWN, "error",
        _after("listening"), Sentence("why.speech_long", "the speech does not end"), listing=True,
    ),
    *_left_by_visitor(State.USER_SPEAKS),
    Edge(
        State.THINKS, State.REPLIES, "done", _on(Event.THINK_DONE),
        Sentence("why.answer", "there is an answer"), "n",
    ),
    Edge(
        State.THINKS, State.KNOWN, "error", _after("thinking"),
        Sentence("why.no_answer", "nobody has answered"),
    ),
    *_left_by_visitor(State.THINKS),
    Edge(
        State.REPLIES, State.KNOWN, "done", _on(Event.REPLY_DONE),
        Sentence("why.answer_over", "the answer is over"), "o",
    ),
    Edge(
        State.REPLIES, State.KNOWN, "error", _after("talking"),
        Sentence("why.answer_long", "the answer does not end"),
    ),
    *_left_by_visitor(State.REPLIES),
    Edge(
        State.ROBOT_SPEAKS, State.KNOWN, "done",
        _on(Event.SAY_DONE), Sentence("why.sentence_over", "the robot's sentence is over"), "q",
    ),
    Edge(
        State.ROBOT_SPEAKS, State.KNOWN, "error", _after("talking"),
        Sentence("why.speech_long", "the speech does not end"),
    ),
    _nobody_there(State.ROBOT_SPEAKS),
)

# fmt: on
#: States in which somebody talks with the robot: sounds from elsewhere may distract it or not.
ENGAGED = frozenset(
    {
        *(State.UNKNOWN, State.HANDSHAKE, State.KNOWN),
        *(State.USER_SPEAKS, State.THINKS, State.REPLIES, State.ROBOT_SPEAKS),
    }
)
#: Turns of the visitor who spoke: what they say, and the answer to it.
TURN = frozenset({State.USER_SPEAKS, State.THINKS, State.REPLIES})
#: Outcomes by which the wizard may name an edge.
OUTCOMES = tuple(dict.fromkeys(edge.outcome for edge in EDGES))


def edges_from(state: State) -> tuple[Edge, ...]:
    """The arrows that leave a state, first come first."""
    return _FROM.get(state, ())


def named_from(state: State) -> tuple[Edge, ...]:
    """Those of them that `force` may mean."""
    return tuple(edge for edge in edges_from(state) if not edge.unnamed)


def by_signs(edge: Edge, view: ModelView) -> bool:
    """Whether an arrow that holds does so by the signs alone: without event, without time limit."""
    return edge.when(replace(view, event=None, elapsed=0.0))


def edge_to(state: State, to: str) -> Edge:
    """The arrow that somebody means who names a state, or an outcome of the present one.

    Where the table has no such arrow its outcome is `forced`. Raises `ValueError` with a sentence
    if there is no such state or outcome, or if it is the present state.
    """
    edges = named_from(state)
    for edge in edges:
        if to == edge.outcome:
            return edge
    if to == state:
        raise ValueError(f"it is {to} already")
    if to not in {each.value for each in State}:
        leave = ", ".join(dict.fromkeys(edge.outcome for edge in edges))
        known = f" ({leave})" if leave else ""
        raise ValueError(f"{to!r} is neither a state nor an outcome of {state}{known}")
    arrows = (edge for edge in edges if edge.target == to)
    return next(arrows, Edge(state, State(to), "forced", always, BY_SIGNS))


_FROM: dict[State, tuple[Edge, ...]] = {
    state: tuple(edge for edge in EDGES if edge.source is state) for state in State
}
