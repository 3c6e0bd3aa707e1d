"""What raw values mean, and what is none: the policies that the paper leaves open."""

from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from woz_tui.sensing import sample_values
from woz_tui.sensing.sample_values import UNKNOWN, zone

#: Whatever a line of JSON, or a driver, may hold.
JUNK: tuple[object, ...] = (
    *(None, math.nan, "NaN", math.inf, "Infinity", -math.inf, "-Infinity", True, False),
    *("", " ", "1", "yes", "nan", "\x00", "\ud800", "x" * 10**5, b"\xff", [], [1], {}, {"a": {}}),
    *(1e300, -1e300, 10**400, -(10**400), -1, 2, 0, 1, 0.0, -0.0, 5e-324, object(), 1j),
)
anything = st.sampled_from(JUNK) | st.floats() | st.integers() | st.text() | st.binary()


@given(anything)
def test_no_value_raises_and_no_verdict_is_nan(value: object) -> None:
    assert sample_values.presence(value) in (True, False, None)
    assert sample_values.gaze(value) in (True, False, None)
    metres = sample_values.metres(value, 5.0)
    assert metres is None or 0.0 < metres <= 5.0 or metres == math.inf
    name = sample_values.name(value)
    assert name is None or 0 < len(name) <= 64
    level = sample_values.level(value, 0.1)
    assert level is None or 0.0 <= level <= 1.0
    assert sample_values.absent(value) in (True, False)


NO_FLAG: list[Any] = [
    *((None, None), (math.nan, None), ("NaN", None), (-1, None), (-0.3, None), ("1", None)),
    *((math.inf, None), ("Infinity", None), (-math.inf, None), ([1], None), ({"a": 1}, None)),
]


@pytest.mark.parametrize(
    ("value", "meant"),
    [
        *((1, True), (0, False), (0.0, False), (-0.0, False), (True, True), (False, False)),
        *((2, True), (0.5, True), (0.49, True), (0.01, True), (7.0, True), (1e300, True)),
        *((10**400, True), *NO_FLAG),
    ],
)
def test_any_number_above_zero_is_somebody(value: object, meant: bool | None) -> None:
    """A recogniser may count faces, or say how sure it is."""
    assert sample_values.presence(value) is meant


@pytest.mark.parametrize(
    ("value", "meant"),
    [
        *((1, True), (0, False), (True, True), (False, False), (0.5, True), (0.49, False)),
        *((2, True), (1.01, True), (1e300, True), *NO_FLAG),
    ],
)
def test_gaze_is_a_share_or_a_count(value: object, meant: bool | None) -> None:
    """How surely somebody looks, from 0 to 1; or how many do."""
    assert sample_values.gaze(value) is meant


@pytest.mark.parametrize(
    ("value", "meant"),
    [
        *((0.9, 0.9), (5.0, 5.0), (0.3, 0.3), (0.01, 0.01), (1, 1.0)),
        *((5.1, math.inf), (math.inf, math.inf), ("Infinity", math.inf), (10**400, math.inf)),
        *((0, None), (-0.0, None), (-1, None), (-math.inf, None), ("-Infinity", None)),
        *((None, None), (math.nan, None), ("NaN", None), (True, None), ("0.9", None), ({}, None)),
    ],
)
def test_distance(value: object, meant: float | None) -> None:
    """Beyond the reach is far; nothing and less is no measurement; the sonar's floor is near."""
    assert sample_values.metres(value, 5.0) == meant


@pytest.mark.parametrize(
    ("value", "text", "meant"),
    [
        *(("Anna", "", "Anna"), (" Anna  B ", "", "Anna B"), (0.8, "Anna", "Anna")),
        *(("Unknown", "", UNKNOWN), ("unknown", "", UNKNOWN), (" ", "", UNKNOWN)),
        *((0.2, "", UNKNOWN), (0, "", UNKNOWN), (None, "", None), (math.nan, "", None)),
        *(("NaN", "", None), (True, "", None), ([], "", None), ("a\x07b", "", None)),
        *(("\ud800", "", None), ("x" * 10**5, "", None), ("\u202eanna", "", None)),
    ],
)  # fmt: skip
def test_identity(value: object, text: str, meant: str | None) -> None:
    assert sample_values.name(value, text) == meant


@pytest.mark.parametrize(
    ("value", "threshold", "meant"),
    [
        *((0.2, 0.1, 0.2), (0, 0.1, 0.0), (1.0, 0.1, 1.0), (math.nan, 0.1, 0.0), ("NaN", 0.1, 0.0)),
        *((None, 0.1, None), (-0.1, 0.1, None), (1.5, 0.1, None), (math.inf, 0.1, None)),
        *((3000, 2400.0, 3000.0), (math.inf, 2400.0, None), ("0.2", 0.1, None), (True, 0.1, None)),
    ],
)
def test_loudness(value: object, threshold: float, meant: float | None) -> None:
    """NaN is a quiet chunk, None is none; above full scale only on a scale without full scale."""
    assert sample_values.level(value, threshold) == meant


def test_nothing_is_told_from_rubbish() -> None:
    assert all(map(sample_values.absent, (None, math.nan, "NaN")))
    assert not any(map(sample_values.absent, (0, "x", [], True, math.inf, "Infinity")))


ZONES: list[Any] = [
    *((0.0, "intimate"), (0.449, "intimate"), (0.45, "personal"), (1.19, "personal")),
    *((1.2, "social"), (3.59, "social"), (3.6, "public"), (math.inf, "public")),
]


@pytest.mark.parametrize(("metres", "space"), ZONES)
def test_halls_spaces(metres: float, space: str) -> None:
    assert zone(metres) == space


def test_no_distance_is_in_no_space() -> None:
    assert zone(math.nan) == ""


@pytest.mark.parametrize(
    ("before", "now", "firm"),
    [
        ("", "where is", ""),
        ("where is the", "Where is the rome", "Where is the"),
        ("where is the row", "where is the roman glass", "where is the"),
        ("where is. The", "where is the roman", "where is the"),
        ("there is", "where is", ""),
    ],
)
def test_what_two_texts_so_far_agree_on_is_firm(before: str, now: str, firm: str) -> None:
    assert sample_values.agreed(before, now) == firm
