"""What of a session is drawn, and where."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.analysis.told import SECOND, Told, drawn, in_time
from woz_tui.analysis.lanes import PLACES, Curves, Lane, told
from woz_tui.core import messages as m


def lanes(it: Told) -> dict[str, Lane]:
    return {lane.name: lane for lane in drawn(in_time(it)).lanes}


def test_every_panel_has_a_lane() -> None:
    it = Told().act(1, took=2.0).act(5, "Nod", "Body", end="refused").act(8, took=None).end(10)
    found = lanes(it)
    speech, body = found["Speech"], found["Body"]
    assert [(each.begin, each.end, each.outcome, each.cut) for each in speech.intervals] == [
        (1 * SECOND, 3 * SECOND, "done", False),
        (8 * SECOND, 10 * SECOND, "open", True),
    ]
    assert speech.intervals[0].facts == (("say", "hello"), ("latency", "1.0 ms"))
    assert (body.intervals[0].outcome, body.intervals[0].detail) == ("refused", "locked")


def test_states_follow_each_other_without_a_gap() -> None:
    it = Told().state(10, "Wait", "PersonDetected").state(20, "PersonDetected", "Wait").end(30)
    states = lanes(it)["engagement"].intervals
    assert [(each.label, each.begin // SECOND, each.end // SECOND) for each in states] == [
        ("Wait", 0, 10),
        ("PersonDetected", 10, 20),
        ("Wait", 20, 30),
    ]


def test_lanes_come_in_a_fixed_order() -> None:
    it = Told().act(1).add(2, m.Note(text="x")).add(3, m.StopPressed(source="key"))
    it.add(4, m.DriverLost(driver="head")).state(5, "Wait", "PersonDetected").speech(6, 7)
    it.add(8, m.TrialStarted(trial=1)).add(9, m.TrialEnded(trial=1, outcome="excluded")).end(10)
    timeline = drawn(in_time(it))
    assert [lane.sort for lane in timeline.lanes] == [
        *("trial", "engagement", "speech", "panel", "stop", "driver", "mark")
    ]
    assert timeline.lanes[0].intervals[0].outcome == "excluded"
    assert timeline.lanes[4].intervals[0].end == 10 * SECOND


def test_what_was_understood_belongs_to_its_utterance() -> None:
    it = Told().speech(1, 3).speech(5, 6, 2)
    it.add(7, m.SpeechText(driver="mic", segment=1, text="where is the exit"))
    first, second = lanes(it.end(9))["visitor speaks"].intervals
    assert (first.detail, second.detail) == ("where is the exit", "")


def test_arguments_in_a_few_words() -> None:
    assert told({"text": "Hello"}) == "Hello"
    assert told({"yaw": 10.0, "on": True}) == "yaw 10.0, on true"
    assert len(told({"text": "x" * 500})) == 200


@given(st.lists(st.integers(0, 3_600), min_size=1, max_size=50))
def test_a_curve_keeps_its_mean_and_never_grows(times: list[int]) -> None:
    curves = Curves()
    for t in sorted(times):
        curves.take(m.Reading(sensor="distance", value=2.5, unit="m"), t * SECOND)
    [curve] = curves
    assert len(curve.values) <= PLACES
    assert {value for value in curve.values if value is not None} == {2.5}
    assert curve.unit == "m"


def test_a_curve_is_a_mean_of_what_falls_together() -> None:
    curves = Curves()
    for t, value in ((0, 1.0), (10_000, 3.0), (60_000, 5.0)):
        curves.take(m.Reading(sensor="distance", value=value), t)
    curves.take(m.Reading(sensor="distance", value=None), 70_000)
    curves.take(m.Reading(sensor="gaze", value=1.0), 70_000)
    [curve] = curves
    assert curve.values == pytest.approx((2.0, 5.0))
