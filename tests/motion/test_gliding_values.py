"""Values that may be changed at any moment."""

from __future__ import annotations

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from woz_tui.motion.easing import GlidingValue


@pytest.mark.toolkit("P1")
@given(
    st.lists(st.floats(0, 1), min_size=1, max_size=20),
    st.floats(0.001, 0.2),
    st.integers(1, 40),
)
def test_it_never_leaves_the_goals_and_never_jumps(
    goals: list[float], dt: float, ticks: int
) -> None:
    value = GlidingValue(0.0, 8.0)
    seen = [0.0]
    for goal in goals:
        seen += [value.step(goal, dt) for _ in range(ticks)]
    assert min(seen) >= -1e-9
    assert max(seen) <= max(goals) + 1e-9
    assert all(abs(b - a) <= 8.0 * dt + 1e-9 for a, b in itertools.pairwise(seen))


def test_it_arrives_exactly_and_stays() -> None:
    value = GlidingValue(0.0, 8.0)
    way = [value.step(1.0, 0.02) for _ in range(150)]
    assert way == sorted(way)
    assert way[29] == pytest.approx(0.95, abs=0.02)
    assert way[-1] == 1.0


@pytest.mark.toolkit("P1", "K3")
def test_a_goal_that_keeps_moving_is_followed_on_the_way() -> None:
    value = GlidingValue(0.0, 8.0)
    behind = [0.5 * tick * 0.02 - value.step(0.5 * tick * 0.02, 0.02) for tick in range(100)]
    assert max(behind) <= 0.5 * 2 / 8.0 + 0.02


def test_an_endless_step_is_there() -> None:
    value = GlidingValue(0.0, 8.0)
    assert value.step(1.0, 1e4) == 1.0
