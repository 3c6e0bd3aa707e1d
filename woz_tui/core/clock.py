"""Time as the session knows it, injected everywhere so that tests decide what time it is."""

from __future__ import annotations

import time
from datetime import UTC, datetime, timedelta
from typing import Protocol


class Clock(Protocol):
    """A monotonic clock tied to the wall clock at one instant."""

    def now_us(self) -> int:
        """Whole microseconds on a clock that never goes back; its zero is arbitrary."""
        ...

    def wall(self) -> datetime:
        """The wall clock, in UTC."""
        ...


class RealClock:
    """CLOCK_MONOTONIC for order and durations, the system's wall clock for dates."""

    def now_us(self) -> int:
        """Microseconds of CLOCK_MONOTONIC."""
        return time.monotonic_ns() // 1000

    def wall(self) -> datetime:
        """The system's wall clock in UTC."""
        return datetime.now(UTC)


class ManualClock:
    """A clock that moves only when told to; for tests and for rendering without a robot."""

    def __init__(self, start: datetime | None = None) -> None:
        self._start = start or datetime(2026, 3, 1, 10, 0, 0, tzinfo=UTC)
        self._elapsed_us = 0
        self._wall_shift = timedelta()

    def now_us(self) -> int:
        """Microseconds advanced so far."""
        return self._elapsed_us

    def wall(self) -> datetime:
        """The start date plus what was advanced and shifted."""
        return self._start + timedelta(microseconds=self._elapsed_us) + self._wall_shift

    def advance(self, seconds: float) -> None:
        """Let time pass; `seconds` >= 0."""
        if not seconds >= 0:
            raise ValueError(f"time cannot go back: advance({seconds})")
        self._elapsed_us += round(seconds * 1_000_000)

    def shift_wall(self, seconds: float) -> None:
        """Set the wall clock forward or back, as a time server does; `now_us` does not move."""
        self._wall_shift += timedelta(seconds=seconds)


def timestamp(moment: datetime) -> str:
    """RFC 3339 in UTC with microseconds, for example `2026-03-01T10:00:00.000000Z`."""
    return moment.astimezone(UTC).strftime("%Y-%m-%dT%H:%M:%S.%fZ")
