"""The simulated visitor: repeatable, plausible, and it answers the robot."""

from __future__ import annotations

import statistics
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from woz_drivers.simulated.senses import DOOR, SENSORS, WALL, Sample
from woz_drivers.simulated.visitor import SimulatedVisitor, VisitPhase

from tests.example_counts import many

HOUR = 3600.0


def by_sensor(samples: list[Sample], sensor: str) -> list[Sample]:
    return [sample for sample in samples if sample.sensor == sensor]


@settings(max_examples=many(20))
@given(st.integers(0, 2**31 - 1), st.lists(st.floats(0, 20), min_size=1, max_size=8))
def test_same_seed_same_samples_whatever_the_steps(seed: int, pauses: list[float]) -> None:
    end = sum(pauses)
    stepped = SimulatedVisitor(seed)
    now = 0.0
    samples = []
    for pause in pauses:
        now += pause
        samples += stepped.step(now)
    assert samples == SimulatedVisitor(seed).step(end)


def test_different_seeds_differ() -> None:
    assert SimulatedVisitor(1).step(60.0) != SimulatedVisitor(2).step(60.0)


@pytest.fixture(scope="module")
def hour() -> list[Sample]:
    return SimulatedVisitor(7).step(HOUR)


def test_distance_and_loudness_come_ten_times_a_second(hour: list[Sample]) -> None:
    assert {sample.sensor for sample in hour} == set(SENSORS)
    assert len(by_sensor(hour, "distance")) == HOUR * 10
    assert len(by_sensor(hour, "loudness")) == HOUR * 10
    assert len(by_sensor(hour, "gaze")) == HOUR * 10 // 3


def test_values_stay_within_what_the_sensors_can_say(hour: list[Sample]) -> None:
    distances = [s.value for s in by_sensor(hour, "distance") if s.value is not None]
    assert min(distances) > 0.5
    assert max(distances) < WALL + 0.2
    loudness = [s.value for s in by_sensor(hour, "loudness") if s.value is not None]
    assert all(0 < value <= 1 for value in loudness)
    for sensor in ("presence", "gaze"):
        assert {s.value for s in by_sensor(hour, sensor)} == {0.0, 1.0}


def test_both_visitors_come_and_nobody_is_recognised_at_the_door(hour: list[Sample]) -> None:
    assert {s.text for s in by_sensor(hour, "identity")} == {"", "V1", "V2"}
    first = next(s for s in by_sensor(hour, "identity") if s.text)
    near = [s.value for s in by_sensor(hour, "distance") if first.t - 1 < s.t <= first.t]
    assert all(value is None or value < 2.5 for value in near)


def test_echoes_are_lost_rarely(hour: list[Sample]) -> None:
    distances = by_sensor(hour, "distance")
    lost = sum(sample.value is None for sample in distances)
    assert 0 < lost < len(distances) * 0.06


def test_every_phase_occurs_and_a_visit_lasts(hour: list[Sample]) -> None:
    visitor = SimulatedVisitor(7)
    phases = [visitor.phase]
    for tenth in range(1, int(HOUR * 10)):
        visitor.step(tenth / 10)
        if visitor.phase is not phases[-1]:
            phases.append(visitor.phase)
    assert set(phases) == set(VisitPhase)
    assert all(b is VisitPhase.COMING for a, b in pairwise(phases) if a is VisitPhase.AWAY)
    assert phases.count(VisitPhase.COMING) > 30
    assert DOOR > 4


def talk_to(visitor: SimulatedVisitor, begins: float, seconds: float, until: float) -> list[Sample]:
    visitor.hear(begins, seconds)
    return by_sensor(visitor.step(until), "loudness")


def arrived() -> tuple[SimulatedVisitor, float]:
    visitor = SimulatedVisitor(7)
    now = 0.0
    while visitor.phase is not VisitPhase.STAYING or visitor.talking:
        now += 0.1
        visitor.step(now)
        assert now < 60
    return visitor, now


def test_a_visitor_who_is_spoken_to_looks_up_and_answers_within_two_seconds() -> None:
    visitor, now = arrived()
    heard = talk_to(visitor, now, 1.0, now + 3.5)
    assert visitor.looking
    answer = [s.t for s in heard if s.value is not None and s.value > 0.05]
    assert now + 1.9 < answer[0] < now + 3.3


def test_speech_rises_above_the_room_and_is_made_of_syllables() -> None:
    visitor, now = arrived()
    heard = talk_to(visitor, now, 0.1, now + 3.5)
    spoken = [s.value for s in heard if s.value is not None and now + 2.6 < s.t < now + 3.2]
    assert statistics.mean(spoken) > 0.05
    assert max(spoken) > 1.5 * min(spoken)


def test_nobody_answers_in_an_empty_room() -> None:
    visitor = SimulatedVisitor(7)
    visitor.hear(0.1, 0.1)
    loudness = [s.value for s in by_sensor(visitor.step(2.0), "loudness")]
    assert all(value is not None and value < 0.04 for value in loudness)
