"""Intervals of means and differences, beside tables and figures that others computed."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from woz_tui.analysis.intervals import (
    Estimate,
    differences,
    mean_interval,
    paired_difference,
    t_quantile,
    t_share,
    welch_difference,
    within_intervals,
)

WARM, SOBER = [4.0, 2.0, 6.0, 3.0, 5.0], [6.0, 5.0, 7.0, 3.0, 6.0]
#: Student's t: a printed table (two sides, 5 % and 1 %) by degrees of freedom.
TABLE = {
    1: (12.706, 63.657),
    2: (4.303, 9.925),
    3: (3.182, 5.841),
    4: (2.776, 4.604),
    5: (2.571, 4.032),
    9: (2.262, 3.250),
    10: (2.228, 3.169),
    23: (2.069, 2.807),
    30: (2.042, 2.750),
    60: (2.000, 2.660),
    120: (1.980, 2.617),
    1_000_000: (1.960, 2.576),
}


def half(estimate: Estimate | None) -> float:
    assert estimate is not None
    assert estimate.half is not None
    return estimate.half


@pytest.mark.parametrize("df", TABLE)
def test_quantiles_are_those_of_the_table(df: int) -> None:
    found = (t_quantile(0.975, df), t_quantile(0.995, df))
    assert tuple(round(each, 3) for each in found) == TABLE[df]


@pytest.mark.parametrize("share", [0.5, 0.9, 0.975, 0.9999])
def test_quantiles_have_closed_forms_of_one_and_of_two_degrees(share: float) -> None:
    assert t_quantile(share, 1) == pytest.approx(math.tan(math.pi * (share - 0.5)), rel=1e-12)
    two = (2 * share - 1) * math.sqrt(2 / (4 * share * (1 - share)))
    assert t_quantile(share, 2) == pytest.approx(two, rel=1e-12, abs=1e-12)


@given(st.floats(0.001, 0.999), st.floats(0.5, 1e4))
def test_a_quantile_has_its_share_below_it(share: float, df: float) -> None:
    assert t_share(t_quantile(share, df), df) == pytest.approx(share, abs=1e-11)
    assert t_quantile(1 - share, df) == pytest.approx(-t_quantile(share, df), rel=1e-6, abs=1e-9)


@pytest.mark.parametrize(("share", "df"), [(0, 3), (1, 3), (0.5, 0), (0.5, -1)])
def test_what_has_no_quantile_is_refused(share: float, df: float) -> None:
    with pytest.raises(ValueError, match="no quantile"):
        t_quantile(share, df)


def test_of_two_groups_each_has_its_interval() -> None:
    assert half(mean_interval(WARM)) == pytest.approx(1.963, abs=5e-4)
    assert half(mean_interval(SOBER)) == pytest.approx(1.883, abs=5e-4)
    found = mean_interval(SOBER)
    assert found is not None
    assert (found.mean, found.n) == (5.4, 5)


def test_of_the_same_people_their_level_is_taken_out_and_the_factor_put_back() -> None:
    found = within_intervals(list(zip(WARM, SOBER, strict=True)))
    assert [each.mean for each in found] == [4.0, 5.4]
    assert [half(each) for each in found] == pytest.approx([1.001, 1.001], abs=5e-4)
    # Without the factor of Morey it would be that of Cousineau, too small by a square root of two.
    assert half(found[0]) / math.sqrt(2) == pytest.approx(0.708, abs=5e-4)


def test_the_difference_of_pairs_has_its_interval() -> None:
    found = paired_difference(list(zip(WARM, SOBER, strict=True)))
    assert found is not None
    assert found.mean == pytest.approx(1.4)
    assert half(found) == pytest.approx(1.416, abs=5e-4)


def test_two_groups_have_the_interval_of_their_difference() -> None:
    # By hand: variances 2.5 and 2.3, so 0.96 ** 2 / (0.25 / 4 + 0.2116 / 4) = 7.986 degrees.
    found = welch_difference(WARM, SOBER)
    assert found is not None
    assert found.mean == pytest.approx(1.4)
    assert found.n == 10
    assert half(found) == pytest.approx(2.3064 * math.sqrt(0.96), abs=1e-3)
    # Where both vary alike it is the interval of old: 6 degrees, a variance of 5 / 3.
    alike = welch_difference([1.0, 2.0, 3.0, 4.0], [11.0, 12.0, 13.0, 14.0])
    assert half(alike) == pytest.approx(2.447 * math.sqrt(5 / 3 / 2), abs=1e-3)


def test_of_few_values_there_is_no_interval() -> None:
    assert mean_interval([]) is None
    assert mean_interval([3.0, 5.0]) == Estimate(4.0, None, 2)
    assert paired_difference([(1.0, 2.0)]) == Estimate(1.0, None, 1)
    assert welch_difference([1.0, 2.0], [4.0, 4.0, 4.0]) == Estimate(2.5, None, 5)
    assert welch_difference([], [1.0]) is None
    assert within_intervals([]) == []


def test_values_that_do_not_vary_have_an_interval_without_width() -> None:
    assert mean_interval([4.0] * 5) == Estimate(4.0, 0.0, 5)
    assert welch_difference([4.0] * 3, [5.0] * 3) == Estimate(1.0, 0.0, 6)


def test_of_several_conditions_every_two_are_compared_and_intervals_are_wider() -> None:
    people = [f"P{number}" for number in range(5)]
    warm = dict(zip(people, WARM, strict=True))
    sober = dict(zip(people, SOBER, strict=True))
    [two] = differences({"warm": warm, "sober": sober}, paired=True)
    assert (two.first, two.other, two.estimate.n) == ("warm", "sober", 5)
    three = differences({"warm": warm, "sober": sober, "none": {"P0": 1.0}}, paired=True)
    assert [(each.first, each.other) for each in three] == [
        *(("warm", "sober"), ("warm", "none"), ("sober", "none"))
    ]
    assert half(three[0].estimate) == pytest.approx(
        half(two.estimate) * t_quantile(1 - 0.05 / 6, 4) / t_quantile(0.975, 4)
    )
    assert three[1].estimate == Estimate(-3.0, None, 1)
    [apart] = differences({"warm": warm, "sober": sober}, paired=False)
    assert apart.estimate == welch_difference(WARM, SOBER)
