"""Quantiles, means and their edges."""

from __future__ import annotations

import statistics

import pytest
from hypothesis import given
from hypothesis import strategies as st

from woz_tui.analysis.durations import Durations, mean_and_sd, quantile
from woz_tui.timeline.session_state import LATEST_TIME

TIMES = st.lists(st.integers(0, 10**9), min_size=2, max_size=60)


@given(TIMES)
def test_quantiles_are_those_of_the_standard_library(times: list[int]) -> None:
    cuts = statistics.quantiles(times, n=100, method="inclusive")
    series = Durations(times)
    assert series.median == pytest.approx(statistics.median(times))
    assert series.p95 == pytest.approx(cuts[94])
    assert series.quantile(0.25) == pytest.approx(cuts[24])


def test_a_quantile_lies_between_its_neighbours() -> None:
    assert quantile([0, 10], 0.5) == 5
    assert quantile([1, 2, 3, 4], 0.95) == pytest.approx(3.85)
    assert quantile([7], 0.95) == 7


@given(TIMES)
def test_mean_and_deviation(times: list[int]) -> None:
    series = Durations(times)
    assert series.mean == pytest.approx(statistics.fmean(times))
    assert series.sd == pytest.approx(statistics.stdev(times))
    assert series.most == max(times)
    assert series.total == sum(times)


def test_nothing_has_no_figures() -> None:
    empty = Durations()
    assert (empty.median, empty.p95, empty.mean, empty.sd, empty.most) == (None,) * 5
    assert (empty.n, empty.total, len(empty)) == (0, 0, 0)
    assert mean_and_sd([]) == (None, None)
    assert mean_and_sd([3.0]) == (3.0, None)


@given(TIMES, TIMES)
def test_two_series_together_are_one(first: list[int], second: list[int]) -> None:
    both = Durations(first)
    assert both.median is not None  # it has been put in order, and grows all the same
    both.extend(Durations(second))
    assert both == Durations([*second, *first])


def test_what_no_clock_can_say_is_brought_near() -> None:
    series = Durations([-5, 10**30])
    assert list(series.values) == [0, LATEST_TIME]
