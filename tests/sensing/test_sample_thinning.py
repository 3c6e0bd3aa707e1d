"""Sensors that are quicker than the queues mean, and settings that are read again."""

from __future__ import annotations

import dataclasses
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.sensing.visitor_samples import WITH, Visit
from woz_tui.config.engagement import EngagementSettings, JointSettings, SignSettings
from woz_tui.sensing.engagement_model import EngagementModel
from woz_tui.sensing.model_time import SECOND
from woz_tui.sensing.signs import SampleThinning

SAMPLES: dict[str, Any] = {**WITH, "identity": "Anna"}


def counted_times(times: list[int], rate: float | None) -> list[int]:
    thinning = SampleThinning(rate)
    return [t for t in times if thinning.counts(t)]


def fill(model: EngagementModel, sign: str, hertz: int, seconds: float) -> int:
    """How many places of a sign's queue say yes after samples at this rate."""
    for beat in range(1, round(hertz * seconds) + 1):
        model.advance(beat * SECOND // hertz)
        model.sample(sign, SAMPLES[sign])
    return model.shown().signs[sign].count


# -- quick sensors ------------------------------------------------------------------------------


@pytest.mark.parametrize("sign", SAMPLES)
def test_a_quick_sensor_fills_its_queue_as_slowly_as_wished(sign: str) -> None:
    """E1: eight places last 2.67 s at 3 Hz, also if the sensor sends twenty samples a second."""
    own: Any = {sign: SignSettings(rate=3)}
    assert fill(EngagementModel(EngagementSettings(samples=100)), sign, 20, 2.0) == 40
    assert fill(EngagementModel(EngagementSettings(samples=100, **own)), sign, 20, 2.0) == 7
    assert fill(EngagementModel(EngagementSettings(samples=100, **own)), sign, 2, 2.0) == 4


def test_what_does_not_count_is_shown_and_keeps_the_sign_alive() -> None:
    model = EngagementModel(EngagementSettings(samples=3, distance=SignSettings(rate=0.5)))
    for beat in range(1, 10):
        model.advance(beat * SECOND // 10)
        model.sample("distance", 0.5 + beat / 100)
    model.advance(SECOND + SECOND // 2)
    sign_shown = model.shown().signs["distance"]
    assert (sign_shown.count, sign_shown.raw, sign_shown.stale) == (1, 0.59, False)


def test_after_a_silence_the_next_sample_counts() -> None:
    model = EngagementModel(EngagementSettings(presence=SignSettings(rate=0.2)))
    model.advance(SECOND)
    model.sample("presence", 1)
    model.advance(3 * SECOND)  # the sign is stale, its queue empty
    assert model.shown().signs["presence"].count == 0
    model.sample("presence", 1)
    assert model.shown().signs["presence"].count == 1


def test_samples_that_are_none_do_not_count() -> None:
    model = EngagementModel(EngagementSettings(gaze=SignSettings(rate=3)))
    model.advance(SECOND)
    for value in (None, "NaN", 7, 1):
        model.sample("gaze", value)
    assert model.shown().signs["gaze"].count == 1


def test_a_sensor_of_just_this_rate_loses_nothing_when_it_is_early_or_late() -> None:
    late = [beat * SECOND // 3 + (150_000 if beat % 2 else 0) for beat in range(300)]
    assert counted_times(late, 3) == late


def test_without_a_rate_every_sample_counts() -> None:
    assert counted_times([0, 0, 1, 1], None) == [0, 0, 1, 1]


@given(
    st.lists(st.integers(0, SECOND), min_size=1, max_size=200), st.floats(0.1, 1000), st.integers(0)
)
def test_never_more_than_the_rate(pauses: list[int], rate: float, begins: int) -> None:
    """The first sample counts, and within any span at most rate times span, and one at each end."""
    times = [begins + sum(pauses[:count]) for count in range(1, len(pauses) + 1)]
    taken = counted_times(times, rate)
    assert taken[0] == times[0]
    for index, t in enumerate(taken):
        assert len(taken) - index <= (taken[-1] - t) * rate / SECOND + 2
    assert [t - begins for t in taken] == counted_times([t - begins for t in times], rate)


# -- settings that are read again ---------------------------------------------------------------


def test_another_rate_of_a_sign_counts_at_once() -> None:
    model = EngagementModel(EngagementSettings(samples=100))
    model.adopt(EngagementSettings(samples=100, gaze=SignSettings(rate=2)))
    assert fill(model, "gaze", 10, 3.0) == 7
    model.adopt(EngagementSettings(samples=100))
    model.sample("gaze", 1)
    model.sample("gaze", 1)
    assert model.shown().signs["gaze"].count == 9


@pytest.mark.parametrize("kind", ["fifo", "joint"])
def test_another_start_up_counts_at_once(kind: str) -> None:
    settings = EngagementSettings(filter=kind)
    model = EngagementModel(settings)
    assert model.verdicts["gaze"] == 0
    model.adopt(dataclasses.replace(settings, start_up="hold"))
    assert [model.verdicts[sign] for sign in WITH] == [None] * 3
    model.adopt(settings)
    assert [model.verdicts[sign] for sign in WITH] == [0] * 3


def test_another_glance_counts_at_once() -> None:
    """Turning away is noticed later, the longer a glance may last; what is believed stays."""
    found = []
    for glance in (0.56, 3.0):
        visit = Visit(quick=False, filter="joint")
        visit.see(30, **WITH)
        settings = visit.model.settings
        visit.model.adopt(dataclasses.replace(settings, joint=JointSettings(glance=glance)))
        assert visit.model.engaged
        found.append(next(n for n in range(1, 60) if turned_away(visit)))
    assert found[0] < found[1]


def turned_away(visit: Visit) -> bool:
    """Whether one more sample of somebody who looks elsewhere has been enough."""
    visit.see(**{**WITH, "gaze": 0})
    return not visit.model.engaged
