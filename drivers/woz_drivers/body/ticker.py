"""The thread that keeps the rate."""

from __future__ import annotations

import logging
import threading
import time
from array import array
from collections.abc import Callable

# -- lateness -------------------------------------------------------------------------------------
# How punctual ticks were, counted without keeping them.

#: Width of a bin in milliseconds, and how many there are; later ticks share the last one.
BIN_MS = 0.05
BINS = 4000


class Lateness:
    """A histogram of milliseconds, cheap enough for every tick of a long session.

    Attributes:
        ticks: How many were counted.
        missed: Ticks that were left out because the one before came too late.
        worst: The latest tick, in milliseconds.
    """

    def __init__(self) -> None:
        self.ticks = 0
        self.missed = 0
        self.worst = 0.0
        self._bins = array("L", [0]) * BINS
        self._recent = 0.0

    def count(self, late_ms: float, missed: int = 0) -> None:
        """A tick came `late_ms` after its time, and `missed` were left out before it."""
        self.ticks += 1
        self.missed += missed
        self.worst = max(self.worst, late_ms)
        self._recent = max(self._recent, late_ms)
        self._bins[min(max(int(late_ms / BIN_MS), 0), BINS - 1)] += 1

    def quantile(self, share: float) -> float:
        """Milliseconds that at least `share` (0..1) of the ticks kept to; 0 without any."""
        left = share * self.ticks
        for index, number in enumerate(self._bins):
            left -= number
            if left <= 0 and number:
                return min((index + 1) * BIN_MS, self.worst)
        return self.worst

    def recent(self) -> float:
        """The latest tick, in milliseconds, since this was last asked."""
        recent, self._recent = self._recent, 0.0
        return recent

    def __str__(self) -> str:
        return (
            f"{self.ticks} ticks, late by {self.quantile(0.5):.2f} ms (half of them),"
            f" {self.quantile(0.99):.2f} ms (99 %), {self.worst:.1f} ms (the latest);"
            f" {self.missed} left out"
        )


# --------------------------------------------------------------------------------------------------

log = logging.getLogger(__name__)

#: Does what is due at a moment, in seconds of CLOCK_MONOTONIC.
Step = Callable[[float], None]


class ThreadTicker:
    """Ticks in a thread of its own, at absolute deadlines of CLOCK_MONOTONIC.

    A late tick does not push the next ones back, and ticks that were missed altogether are not made
    up for: whoever ticks goes by the time, not by the number of ticks.

    The interpreter's switch interval stays as it is. It belongs to the whole process, and 0.5 ms in
    place of 5 ms made no difference that stood out from one run of `benchmarks/motion_rate.py` to
    the next: the event loop hardly ever computes for as long as that.
    """

    def __init__(self, rate: float, name: str) -> None:
        self.lateness = Lateness()
        self._period = 1.0 / rate
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._run, name=f"body {name}", daemon=True)
        self._step: Step = lambda now: None

    def start(self, step: Step) -> None:
        """Begin to call `step`."""
        self._step = step
        self._thread.start()

    def end(self) -> None:
        """Let the thread end; one that waits wakes up for it."""
        self._closing.set()

    @property
    def ended(self) -> bool:
        """Whether the thread is not there, or no more."""
        return not self._thread.is_alive()

    def _run(self) -> None:
        due = time.monotonic()
        while not self._closing.wait(max(0.0, due - time.monotonic())):
            now = time.monotonic()
            if now < due:  # a wait may end a moment early
                continue
            late = now - due
            missed = int(late / self._period)
            self.lateness.count(late * 1000, missed)
            try:
                self._step(now)
            except Exception:  # the thread must outlive whatever a tick meets
                log.exception("a tick failed")
            due += (1 + missed) * self._period
