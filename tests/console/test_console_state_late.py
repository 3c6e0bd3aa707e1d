"""A console that attaches late shows what one shows that was there from the beginning."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.console import scenes
from tests.console.scripted_feed import raw
from tests.console.study_scene import conditions_assigned, study_description
from tests.features.questionnaires.scene import questionnaire_ended, questionnaire_started
from tests.replay.logs import seen_by_wizard, stamped
from tests.timeline.random_sessions import damaged, plan, recordings, start
from tests.timeline.random_sessions import stamped as stamped_again
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.features.questionnaires.console import questionnaires_of
from woz_tui.protocol import messages as m
from woz_tui.session.recent_messages import RecentMessages
from woz_tui.session.session_plan import welcome
from woz_tui.timeline.session_state import SessionState

SECOND = 1_000_000


def somebody(code: str) -> m.SessionChanged:
    return m.SessionChanged(participant=code)


def engagement(was: str, now: str) -> m.EngagementChanged:
    return m.EngagementChanged(was=was, now=now, outcome="", why="test", verdicts={})


def greeted(messages: list[m.Message], *, recent: bool) -> ConsoleState:
    """A console that attaches when all this is over, with or without the last lines."""
    state, lines = SessionState(), RecentMessages()
    for message in messages:
        state.apply(message)
        lines.add(message)
    picture = ConsoleState()
    first = scenes.welcome(
        state.messages(plan=False),
        lines.lines if recent else [],
        settings={"study": study_description()},
    )
    picture.apply([first], 0)
    return picture


HAD = questionnaire_ended("robot"), questionnaire_ended("end", "declined")

COURSES: dict[str, tuple[list[m.Message], Callable[[ConsoleState], object], object]] = {
    "a participant who comes back has had nothing": (
        [conditions_assigned(), *HAD, somebody("P08"), somebody("P07")],
        lambda picture: (picture.session.study.participant, questionnaires_of(picture).history.had),
        ("P07", {}),
    ),
    "a questionnaire that was had, and then begun and left, was had": (
        [
            conditions_assigned(),
            questionnaire_started(),
            questionnaire_ended("robot"),
            questionnaire_started(),
            questionnaire_ended("robot", "left"),
        ],
        lambda picture: (
            [*questionnaires_of(picture).history.had],
            questionnaires_of(picture).open,
        ),
        (["robot"], None),
    ),
    "where a participant sits": (
        [
            m.ConsoleAttached(console="con2", role="participant"),
            m.ConsoleAttached(console="con3", role="participant"),
            m.ConsoleLost(console="con2", role="participant", why="left"),
        ],
        lambda picture: picture.study.participants,
        {"con3"},
    ),
    "since when a driver is lost that says so twice": (
        [m.DriverLost(driver="head", detail="cable"), m.DriverLost(driver="head", detail="cable")],
        lambda picture: picture.drivers["head"].t,
        1 * SECOND,
    ),
    "the trial whose number was set last": (
        [m.TrialStarted(trial=1), m.SessionChanged(trial=3), m.TrialEnded(trial=1, outcome="done")],
        lambda picture: picture.session.study.number,
        3,
    ),
    "the knob that moved last": (
        [
            m.ControlsMoved(driver="panel", values={"knob1": 1, "knob2": 2}),
            m.ControlsMoved(driver="panel", values={"knob1": 3}),
        ],
        lambda picture: [*picture.session.controls["panel"].values.items()],
        [("knob2", 2), ("knob1", 3)],
    ),
    "who pressed the stop first, and who did not confirm the last press": (
        [
            m.StopPressed(source="key"),
            m.StopConfirmed(confirmed=["head"], missing=[], elapsed_us=9),
            m.StopPressed(source="program"),
            m.StopConfirmed(confirmed=[], missing=["head"], elapsed_us=9),
        ],
        lambda picture: (stop := picture.session.stop) and (stop.begin, stop.source, stop.missing),
        (1 * SECOND, "key", ("head",)),
    ),
    "the present participant has had no trial": (
        [
            m.TrialStarted(trial=1),
            m.TrialEnded(trial=1, outcome="done"),
            somebody("P08"),
        ],
        lambda picture: (
            (study := picture.session.study).last_ended,
            study.next_trial,
            study.number,
        ),
        (None, 1, 1),
    ),
    "an utterance that goes on": (
        [m.SpeechStarted(driver="microphone", segment=4, began=1 * SECOND)],
        lambda picture: (segment := picture.engaged.speaking(2 * SECOND)) and segment.segment,
        4,
    ),
    "the last change of the engagement model is the last": (
        [engagement("Wait", "EngagedWithKnown"), engagement("EngagedWithKnown", "RobotReplies")],
        lambda picture: picture.engaged.changes[-1].now,
        "RobotReplies",
    ),
}


@pytest.mark.parametrize("recent", [False, True], ids=["no lines", "last lines"])
@pytest.mark.parametrize("case", COURSES)
def test_what_holds_is_there_however_long_ago_it_was(case: str, recent: bool) -> None:
    course, look, expected = COURSES[case]
    messages = stamped(enumerate([start(participant="P07"), *course]))
    there = ConsoleState()
    there.apply([scenes.welcome([], settings={"study": study_description()}), *messages], 0)
    assert look(there) == expected
    assert look(greeted(messages, recent=recent)) == expected


def test_what_is_older_than_the_last_lines_comes_before_them() -> None:
    """The engagement goes on since a change that is not among the last lines any more."""
    changes: list[m.Message] = [engagement("Wait", "EngagedWithKnown")]
    for _ in range(150):
        changes.append(engagement("EngagedWithKnown", "RobotReplies"))
        changes.append(engagement("RobotReplies", "EngagedWithKnown"))
    messages = stamped(enumerate([start(), *changes]))
    shown = [*greeted(messages, recent=True).engaged.changes]
    assert shown == messages[-len(shown) :]


# -- random courses -------------------------------------------------------------------------------


def welcomed(state: SessionState, recent: RecentMessages) -> ConsoleState:
    """A console that attaches now."""
    assert state.plan is not None
    told = welcome(state.plan, console="con9", role="wizard", seq=0, t=state.t, log="")
    told = msgspec.structs.replace(
        told, state=raw(state.messages(plan=False)), recent=raw(recent.lines)
    )
    picture = ConsoleState()
    picture.apply([told], 0)
    return picture


#: What was before: it stands in the last lines.
WAS = {"events", "outcomes", "failures", "changes", "model"}


def differences_of_late_console(
    course: list[m.Message], first: float, second: float
) -> Iterator[set[str]]:
    """What differs between a console that was there and one that attaches later."""
    # A plan names what is kept from the wizard, too; at random the two do not agree.
    apart = m.PerceptionChanged | m.SessionPlan
    kept = [(each.t, each) for each in course if not isinstance(each, apart)]
    course = stamped_again([(0, start()), (0, plan()), *kept])
    early, late = sorted(2 + round(share * (len(course) - 2)) for share in (first, second))
    state, recent, there = SessionState(), RecentMessages(), ConsoleState()
    for place, message in enumerate(course, start=1):
        state.apply(message)
        recent.add(message)
        there.apply([message], 0)
        if place == early:
            there = welcomed(state, recent)
        if place == late:
            newcomer, known = seen_by_wizard(welcomed(state, recent)), seen_by_wizard(there)
            yield {name for name in known if newcomer[name] != known[name]} - {"now"}


@given(recordings(), st.floats(0, 1), st.floats(0, 1))
def test_a_console_that_attaches_late_shows_the_same(
    course: list[m.Message], first: float, second: float
) -> None:
    """Also what was: the last lines tell it."""
    for different in differences_of_late_console(course, first, second):
        assert not different


@given(damaged(), st.floats(0, 1), st.floats(0, 1))
def test_what_holds_is_the_same_also_where_lines_are_lost_or_out_of_order(
    course: list[m.Message], first: float, second: float
) -> None:
    for different in differences_of_late_console(course, first, second):
        assert different <= WAS
