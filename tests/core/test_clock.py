"""Clocks: monotonic time and wall time move apart only when told to."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta, timezone

import pytest
from hypothesis import given
from hypothesis import strategies as st

from woz_tui.core.clock import ManualClock, RealClock, timestamp


def test_the_real_clock_never_goes_back() -> None:
    clock = RealClock()
    moments = [clock.now_us() for _ in range(1000)]
    assert moments == sorted(moments)


def test_the_real_clocks_wall_is_in_utc() -> None:
    before = datetime.now(UTC)
    wall = RealClock().wall()
    assert before <= wall <= datetime.now(UTC)
    assert wall.utcoffset() == timedelta(0)


@given(st.lists(st.floats(0, 1e6), max_size=10))
def test_a_manual_clock_moves_both_times_by_what_it_is_told(steps: list[float]) -> None:
    start = datetime(2026, 3, 29, 0, 59, 59, tzinfo=UTC)
    clock = ManualClock(start)
    for seconds in steps:
        clock.advance(seconds)
    assert clock.now_us() == sum(round(seconds * 1_000_000) for seconds in steps)
    assert clock.wall() - start == timedelta(microseconds=clock.now_us())


def test_a_time_server_moves_only_the_wall() -> None:
    clock = ManualClock()
    was = clock.wall()
    clock.advance(2)
    clock.shift_wall(-3600)
    assert clock.now_us() == 2_000_000
    assert clock.wall() == was + timedelta(seconds=2 - 3600)


@pytest.mark.parametrize("seconds", [-0.001, float("nan")])
def test_time_cannot_go_back(seconds: float) -> None:
    clock = ManualClock()
    with pytest.raises(ValueError, match="cannot go back"):
        clock.advance(seconds)
    assert clock.now_us() == 0


def test_timestamps_are_rfc_3339_in_utc_with_microseconds() -> None:
    summer = timezone(timedelta(hours=2))
    moment = datetime(2026, 7, 1, 12, 0, 0, 5, tzinfo=summer)
    assert timestamp(moment) == "2026-07-01T10:00:00.000005Z"


@given(st.datetimes(min_value=datetime(1970, 1, 2), timezones=st.timezones()))
def test_a_timestamp_names_the_same_instant(moment: datetime) -> None:
    assert datetime.fromisoformat(timestamp(moment)) == moment.astimezone(UTC)
