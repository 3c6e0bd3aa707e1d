"""Ranges: both ends belong to them, NaN never does."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from woz_tui.drivers.fields import Range

finite = st.floats(allow_nan=False, allow_infinity=False)


@given(low=finite, high=finite, value=finite)
def test_a_range_contains_what_lies_between_its_ends(low: float, high: float, value: float) -> None:
    assert Range(low, high).contains(value) == (low <= value <= high)
    assert Range(low=low).contains(value) == (low <= value)
    assert Range(high=high).contains(value) == (value <= high)


@pytest.mark.parametrize("range_", [Range(), Range(0), Range(high=1), Range(-1, 1)])
def test_nan_is_in_no_range(range_: Range) -> None:
    assert not range_.contains(math.nan)


def test_infinity_is_only_in_a_range_open_to_it() -> None:
    assert Range(0).contains(math.inf)
    assert not Range(0, 5).contains(math.inf)
    assert not Range(0).contains(-math.inf)


@pytest.mark.parametrize(
    ("range_", "words"),
    [
        (Range(0, 5, "m"), "0 to 5 m"),
        (Range(-0.5, 0.5), "-0.5 to 0.5"),
        (Range(low=1, unit="Hz"), "1 Hz or more"),
        (Range(high=90, unit="degrees"), "90 degrees or less"),
        (Range(unit="V"), "any number V"),
        (Range(), "any number"),
    ],
)
def test_a_range_reads_as_words(range_: Range, words: str) -> None:
    assert str(range_) == words
