"""What of a session is drawn, and where."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.analysis.example_sessions import SECOND, ExampleSession, in_time, timeline_drawing
from woz_tui.analysis.timeline_lanes import PLACES, SensorCurves, TimelineLane, in_words
from woz_tui.protocol import messages as m


def lanes(session: ExampleSession) -> dict[str, TimelineLane]:
    return {lane.name: lane for lane in timeline_drawing(in_time(session)).lanes}


def test_every_panel_has_a_lane() -> None:
    session = (
        ExampleSession()
        .act(1, took=2.0)
        .act(5, "Nod", "Body", end="refused")
        .act(8, took=None)
        .end(10)
    )
    found = lanes(session)
    speech, body = found["Speech"], found["Body"]
    assert [(each.begin, each.end, each.outcome, each.cut) for each in speech.intervals] == [
        (1 * SECOND, 3 * SECOND, "done", False),
        (8 * SECOND, 10 * SECOND, "open", True),
    ]
    assert speech.intervals[0].facts == (("say", "hello"), ("latency", "1.0 ms"))
    assert (body.intervals[0].outcome, body.intervals[0].detail) == ("refused", "locked")


def test_states_follow_each_other_without_a_gap() -> None:
    session = (
        ExampleSession()
        .state(10, "Wait", "PersonDetected")
        .state(20, "PersonDetected", "Wait")
        .end(30)
    )
    states = lanes(session)["engagement"].intervals
    assert [(each.label, each.begin // SECOND, each.end // SECOND) for each in states] == [
        ("Wait", 0, 10),
        ("PersonDetected", 10, 20),
        ("Wait", 20, 30),
    ]


def test_lanes_come_in_a_fixed_order() -> None:
    session = ExampleSession().act(1).add(2, m.Note(text="x")).add(3, m.StopPressed(source="key"))
    session.add(4, m.DriverLost(driver="head")).state(5, "Wait", "PersonDetected").speech(6, 7)
    session.add(8, m.TrialStarted(trial=1)).add(9, m.TrialEnded(trial=1, outcome="excluded")).end(
        10
    )
    timeline = timeline_drawing(in_time(session))
    assert [lane.sort for lane in timeline.lanes] == [
        *("trial", "engagement", "speech", "panel", "stop", "driver", "mark")
    ]
    assert timeline.lanes[0].intervals[0].outcome == "excluded"
    assert timeline.lanes[4].intervals[0].end == 10 * SECOND


def test_what_was_understood_belongs_to_its_utterance() -> None:
    session = ExampleSession().speech(1, 3).speech(5, 6, 2)
    session.add(7, m.SpeechText(driver="mic", segment=1, text="where is the exit"))
    first, second = lanes(session.end(9))["visitor speaks"].intervals
    assert (first.detail, second.detail) == ("where is the exit", "")


def test_arguments_in_a_few_words() -> None:
    assert in_words({"text": "Hello"}) == "Hello"
    assert in_words({"yaw": 10.0, "on": True}) == "yaw 10.0, on true"
    assert len(in_words({"text": "x" * 500})) == 200


@given(st.lists(st.integers(0, 3_600), min_size=1, max_size=50))
def test_a_curve_keeps_its_mean_and_never_grows(times: list[int]) -> None:
    curves = SensorCurves()
    for t in sorted(times):
        curves.add(m.Reading(t=t * SECOND, sensor="distance", value=2.5, unit="m"))
    [curve] = curves
    assert len(curve.values) <= PLACES
    assert {value for value in curve.values if value is not None} == {2.5}
    assert curve.unit == "m"


def test_a_curve_is_a_mean_of_what_falls_together() -> None:
    curves = SensorCurves()
    for t, value in ((0, 1.0), (10_000, 3.0), (60_000, 5.0)):
        curves.add(m.Reading(t=t, sensor="distance", value=value))
    curves.add(m.Reading(t=70_000, sensor="distance", value=None))
    [curve] = curves
    assert curve.values == pytest.approx((2.0, 5.0))
    taken = [name for name in ("left.distance", "gaze", "distance") if curves.takes(name)]
    assert taken == ["left.distance", "distance"]


def switched(run: str) -> m.Done:
    return m.Done(command="c", driver="engagement", sent={"run": run}, latency_us=0, duration_us=0)


def test_a_model_is_in_no_state_before_it_is_there_and_while_it_is_off() -> None:
    session = ExampleSession().add(10, m.EngagementAdopted(settings={"start": "run"}))
    session.state(20, "Wait", "EngagedWithKnown").add(30, switched("off")).add(50, switched("run"))
    states = lanes(session.end(60))["engagement"].intervals
    assert [(each.label, each.begin // SECOND, each.end // SECOND) for each in states] == [
        ("Wait", 10, 20),
        ("EngagedWithKnown", 20, 30),
        ("EngagedWithKnown", 50, 60),
    ]


def test_a_stop_of_driving_is_over_as_soon_as_it_is_confirmed() -> None:
    session = ExampleSession().add(1, m.StopPressed(source="no console", scope="drive"))
    session.add(2, m.StopConfirmed(confirmed=["base"], missing=[], elapsed_us=SECOND)).end(60)
    [stop] = lanes(session)["stop"].intervals
    assert (stop.begin // SECOND, stop.end // SECOND, stop.cut) == (1, 2, False)


def test_a_command_on_the_spot_ends_as_it_did() -> None:
    session = ExampleSession()
    ends = (
        m.TimedOut(command="c0", driver="robot"),
        m.Superseded(command="c1", driver="robot", by="c2"),
    )
    for end in ends:
        say = m.Command(command=end.command, verb="say", args={}, driver="robot", source="key")
        session.add(1, say, end)
    direct = lanes(session.end(9))["(improvised)"].intervals
    assert [each.outcome for each in direct] == ["timed_out", "superseded"]


def test_a_trial_that_another_one_follows_is_over_there() -> None:
    session = (
        ExampleSession().add(1, m.TrialStarted(trial=1)).add(3, m.TrialStarted(trial=2)).end(9)
    )
    trials = lanes(session)["trials"].intervals
    assert [(each.begin // SECOND, each.end // SECOND, each.cut) for each in trials] == [
        (1, 3, True),
        (3, 9, True),
    ]
