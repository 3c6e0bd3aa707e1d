"""The thread that keeps the rate."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable
from typing import Protocol

from woz_drivers.body.lateness import Lateness

log = logging.getLogger(__name__)

#: Does what is due at a moment, in seconds of CLOCK_MONOTONIC.
Step = Callable[[float], None]


class Ticker(Protocol):
    """Calls a step again and again."""

    @property
    def lateness(self) -> Lateness:
        """How punctual it was so far."""
        ...

    def start(self, step: Step) -> None:
        """Begin; returns at once."""
        ...

    def end(self) -> None:
        """Take no further step; returns at once."""
        ...

    @property
    def ended(self) -> bool:
        """Whether no step is being taken, nor will be."""
        ...


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
