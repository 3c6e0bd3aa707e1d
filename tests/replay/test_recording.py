from __future__ import annotations

from itertools import pairwise

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.replay.logs import (
    PLAN,
    SECOND,
    START,
    KeptSamples,
    Viewer,
    distance,
    played_action,
    recording_of,
    stamped,
    story,
)
from woz_tui.features.delay.kinds import ActionHeld
from woz_tui.features.questionnaires.kinds import QuestionnaireEnded, QuestionnaireStarted
from woz_tui.features.scripts.kinds import ScriptMoved
from woz_tui.log.log_reader import LogLine
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol.welcome import ModelLimits, PerceptionView, WelcomeSettings
from woz_tui.replay.bookmarks import IdleCuts, monotonic
from woz_tui.replay.player import ReplayStart
from woz_tui.replay.recording import Recording
from woz_tui.session.recent_messages import RecentMessages
from woz_tui.timeline.session_state import SessionState

Timed = tuple[float, m.Message]

_DRIVERS = st.sampled_from(["robot", "range"])
_SINGLE: st.SearchStrategy[m.Message] = st.one_of(
    st.builds(m.Marker, text=st.text(max_size=5)),
    st.builds(m.Note, text=st.text(max_size=5)),
    st.just(m.StopPressed(source="key")),
    st.just(m.StopPressed(source="key", scope="driving")),
    st.just(m.StopConfirmed(confirmed=["robot"], missing=["range"], elapsed_us=500)),
    st.just(m.StopReleased(source="key")),
    st.builds(m.DriverLost, driver=_DRIVERS, detail=st.just("cable"), remedy=st.just("plug")),
    st.builds(m.DriverConnected, driver=_DRIVERS, detail=st.just("")),
    st.builds(m.PanelLocked, panel=st.just("Speech"), locked=st.booleans()),
    st.builds(ScriptMoved, position=st.integers(0, 2)),
    st.builds(m.SessionChanged, participant=st.none() | st.just("P07"), trial=st.integers(1, 9)),
    st.builds(
        m.SensorChanged,
        sensor=st.sampled_from(["distance", "loudness"]),
        state=st.sampled_from(["stale", "ok", "speaking"]),
        was=st.just("ok"),
        why=st.just(""),
    ),
    st.builds(m.ModeChanged, driver=_DRIVERS, was=st.just(""), now=st.sampled_from("ab")),
    st.builds(
        m.EngagementChanged,
        was=st.just("Wait"),
        now=st.sampled_from(["Wait", "EngagedWithKnown"]),
        outcome=st.just("x"),
        why=st.just("because"),
        verdicts=st.just({}),
    ),
    st.builds(m.TrialStarted, trial=st.integers(1, 3), condition=st.just("warm")),
    st.builds(m.TrialEnded, trial=st.integers(1, 3), outcome=st.sampled_from(["done", "aborted"])),
    st.just(m.BreakStarted()),
    st.just(m.BreakEnded()),
    st.just(m.PreflightChecked(check="table", level="ok", source="wizard")),
    st.builds(
        m.ConditionsAssigned,
        participant=st.just("P07"),
        order=st.just(["warm", "cold"]),
        method=st.just("latin-square"),
    ),
    st.just(QuestionnaireStarted(questionnaire="robot", title="Robot", items=[])),
    st.just(QuestionnaireEnded(questionnaire="robot", reason="done", answered=0)),
    st.builds(m.reading, st.sampled_from(["distance", "loudness"]), st.floats(0, 4)),
)


@st.composite
def courses(draw: st.DrawFn) -> list[m.Message]:
    """A session in which anything may happen, actions under way at any moment."""
    timed: list[Timed] = [(0.0, START)]
    for at, message in draw(st.lists(st.tuples(st.floats(0, 60), _SINGLE), max_size=60)):
        timed.append((at, message))
    for number in range(draw(st.integers(0, 12))):
        at, took = draw(st.floats(0, 60)), draw(st.floats(0, 10))
        name, held = draw(st.sampled_from(["Hello", "Go"])), draw(st.floats(0, 5) | st.none())
        pressed, *rest = played_action(f"a{number}", name, at, took)
        timed.append(pressed)
        if held is not None:
            until = round((at + held) * SECOND)
            holds = ActionHeld(run=f"a{number}", action=name, sort="speech", cued=0, until=until)
            timed.append((at, holds))
        timed += [(when + (held or 0.0), message) for when, message in rest]
    return stamped(sorted(timed, key=lambda pair: pair[0]))


@given(courses(), st.floats(0, 70), st.lists(st.floats(0, 70), max_size=3), st.integers(1, 9))
def test_the_state_after_seeking_is_that_after_playing(
    messages: list[m.Message], to: float, detours: list[float], ticks: int
) -> None:
    recording = recording_of(messages)
    to = min(to, recording.length_us / SECOND)
    by_playing = Viewer(recording)
    by_playing.wait(to, ticks=ticks)
    by_seeking = Viewer(recording_of(messages), ReplayStart(paused=True))
    for detour in [each for each in detours if each <= to]:
        by_seeking.go(detour)
    by_seeking.go(to)
    assert by_playing.visible_state == by_seeking.visible_state


@given(courses(), st.integers(0, 200), st.integers(1, 30))
def test_what_is_kept_on_the_way_changes_nothing(
    messages: list[m.Message], index: int, chunk: int
) -> None:
    recording = recording_of(messages)
    index = min(index, len(recording.lines))
    while recording.prepare(chunk):
        pass
    by_hand, recent = SessionState(), RecentMessages()
    for line in recording.lines[:index]:
        assert not isinstance(line, dict)
        by_hand.apply(line)
        recent.add(line)
    assert recording.state(index).messages() == by_hand.messages()
    assert recording.recent(index) == recent.lines


def test_unknown_kinds_are_handed_on_and_disturb_nothing() -> None:
    messages = story()
    raw = b'{"kind":"weather.changed","seq":9000,"t":30000000,"ts":"x","sky":"blue"}'
    strange = LogLine(9000, 30 * SECOND, "x", "weather.changed", codec.decode_unknown(raw), raw)
    lines = [each for each in messages if not codec.is_sample(each)]
    at = next(n for n, line in enumerate(lines) if line.t > 30 * SECOND)
    recording = Recording([*lines[:at], strange, *lines[at:]], KeptSamples(()), plan=PLAN)
    viewer = Viewer(recording)
    viewer.wait(61, ticks=61)
    assert {"kind": "weather.changed", "sky": "blue"}.items() <= next(
        each for each in viewer.messages if isinstance(each, dict)
    ).items()
    assert viewer.state.ended == "wizard"
    viewer.go(29.9)
    reply = viewer.do("step")
    assert reply.data == {"kind": "weather.changed", "t": 30 * SECOND}


@pytest.mark.parametrize(
    ("times", "expected"),
    [
        ([1, 2, 3], [1, 2, 3]),
        ([1, 2, 900, 3, 4], [1, 2, 3, 3, 4]),  # a bit has flipped
        ([1, 2, 0, 3, 4], [1, 2, 2, 3, 4]),
        ([5, 5, 5], [5, 5, 5]),
        ([1, 900, 901, 902], [1, 900, 901, 902]),  # a pause, not a damage
        ([], []),
    ],
)
def test_one_damaged_time_moves_no_other_line(times: list[int], expected: list[int]) -> None:
    assert monotonic(times) == expected


@given(st.lists(st.integers(0, 1000)))
def test_times_never_go_back(times: list[int]) -> None:
    assert all(a <= b for a, b in pairwise(monotonic(times)))


@given(
    st.lists(st.integers(0, 1000)).map(sorted),
    st.none() | st.integers(1, 100),
    st.integers(0, 1000),
    st.integers(-500, 500),
)
def test_moving_over_cuts_counts_what_is_shown_only(
    deeds: list[int], most: int | None, t: int, by: int
) -> None:
    cuts = IdleCuts(deeds, most)
    start = cuts.moved(t, 0)
    assert cuts.before(start) <= start
    there = cuts.moved(start, by)
    assert (there - cuts.before(there)) - (start - cuts.before(start)) == by
    assert cuts.moved(there, -by) == start


@pytest.mark.parametrize("begun", [False, True])
def test_a_trial_has_one_mark_whether_it_was_begun_or_set(begun: bool) -> None:
    trials = [(2.0, m.TrialStarted(trial=1, condition="warm"))] if begun else []
    recording = recording_of(stamped([(0, START), (1, m.SessionChanged(trial=1)), *trials]))
    assert [(mark.sort, mark.text) for mark in recording.marks] == [
        ("trial", "trial 1 warm" if begun else "trial 1")
    ]


def test_a_plan_of_the_middle_counts_from_then_on() -> None:
    later = m.SessionPlan(
        title="Reloaded",
        panels=[],
        script=[],
        verbs={},
        variables=[],
        conditions=[],
        keyboard="us",
        drivers=[],
        settings=WelcomeSettings(),
    )
    viewer = Viewer(recording_of(stamped([(0, START), (1, PLAN), (5, later), (9, m.Marker())])))
    assert viewer.state.plan.title == "Museum guide"
    viewer.wait(6)
    assert viewer.state.plan.title == "Reloaded"
    viewer.go(2)
    assert viewer.state.plan.title == "Museum guide"
    viewer.go(8)
    assert viewer.state.plan.title == "Reloaded"


def test_a_lock_of_before_a_reload_does_not_outlast_it() -> None:
    timed: list[Timed] = [
        (0, START),
        (1, PLAN),
        (2, m.PanelLocked(panel="Speech", locked=True)),
        (5, PLAN),  # read again: the panels say themselves what is locked
        (9, m.Marker()),
    ]
    by_playing = Viewer(recording_of(stamped(timed)))
    by_playing.wait(7)
    by_seeking = Viewer(recording_of(stamped(timed)), ReplayStart(paused=True))
    by_seeking.go(3)
    assert by_seeking.visible_state["locks"] == {"Speech": True}
    by_seeking.go(7)
    assert by_seeking.visible_state["locks"] == by_playing.visible_state["locks"] == {}


def test_the_study_of_a_moment_knows_nothing_of_what_comes_next() -> None:
    timed: list[Timed] = [(0, START), (1, PLAN), (2, m.TrialStarted(trial=1)), (9, m.Marker())]
    recording = recording_of(stamped(timed))
    assert [recording.moment(index, 0).study.running for index in (2, 3, 4)] == [False, True, True]


def test_a_model_that_a_reload_took_away_holds_no_more() -> None:
    def plan(engagement: ModelLimits) -> m.SessionPlan:
        settings = msgspec.structs.replace(PLAN.settings, engagement=engagement)
        return msgspec.structs.replace(PLAN, settings=settings)

    engagement_changed = m.EngagementChanged(
        was="Wait", now="PersonDetected", outcome="", why="presence", verdicts={}
    )
    timed: list[Timed] = [
        (0, START),
        (1, plan(ModelLimits(attempts=3))),
        (2, engagement_changed),
        (5, plan(ModelLimits())),
        (9, m.Marker()),
    ]
    recording = recording_of(stamped(timed))
    for index, there in ((3, True), (4, False), (5, False)):
        state = recording.moment(index, recording.times[index - 1]).state
        assert any(isinstance(message, m.EngagementChanged) for message in state) is there


def _blind() -> m.SessionPlan:
    study = msgspec.structs.replace(
        PLAN.settings.study,
        blind={"warm": "A", "cold": "B"},
        perception=PerceptionView(hide=["distance"]),
    )
    return msgspec.structs.replace(PLAN, settings=WelcomeSettings(study=study))


@pytest.mark.parametrize("reveal", [False, True])
def test_what_was_kept_from_the_wizard_is_kept_from_the_viewer_unless_told(reveal: bool) -> None:
    messages = stamped(
        [
            (0, START),
            (0, _blind()),
            (1, m.PerceptionChanged(hidden=["distance"], blurred=[])),
            (2, m.TrialStarted(trial=1, condition="cold")),
            (3, m.reading("distance", 1.0)),
            (4, m.Marker()),
        ]
    )
    lines = [each for each in messages if not codec.is_sample(each)]
    samples = [each for each in messages if codec.is_sample(each)]
    recording = Recording(lines, KeptSamples(samples, 4 * SECOND), reveal=reveal)
    viewer = Viewer(recording)
    viewer.wait(4)
    for _ in range(2):  # after playing, and after going there
        assert viewer.state.session.study.condition == ("cold" if reveal else "B")
        assert (distance(viewer).value == 1.0) is reveal
        viewer.go(3.5)
    assert viewer.state.replay is not None
    (trial,) = (place for place in viewer.state.replay.places if place.sort == "trial")
    assert trial.text == f"trial 1 {'cold' if reveal else 'B'}"
