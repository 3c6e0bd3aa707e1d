"""What lasted, and how it ended."""

from __future__ import annotations

from typing import Any, TypeVar

import pytest

from tests.timeline.random_sessions import SECOND, plan, start, timed
from woz_tui.features.profiles.history import ProfileEpisode
from woz_tui.features.profiles.kinds import ProfileChanged
from woz_tui.protocol import messages as m
from woz_tui.timeline.episodes import (
    ActionEpisode,
    CommandEpisode,
    ConflictEpisode,
    EngagementEpisode,
    Episode,
    FaultedLaneEpisode,
    LostDriverEpisode,
    ModelOffEpisode,
    ModelStateEpisode,
    MomentEpisode,
    RestrictionEpisode,
    SettingEpisode,
    StopEpisode,
)
from woz_tui.timeline.session_state import SessionState
from woz_tui.timeline.timeline import timeline_of

E = TypeVar("E", bound=Episode)
SETTINGS = m.EngagementAdopted(settings={"start": "run"})
ENDS: list[tuple[m.End, str]] = [
    (m.Done(command="c", sent={"text": "hi"}, latency_us=5, duration_us=9), "done"),
    (m.Failed(command="c", reason="hot"), "failed"),
    (m.TimedOut(command="c", reason="30 s"), "timed_out"),
    (m.Refused(command="c", code="full", reason="full"), "refused"),
    (m.Stopped(command="c"), "stopped"),
    (m.Superseded(command="c", by="d"), "superseded"),
]


def of(kind: type[E], *course: tuple[float, m.Message]) -> list[E]:
    messages = timed((0, start()), *course)
    return timeline_of(messages).of(kind)


def spans(episodes: list[E]) -> list[tuple[float, float, str]]:
    """Label, beginning and length in seconds."""
    return [(each.begin / SECOND, each.duration / SECOND, each.label) for each in episodes]


def requested(command: str = "c", run: str = "", driver: str = "voice") -> m.Command:
    return m.Command(
        command=command, run=run, verb="say", args={"text": "hi"}, driver=driver, source="key"
    )


# -- actions and commands -------------------------------------------------------------------------


@pytest.mark.parametrize(("end", "outcome"), ENDS, ids=[outcome for _, outcome in ENDS])
def test_a_command_has_the_outcome_that_its_end_says(end: Any, outcome: str) -> None:
    [command] = of(CommandEpisode, (1, requested()), (3, end))
    assert (command.outcome, command.cut, command.duration) == (outcome, False, 2 * SECOND)
    assert command.reason == end.reason


def test_a_command_has_all_that_its_lines_say() -> None:
    [command] = of(
        CommandEpisode,
        (1, requested()),
        (1.5, m.Dispatched(command="c", driver="voice", latency_us=500_000)),
        (2, m.Progress(command="c", driver="voice", expected_us=SECOND)),
        (3, m.Done(command="c", sent={"text": "HI"}, latency_us=500_000, duration_us=1_490_000)),
    )
    assert (command.latency_us, command.duration_us) == (500_000, 1_490_000)
    assert command.started == 1_500_000
    assert (command.driver, command.sent, command.expected_end) == (
        "voice", {"text": "HI"}, 3 * SECOND,
    )  # fmt: skip


def test_the_start_of_a_command_is_known_also_without_its_line() -> None:
    done = m.Done(command="c", sent={}, latency_us=250_000, duration_us=9)
    [command] = of(CommandEpisode, (1, requested()), (3, done))
    assert (command.started, command.latency_us) == (1_250_000, 250_000)
    [command] = of(CommandEpisode, (1, requested()), (3, m.Stopped(command="c")))
    assert (command.started, command.latency_us) == (None, None)


def test_an_action_counts_its_latency_to_the_first_start_of_a_driver() -> None:
    [action] = of(
        ActionEpisode,
        (1, m.ActionRequested(run="r", action="Hello", panel="Speech", source="key")),
        (1.8, requested("mark", "r", driver="session")),
        (1.81, m.Dispatched(command="mark", driver="session", latency_us=10_000)),
        (1.9, requested("c", "r")),
        (1.95, m.Dispatched(command="c", driver="voice", latency_us=50_000)),
        (3, m.ActionDone(run="r", action="Hello")),
        (9, m.Mistake(run="r", text="too early")),
        (9.5, m.Mistake(run="r", text="again")),
    )
    assert (action.outcome, action.label, action.request.panel) == ("done", "Hello", "Speech")
    assert action.latency_us == 950_000
    assert action.commands == ("mark", "c")
    assert action.mistake is not None
    assert action.mistake.text == "too early"


def test_what_has_no_end_in_the_log_is_open() -> None:
    actions = of(
        ActionEpisode,
        (1, m.ActionRequested(run="r", action="Nod", source="key")),
        (2, m.ActionRequested(run="r", action="Nod", source="key")),
        (5, m.Note(text="x")),
    )
    assert [(each.duration / SECOND, each.outcome, each.cut) for each in actions] == [
        (1, "open", True), (3, "open", True),
    ]  # fmt: skip


def test_passing_commands_are_only_counted() -> None:
    knob = m.Command(command="k", verb="control", args={}, source="midi")
    messages = timed(
        (0, start()),
        (1, knob),
        (1, m.Dispatched(command="k", latency_us=1)),
        (2, m.Superseded(command="k", by="l")),
    )
    timeline = timeline_of(messages)
    assert timeline.episodes == ()
    assert timeline.state.passing == 1


def test_an_end_without_a_beginning_is_a_moment() -> None:
    ends: list[m.Message] = [
        m.ActionDone(run="r9", action="Hello"),
        m.Failed(command="c9", reason="hot"),
        m.TrialEnded(trial=3, outcome="done"),
        m.BreakEnded(),
        m.StopReleased(source="key"),
        m.LaneRecovered(driver="head", lane="body"),
    ]
    moments = of(MomentEpisode, *((1, end) for end in ends))
    assert [type(each.message) for each in moments] == [type(end) for end in ends]


# -- the stop -------------------------------------------------------------------------------------


def confirmed(*names: str, missing: tuple[str, ...] = ()) -> m.StopConfirmed:
    return m.StopConfirmed(confirmed=[*names], missing=[*missing], elapsed_us=1)


def test_a_stop_lasts_until_its_release() -> None:
    [stop] = of(
        StopEpisode,
        (1, m.StopPressed(source="key")),
        (1.5, confirmed("voice", missing=("base",))),
        (4, m.StopReleased(source="key")),
    )
    assert (stop.duration, stop.outcome, stop.source) == (3 * SECOND, "released", "key")
    assert (stop.confirmed, stop.missing) == (("voice",), ("base",))


def test_each_press_has_the_confirmation_of_its_own() -> None:
    [stop] = of(
        StopEpisode,
        (1, m.StopPressed(source="key")),
        (1.5, confirmed(missing=("voice",))),
        (2, m.StopPressed(source="program")),
        (2.5, confirmed("voice")),
        (4, m.StopReleased(source="key")),
    )
    assert [len(press.confirmations) for press in stop.presses] == [1, 1]
    assert (stop.confirmed, stop.missing) == (("voice",), ())


def test_a_stop_of_driving_is_over_when_it_is_confirmed() -> None:
    drive, whole = of(
        StopEpisode,
        (1, m.StopPressed(source="console-lost", scope="drive")),
        (1.2, m.StopPressed(source="key")),
        (1.5, confirmed("base")),
        (1.7, confirmed("base", "voice")),
        (9, m.Note(text="x")),
    )
    assert (drive.label, drive.duration, drive.outcome) == ("drive", 500_000, "done")
    assert (whole.label, whole.outcome, whole.cut) == ("all", "open", True)
    assert whole.confirmed == ("base", "voice")


# -- the visitor ----------------------------------------------------------------------------------


def engagement_changed(
    was: str, now: str, outcome: str = "o", visitor: str = ""
) -> m.EngagementChanged:
    return m.EngagementChanged(
        was=was, now=now, outcome=outcome, why="", verdicts={}, visitor=visitor
    )


def switched(run: str) -> m.Done:
    return m.Done(command="x", driver="engagement", sent={"run": run}, latency_us=0, duration_us=0)


def test_states_of_the_model_follow_each_other() -> None:
    states = of(
        ModelStateEpisode,
        (0, SETTINGS),
        (3, engagement_changed("Wait", "PersonDetected", "human_presence")),
        (5, engagement_changed("PersonDetected", "EngagedWithKnown")),
        (9, m.Note(text="x")),
    )
    assert spans(states) == [(0, 3, "Wait"), (3, 2, "PersonDetected"), (5, 4, "EngagedWithKnown")]
    assert [(each.outcome, each.reason, each.cut) for each in states] == [
        ("left", "human_presence", False), ("left", "o", False), ("open", "", True),
    ]  # fmt: skip


def test_a_model_that_is_off_is_in_no_state() -> None:
    course: list[tuple[float, m.Message]] = [
        (0, SETTINGS),
        (2, engagement_changed("Wait", "EngagedWithKnown", visitor="V01")),
        (4, switched("off")),
        (5, engagement_changed("EngagedWithKnown", "UserSpeaks")),
        (7, switched("hold")),
        (8, switched("run")),
        (9, m.EngagementAdopted(settings={})),
        (12, m.Note(text="x")),
    ]
    assert spans(of(ModelStateEpisode, *course)) == [
        (0, 2, "Wait"), (2, 2, "EngagedWithKnown"), (7, 2, "UserSpeaks"),
    ]  # fmt: skip
    engaged = of(EngagementEpisode, *course)
    assert [(each.begin / SECOND, each.visitor, each.outcome) for each in engaged] == [
        (2, "V01", "off"), (7, "", "off"),
    ]  # fmt: skip
    assert spans(of(ModelOffEpisode, *course)) == [(4, 3, "")]


def test_a_log_without_settings_has_a_model_from_its_beginning_if_it_ever_moved() -> None:
    states = of(
        ModelStateEpisode,
        (4, engagement_changed("EngagedWithKnown", "Wait")),
        (6, m.Note(text="x")),
    )
    assert spans(states) == [(0, 4, "EngagedWithKnown"), (4, 2, "Wait")]
    assert of(ModelStateEpisode, (4, m.Note(text="x"))) == []


def test_a_plan_without_the_section_says_that_the_model_is_gone() -> None:
    states = of(
        ModelStateEpisode,
        (0, plan(engagement={"attempts": 3})),
        (2, engagement_changed("Wait", "PersonDetected")),
        (5, plan()),
        (9, m.Note(text="x")),
    )
    assert spans(states)[-1] == (2, 3, "PersonDetected")


# -- drivers and settings -------------------------------------------------------------------------


def test_a_driver_is_lost_until_it_is_ready() -> None:
    lost = of(
        LostDriverEpisode,
        (1, m.DriverFaulted(driver="head", detail="servo 3")),
        (2, m.DriverLost(driver="head", detail="the port")),
        (3, m.DriverConnecting(driver="head")),
        (4, m.DriverConnected(driver="head")),
        (6, m.DriverLost(driver="head")),
    )
    assert spans(lost) == [(1, 3, "head"), (6, 0, "head")]
    assert [(each.reason, each.outcome) for each in lost] == [
        ("servo 3", "recovered"), ("", "open"),
    ]  # fmt: skip


def test_a_lane_is_faulted_until_it_recovers() -> None:
    faulted = of(
        FaultedLaneEpisode,
        (1, m.LaneFaulted(driver="head", lane="body", command="c")),
        (3, m.LaneRecovered(driver="head", lane="body")),
    )
    assert spans(faulted) == [(1, 2, "head body")]


def settings_shown(value: float, *conflicts: str, **wanted: m.Json) -> m.SettingsShown:
    return m.SettingsShown(
        driver="pepper", values={"volume": value}, wanted=wanted, conflicts=[*conflicts]
    )


def test_a_setting_differs_from_when_it_was_read_until_it_does_not() -> None:
    course: list[tuple[float, m.Message]] = [
        (1, settings_shown(0.7)),
        (2, settings_shown(0.3, "loud", volume=0.7)),
        (4, settings_shown(0.3, volume=0.7)),
        (5, m.DriverLost(driver="pepper")),
        (7, m.DriverConnected(driver="pepper")),
        (9, m.Note(text="x")),
    ]
    settings = of(SettingEpisode, *course)
    assert [(each.begin / SECOND, each.value, each.differs, each.outcome) for each in settings] == [
        (1, 0.7, False, "changed"),
        (2, 0.3, True, "lost"),
        (5, None, None, "changed"),
        (7, 0.3, True, "open"),
    ]
    assert spans(of(ConflictEpisode, *course)) == [(2, 2, "loud")]


# -- the wizard -----------------------------------------------------------------------------------


def test_profiles_and_restrictions_last_until_they_change() -> None:
    course: list[tuple[float, m.Message]] = [
        (1, ProfileChanged(profile="child")),
        (2, m.PerceptionChanged(hidden=["distance"], blurred=[])),
        (3, ProfileChanged(profile="adult")),
        (4, m.PerceptionChanged(hidden=[], blurred=[])),
        (6, ProfileChanged()),
    ]
    assert spans(of(ProfileEpisode, *course)) == [(1, 2, "child"), (3, 3, "adult")]
    assert spans(of(RestrictionEpisode, *course)) == [(2, 2, "")]


def state_of(*course: tuple[float, m.Message]) -> SessionState:
    state = SessionState()
    for message in timed((0, start()), (0, plan()), *course):
        state.apply(message)
    return state


def test_a_sensor_that_gives_a_value_is_not_stale_any_more() -> None:
    stale = m.SensorChanged(sensor="distance", state="stale")
    value = m.Reading(sensor="distance", value=1.0)
    assert state_of((1, value), (2, stale)).sensor_state("distance") == "stale"
    assert state_of((1, stale), (2, value)).sensor_state("distance") == ""
