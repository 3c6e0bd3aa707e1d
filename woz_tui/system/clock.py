"""Time as the session knows it, injected everywhere so that tests decide what time it is."""

from __future__ import annotations

import time
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Protocol


class Clock(Protocol):
    """A monotonic clock tied to the wall clock at one instant."""

    def now_us(self) -> int:
        """Whole microseconds on a clock that never goes back; its zero is arbitrary."""

    def boot_us(self) -> int:
        """The same for all processes of one boot of the machine, whose sleep counts too."""

    def wall(self) -> datetime:
        """The wall clock, in UTC."""


class RealClock:
    """CLOCK_MONOTONIC for order and durations, the system's wall clock for dates."""

    def now_us(self) -> int:
        """Microseconds of CLOCK_MONOTONIC."""
        return time.monotonic_ns() // 1000

    def boot_us(self) -> int:
        """Microseconds of CLOCK_BOOTTIME."""
        return time.clock_gettime_ns(time.CLOCK_BOOTTIME) // 1000

    def wall(self) -> datetime:
        """The system's wall clock in UTC."""
        return datetime.now(UTC)


class ManualClock:
    """A clock that moves only when told to; for tests and for rendering without a robot."""

    def __init__(self, start: datetime | None = None) -> None:
        self._start = start or datetime(2026, 3, 1, 10, 0, 0, tzinfo=UTC)
        self._elapsed_us = 0
        self._wall_shift = timedelta()
        self._asleep_us = 0

    def now_us(self) -> int:
        """Microseconds advanced so far."""
        return self._elapsed_us

    def boot_us(self) -> int:
        """Microseconds advanced and slept so far."""
        return self._elapsed_us + self._asleep_us

    def wall(self) -> datetime:
        """The start date plus what was advanced and shifted."""
        return self._start + timedelta(microseconds=self._elapsed_us) + self._wall_shift

    def advance(self, seconds: float) -> None:
        """Let time pass; `seconds` >= 0."""
        if not seconds >= 0:
            raise ValueError(f"time cannot go back: advance({seconds})")
        self._elapsed_us += round(seconds * 1_000_000)

    def sleep(self, seconds: float) -> None:
        """Suspend the machine: only `boot_us` goes on."""
        self._asleep_us += round(seconds * 1_000_000)

    def shift_wall(self, seconds: float) -> None:
        """Set the wall clock forward or back, as a time server does; `now_us` does not move."""
        self._wall_shift += timedelta(seconds=seconds)


def timestamp(moment: datetime) -> str:
    """RFC 3339 in UTC with microseconds, for example `2026-03-01T10:00:00.000000Z`."""
    return moment.astimezone(UTC).strftime("%Y-%m-%dT%H:%M:%S.%fZ")


def boot_id() -> str:
    """Identifies this boot of the machine (it is random, so it tells nothing about it)."""
    try:
        return Path("/proc/sys/kernel/random/boot_id").read_text(encoding="ascii").strip()
    except OSError:
        return ""


class Standstill:
    """How long a press may have waited for this process while it was stopped, blocked or asleep.

    `age_us` is to be called every `EVERY_S`. What a longer pause between two calls left waiting (in
    sockets, pipes, ports of devices) is read within `AFTER_S`; all that comes without a time stamp
    until then counts as old as the pause.
    """

    EVERY_S = 0.1
    AFTER_S = 0.5
    #: A pause below this is a busy machine.
    LEAST_S = 0.4

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._seen_us = clock.boot_us()
        #: When each of the last pauses began and ended.
        self._pauses: list[tuple[int, int]] = []

    def age_us(self) -> int:
        """The process runs. How old something may be that came just now, in microseconds."""
        now, seen = self._clock.boot_us(), self._seen_us
        self._seen_us = now
        if now - seen > self.LEAST_S * 1_000_000:
            self._pauses.append((seen, now))
        after_us = self.AFTER_S * 1_000_000
        self._pauses = [pause for pause in self._pauses if now - pause[1] <= after_us]
        return now - min((began for began, _ in self._pauses), default=now)

    def since_us(self) -> int:
        """`Clock.boot_us` since which something may have waited that came just now."""
        return self._clock.boot_us() - self.age_us()

    def waited_us(self, sent_us: int) -> int:
        """How long a request was under way that was stamped with `sent_us` of `Clock.boot_us`
        (0: it was not), in microseconds.
        """
        waited = self._clock.boot_us() - sent_us
        return waited if sent_us > 0 and waited >= 0 else self.age_us()
