"""Clocks: monotonic time and wall time move apart only when told to."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta, timezone

import pytest
from hypothesis import given
from hypothesis import strategies as st

from woz_tui.system.clock import ManualClock, RealClock, Standstill, timestamp


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


# -- how old a press may be ------------------------------------------------------------------------


def looking(clock: ManualClock, standstill: Standstill, seconds: float) -> None:
    """Time passes while the process runs."""
    for _ in range(round(seconds / Standstill.EVERY_S)):
        clock.advance(Standstill.EVERY_S)
        standstill.age_us()


def test_what_comes_while_the_process_runs_is_fresh() -> None:
    clock = ManualClock()
    standstill = Standstill(clock)
    looking(clock, standstill, 60)
    assert standstill.age_us() == standstill.waited_us(0) == 0
    clock.advance(0.3)  # a busy machine
    assert standstill.age_us() == 0


@pytest.mark.parametrize("asleep", [False, True])
def test_what_waited_for_a_process_that_stood_still_is_as_old_as_the_pause(asleep: bool) -> None:
    clock = ManualClock()
    standstill = Standstill(clock)
    looking(clock, standstill, 10)
    (clock.sleep if asleep else clock.advance)(5)
    assert standstill.waited_us(0) == 5_000_000
    looking(clock, standstill, 0.3)  # not everything is read at once
    assert standstill.waited_us(0) == 5_300_000
    looking(clock, standstill, 0.5)
    assert standstill.waited_us(0) == 0


def test_two_pauses_in_a_row_count_as_one_while_the_first_may_not_be_read_yet() -> None:
    clock = ManualClock()
    standstill = Standstill(clock)
    clock.advance(2)
    standstill.age_us()
    clock.advance(0.45)
    assert standstill.age_us() == 2_450_000
    for _ in range(100):  # jerks for ever do not make everything old
        clock.advance(0.45)
        standstill.age_us()
    assert standstill.age_us() < 1_500_000


def test_a_stamp_says_how_long_a_request_was_under_way() -> None:
    clock = ManualClock()
    standstill = Standstill(clock)
    looking(clock, standstill, 10)
    sent = clock.boot_us()
    clock.advance(2)
    clock.sleep(3)
    assert standstill.waited_us(sent) == 5_000_000
    fresh = clock.boot_us()
    clock.advance(0.001)
    assert standstill.waited_us(fresh) == 1000, "pressed after it woke"
    nonsense = clock.boot_us() + 60_000_000
    assert standstill.waited_us(nonsense) == standstill.waited_us(0) > 5_000_000
