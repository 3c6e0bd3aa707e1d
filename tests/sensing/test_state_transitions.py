"""Every edge of the table, by its outcome (E5), and the time limits that the settings give."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.sensing.visitor_samples import GONE, WITH, Visit, nobody_greets
from woz_tui.config.engagement import EngagementSettings, HandshakeSettings, Timeouts
from woz_tui.config.engagement_words import OUTCOMES, STATES, STOPPED
from woz_tui.sensing import state_machine
from woz_tui.sensing.engagement_model import Transition
from woz_tui.sensing.state_machine import (
    EDGES,
    Event,
    ModelView,
    State,
    edge_to,
    edges_from,
)

#: The table of the paper and of the published listing: from, to, outcome.
PAPER = {
    ("Wait", "PersonDetected", "human_presence"),
    ("PersonDetected", "Wait", "human_absence"),
    ("PersonDetected", "EngagedWithUnknown", "unrecognized"),
    ("EngagedWithUnknown", "PersonDetected", "error"),
    ("PersonDetected", "EngagedWithKnown", "recognized"),
    ("EngagedWithKnown", "PersonDetected", "error"),
    ("EngagedWithUnknown", "Handshake", "handshake"),
    ("Handshake", "EngagedWithUnknown", "eng2unknow"),
    ("Handshake", "EngagedWithKnown", "eng2know"),
    ("EngagedWithKnown", "UserSpeaks", "listening"),
    ("UserSpeaks", "RobotThinks", "done"),
    ("RobotThinks", "RobotReplies", "done"),
    ("RobotReplies", "EngagedWithKnown", "done"),
    ("EngagedWithKnown", "RobotSpeaks", "speaking"),
    ("RobotSpeaks", "EngagedWithKnown", "done"),
    ("UserSpeaks", "EngagedWithKnown", "error"),
    ("Wait", "stop", "end"),
}
#: What this model adds: time limits that are off or long, a name where nobody greets, and that a
#: turn ends whose visitor has left it.
BEYOND = {
    ("RobotThinks", "EngagedWithKnown", "error"),
    ("RobotReplies", "EngagedWithKnown", "error"),
    ("RobotSpeaks", "EngagedWithKnown", "error"),
    ("EngagedWithUnknown", "EngagedWithKnown", "recognized"),
    *(
        (busy, "Wait", "human_absence")
        for busy in ("Handshake", "UserSpeaks", "RobotThinks", "RobotReplies", "RobotSpeaks")
    ),
    *((turn, "PersonDetected", "error") for turn in ("UserSpeaks", "RobotThinks", "RobotReplies")),
}


def arrow(change: Transition | None) -> tuple[str, str, str] | None:
    """From, to, outcome; why is always said."""
    if change is None:
        return None
    assert change.why
    return change.was, change.now, change.outcome


def arrows(changes: list[Transition]) -> list[tuple[str, str, str] | None]:
    return [arrow(change) for change in changes]


def test_the_table_has_the_papers_edges_and_says_which_it_adds() -> None:
    """E5."""
    edges = {(edge.source.value, edge.target.value, edge.outcome) for edge in EDGES}
    assert edges == PAPER | BEYOND
    assert {state.value for state in State} == {*STATES, STOPPED}
    assert set(state_machine.OUTCOMES) == set(OUTCOMES)


def test_each_letter_of_the_figure_stands_for_one_change_of_state() -> None:
    by_letter: dict[str, set[tuple[str, str]]] = {}
    for edge in EDGES:
        if edge.letter:
            by_letter.setdefault(edge.letter, set()).add((edge.source, edge.target))
    assert sorted(by_letter) == list("abcdefghilmnopq")
    assert all(len(pairs) == 1 for pairs in by_letter.values())


# -- each edge, taken ---------------------------------------------------------------------------


def test_presence_alone_is_a_person_detected() -> None:
    """E5: human_presence."""
    assert arrows(Visit().see(presence=1)) == [("Wait", "PersonDetected", "human_presence")]
    assert Visit().see(gaze=1, distance=0.5, identity="Anna") == []


def test_a_person_who_leaves_is_absent() -> None:
    """E5: human_absence."""
    visit = Visit()
    visit.see(presence=1)
    assert arrows(visit.see(presence=0)) == [("PersonDetected", "Wait", "human_absence")]


def test_all_signs_with_and_without_a_name() -> None:
    """E5: recognized, unrecognized, and the handshake that follows."""
    stranger, anna = Visit(), Visit()
    assert arrows(stranger.see(3, **WITH, identity="Unknown")) == [
        ("Wait", "PersonDetected", "human_presence"),
        ("PersonDetected", "EngagedWithUnknown", "unrecognized"),
        ("EngagedWithUnknown", "Handshake", "handshake"),
    ]
    assert arrows(anna.see(3, **WITH, identity="Anna")) == [
        ("Wait", "PersonDetected", "human_presence"),
        ("PersonDetected", "EngagedWithKnown", "recognized"),
    ]


@pytest.mark.parametrize("lacking", [{"gaze": 0}, {"distance": 1.4}, {"presence": 0}])
def test_one_sign_that_says_no_engages_nobody(lacking: dict[str, float]) -> None:
    visit = Visit()
    changes = visit.see(9, **{**WITH, **lacking}, identity="Anna")
    assert {change.now for change in changes} <= {"PersonDetected"}


@pytest.mark.parametrize("lost", [{"gaze": 0}, {"distance": 1.4}, {"presence": 0}])
def test_whoever_is_known_is_lost_as_they_were_found(lost: dict[str, float]) -> None:
    """E5: error out of EngagedWithKnown; the same condition begins and continues."""
    changes = Visit().engage().see(**{**WITH, **lost})
    assert arrows(changes) == [("EngagedWithKnown", "PersonDetected", "error")]


def test_whoever_has_no_name_is_lost_too() -> None:
    """E5: error out of EngagedWithUnknown."""
    visit = Visit(handshake=nobody_greets())
    visit.see(3, **WITH)
    assert visit.model.state is State.UNKNOWN
    assert arrows(visit.see(**{**WITH, "gaze": 0})) == [
        ("EngagedWithUnknown", "PersonDetected", "error")
    ]


def test_a_handshake_ends_well_or_not() -> None:
    """E5: eng2know, eng2unknow."""
    assert arrow(Visit().meet().event(Event.HANDSHAKE_OK)) == (
        *("Handshake", "EngagedWithKnown", "eng2know"),
    )
    visit = Visit().meet()
    assert arrow(visit.event(Event.HANDSHAKE_FAIL)) == (
        *("Handshake", "EngagedWithUnknown", "eng2unknow"),
    )
    assert arrows(visit.see(**WITH)) == [("EngagedWithUnknown", "Handshake", "handshake")]


def test_a_conversation() -> None:
    """E5: listening, done, done, done; speaking, done; error."""
    visit = Visit().engage()
    said = [
        (Event.SPEECH_START, ("EngagedWithKnown", "UserSpeaks", "listening")),
        (Event.SPEECH_END, ("UserSpeaks", "RobotThinks", "done")),
        (Event.THINK_DONE, ("RobotThinks", "RobotReplies", "done")),
        (Event.REPLY_DONE, ("RobotReplies", "EngagedWithKnown", "done")),
        (Event.ROBOT_INITIATIVE, ("EngagedWithKnown", "RobotSpeaks", "speaking")),
        (Event.SAY_DONE, ("RobotSpeaks", "EngagedWithKnown", "done")),
        (Event.SPEECH_START, ("EngagedWithKnown", "UserSpeaks", "listening")),
        (Event.SPEECH_ERROR, ("UserSpeaks", "EngagedWithKnown", "error")),
    ]
    for event, expected in said:
        assert arrow(visit.event(event)) == expected


def test_the_end_comes_out_of_wait_alone() -> None:
    """E5: end; the terminal state is left by nothing."""
    visit = Visit()
    assert arrow(visit.event(Event.STOP)) == ("Wait", "stop", "end")
    assert visit.see(9, **WITH) == []
    assert all(visit.event(event) is None for event in Event)
    assert Visit().engage().event(Event.STOP) is None


BUSY = {
    State.USER_SPEAKS: [Event.SPEECH_START],
    State.THINKS: [Event.SPEECH_START, Event.SPEECH_END],
    State.REPLIES: [Event.SPEECH_START, Event.SPEECH_END, Event.THINK_DONE],
    State.ROBOT_SPEAKS: [Event.ROBOT_INITIATIVE],
}


@pytest.mark.parametrize("state", BUSY)
def test_in_the_paper_whoever_leaves_while_they_talk_is_noticed_afterwards(state: State) -> None:
    visit = Visit(turns="paper").engage()
    for event in BUSY[state]:
        visit.event(event)
    assert visit.model.state is state
    assert visit.see(9, **GONE) == []
    back = {State.USER_SPEAKS: Event.SPEECH_ERROR, State.REPLIES: Event.REPLY_DONE}
    if state is State.THINKS:
        visit.event(Event.THINK_DONE)
    visit.event(back.get(state, Event.REPLY_DONE if state is State.THINKS else Event.SAY_DONE))
    assert arrows(visit.see(2, **GONE)) == [
        ("EngagedWithKnown", "PersonDetected", "error"),
        ("PersonDetected", "Wait", "human_absence"),
    ]


def busy(state: State, **settings: Any) -> Visit:
    """Anna, or a stranger who is asked for a name, in one of the states that last."""
    visit = Visit(**settings)
    if state is State.HANDSHAKE:
        return visit.meet()
    visit.engage()
    for event in BUSY[state]:
        visit.event(event)
    assert visit.model.state is state
    return visit


@pytest.mark.parametrize("state", [State.HANDSHAKE, *BUSY])
def test_nobody_is_engaged_who_has_gone(state: State) -> None:
    """Where the file says nothing: with the sample by which presence says 0."""
    visit = busy(state)
    (change,) = visit.see(**GONE)
    assert arrow(change) == (state.value, "Wait", "human_absence")
    assert change.why == "nobody is there any more: nobody is there"
    assert not change.forced


TURNS = [State.USER_SPEAKS, State.THINKS, State.REPLIES]


@pytest.mark.parametrize("state", TURNS)
def test_a_turn_is_not_handed_on_to_somebody_else(state: State) -> None:
    visit = busy(state)
    assert visit.wait(20, **WITH, identity="Unknown") == [], "a face that is not seen is nobody"
    assert visit.model.shown().visitor == "Anna"
    left, met = visit.see(2, **WITH, identity="Bert")
    assert arrow(left) == (state.value, "PersonDetected", "error")
    assert left.why.startswith("somebody else is there: ")
    assert arrow(met) == ("PersonDetected", "EngagedWithKnown", "recognized")
    assert (left.visitor, met.visitor) == ("Bert", "Bert")


@pytest.mark.parametrize("state", TURNS)
def test_a_turn_ends_whose_visitor_attends_to_something_else(state: State) -> None:
    away = {**WITH, "gaze": 0}
    visit = busy(state, timeouts=Timeouts(unengaged=10.0))
    assert visit.wait(9, **away) == []
    assert visit.see(**WITH) == [], "a glance back, and the time begins anew"
    assert visit.wait(9, **away) == []
    (change,) = visit.wait(2, **away)
    assert arrow(change) == (state.value, "PersonDetected", "error")
    assert change.why.startswith("not engaged any more: ")


def test_in_a_turn_nobody_is_lost_sooner_than_out_of_one() -> None:
    told = EngagementSettings(timeouts=Timeouts(unengaged=5.0, lost=10.0)).limits
    assert told["unengaged"] == 10.0
    visit = busy(State.THINKS, timeouts=Timeouts(unengaged=5.0, lost=10.0))
    assert visit.wait(9, **{**WITH, "gaze": 0}) == []
    assert len(visit.wait(2, **{**WITH, "gaze": 0})) == 1


@pytest.mark.parametrize("state", TURNS)
def test_in_the_paper_a_turn_is_over_when_it_is_over_and_names_whoever_spoke(state: State) -> None:
    visit = busy(state, turns="paper", timeouts=Timeouts(talking=None, listening=None))
    assert visit.wait(30, **{**WITH, "gaze": 0}) == visit.wait(30, **WITH, identity="Bert") == []
    assert visit.wait(30, **GONE) == []
    assert visit.model.shown().visitor == "Anna"


def test_after_the_answer_the_visitor_is_whoever_is_there() -> None:
    visit = busy(State.REPLIES, turns="paper")
    visit.see(**WITH, identity="Bert")
    change = visit.event(Event.REPLY_DONE)
    assert change is not None
    assert (change.now, change.visitor) == ("EngagedWithKnown", "Bert")


def test_a_name_that_the_wizard_corrects_is_not_somebody_else() -> None:
    visit = busy(State.THINKS)
    visit.model.override("identity", "Bert")
    assert visit.see(2, **WITH) == []
    visit.model.take_name("Carla")
    assert visit.see(2, **WITH) == []
    assert visit.model.shown().visitor == "Carla"


def test_whom_the_wizard_has_put_there_may_ask_and_get_an_answer() -> None:
    """No sensor sees anybody; the signs count again once they say something else than then."""
    visit = Visit()
    visit.see(**GONE)
    visit.model.force("EngagedWithKnown")
    for event in BUSY[State.REPLIES]:
        assert visit.event(event) is not None
        assert visit.wait(20, **GONE) == []
    visit.see(**WITH)
    assert [arrow(change) for change in visit.see(2, **GONE)] == [
        ("RobotReplies", "Wait", "human_absence")
    ]


@pytest.mark.parametrize("state", [State.HANDSHAKE, *BUSY])
def test_a_state_may_outlive_its_visitor_by_as_long_as_the_file_says(state: State) -> None:
    visit = busy(state, timeouts=Timeouts(absent=10.0))
    assert visit.wait(9, **GONE) == []
    assert visit.wait(5, **WITH) == [], "they came back, and the limit begins anew"
    assert visit.wait(9, **GONE) == []
    (change,) = visit.wait(2, **GONE)
    assert arrow(change) == (state.value, "Wait", "human_absence")
    assert not change.forced


def test_a_sensor_that_falls_silent_has_seen_nobody_since() -> None:
    visit = Visit(timeouts=Timeouts(absent=10.0), stale=2.0).engage()
    for event in BUSY[State.THINKS]:
        visit.event(event)
    assert [arrow(change) for change in visit.wait(13)] == [
        ("RobotThinks", "Wait", "human_absence")
    ]


def test_a_state_that_was_forced_with_nobody_there_stands() -> None:
    visit = Visit(timeouts=Timeouts(absent=10.0))
    visit.model.force("RobotThinks")
    assert visit.wait(60, **GONE) == []
    visit.see(**WITH)
    assert [arrow(change) for change in visit.wait(11, **GONE)] == [
        ("RobotThinks", "Wait", "human_absence")
    ]


def test_by_hand_the_extension_is_never_meant() -> None:
    """What `force` did in a log of before, it does."""
    edge = edge_to(State.THINKS, "Wait")
    assert (edge.target, edge.outcome) == (State.WAIT, "forced")
    with pytest.raises(ValueError, match="neither a state nor an outcome"):
        edge_to(State.THINKS, "human_absence")


SIGNS = st.fixed_dictionaries(
    {
        "presence": st.booleans(),
        "gaze": st.booleans(),
        "distance": st.booleans(),
        "identity": st.sampled_from(["Anna", "Unknown"]),
    }
)


@given(st.sampled_from(list(State)), st.sampled_from([None, *Event]), SIGNS)
def test_every_step_follows_an_edge(
    state: State, event: Event | None, signs: dict[str, bool | str]
) -> None:
    model = Visit().model
    if state is not State.WAIT:
        model.override("presence", True)
        model.force(state)
        model.override("presence", False)  # the signs have changed: it stands no more
    for sign, verdict in signs.items():
        model.override(sign, verdict, verdict if isinstance(verdict, str) else "")
    change = model.step(event)
    assert (model.state is state) is (change is None)
    if change is not None:
        assert change.was == state
        assert arrow(change) in PAPER | BEYOND


@given(
    st.sampled_from(list(State)),
    st.sampled_from([None, *Event]),
    st.tuples(*[st.booleans()] * 3),
    st.floats(0, 1e9),
)
def test_without_the_setting_nobodys_absence_takes_an_edge(
    state: State, event: Event | None, view: tuple[bool, bool, bool], seconds: float
) -> None:
    there = ModelView(event, *view, elapsed=1.0)
    gone = replace(there, absent_for=seconds)
    edges = edges_from(state)
    assert [edge.when(there) for edge in edges] == [edge.when(gone) for edge in edges]


@given(st.lists(st.sampled_from([None, *Event]), max_size=40), st.booleans())
def test_no_random_events_leave_the_table(events: list[Event | None], there: bool) -> None:
    visit = Visit()
    for event in events:
        found = visit.see(**(WITH if there else GONE)) if event is None else [visit.event(event)]
        assert {arrow(change) for change in found if change} <= PAPER | BEYOND


# -- time limits and attempts ---------------------------------------------------------------------


@pytest.mark.parametrize(
    ("limit", "state"),
    [
        *(("listening", State.USER_SPEAKS), ("thinking", State.THINKS)),
        *(("talking", State.REPLIES), ("talking", State.ROBOT_SPEAKS)),
    ],
)
def test_a_conversation_that_does_not_go_on_is_given_up(limit: str, state: State) -> None:
    visit = Visit(timeouts=Timeouts(**{limit: 5.0})).engage()
    for event in BUSY[state]:
        visit.event(event)
    assert visit.wait(4.5, **WITH) == []
    assert arrows(visit.wait(1, **WITH)) == [(state.value, "EngagedWithKnown", "error")]


def test_without_a_limit_the_wizard_may_think_for_ever() -> None:
    visit = Visit().engage()
    for event in BUSY[State.THINKS]:
        visit.event(event)
    assert visit.wait(300, **WITH) == []


def test_a_person_who_does_not_engage_is_left_alone() -> None:
    visit = Visit(timeouts=Timeouts(approach=10.0))
    visit.see(presence=1)
    assert visit.wait(9, presence=1) == []
    assert arrows(visit.wait(2, presence=1))[0] == ("PersonDetected", "Wait", "human_absence")


def test_a_visitor_may_look_away_for_as_long_as_the_settings_say() -> None:
    visit = Visit(timeouts=Timeouts(lost=10.0)).engage()
    assert visit.wait(9, presence=1, gaze=0, distance=0.9) == []
    assert visit.wait(5, **WITH) == []
    away = visit.wait(11, presence=1, gaze=0, distance=0.9)
    assert arrows(away) == [("EngagedWithKnown", "PersonDetected", "error")]


def test_a_face_has_time_to_be_recognised() -> None:
    visit = Visit(timeouts=Timeouts(unrecognized=3.0))
    changes = visit.wait(2, **WITH) + visit.see(**WITH, identity="Anna")
    assert [change.outcome for change in changes] == ["human_presence", "recognized"]
    stranger = Visit(timeouts=Timeouts(unrecognized=3.0)).wait(4, **WITH)
    assert [change.outcome for change in stranger] == [
        "human_presence",
        "unrecognized",
        "handshake",
    ]


def test_handshakes_are_bounded_in_number_and_in_time() -> None:
    visit = Visit(handshake=HandshakeSettings(attempts=2, seconds=20.0))
    visit.see(3, **WITH)
    assert visit.model.attempt == 1
    visit.event(Event.HANDSHAKE_FAIL)
    visit.see(**WITH)
    assert visit.model.attempt == 2
    over = visit.wait(21, **WITH)
    assert arrows(over) == [("Handshake", "EngagedWithUnknown", "eng2unknow")]
    assert visit.wait(60, **WITH) == []
    visit.see(2, **{**WITH, "gaze": 0})
    again = visit.see(2, **WITH)
    assert [change.outcome for change in again] == ["unrecognized", "handshake"]


def test_a_robot_that_leads_the_handshake_asks_within_one() -> None:
    visit = Visit(handshake=HandshakeSettings(by="robot", attempts=3)).meet()
    visit.event(Event.HANDSHAKE_FAIL)
    assert visit.wait(30, **WITH) == []


def test_where_nobody_greets_a_name_that_turns_up_counts() -> None:
    visit = Visit(handshake=nobody_greets())
    visit.see(4, **WITH)
    assert visit.model.state is State.UNKNOWN
    assert arrows(visit.see(**WITH, identity="Anna")) == [
        ("EngagedWithUnknown", "EngagedWithKnown", "recognized")
    ]


def test_arrows_by_name() -> None:
    for state, to in itertools.product(State, State):
        if state is not to:
            assert edge_to(state, to.value).target is to
    with pytest.raises(ValueError, match="already"):
        edge_to(State.WAIT, "Wait")
    with pytest.raises(ValueError, match="'listening' is neither a state nor an outcome of Wait"):
        edge_to(State.WAIT, "listening")
