"""How long a thread has waited for a processor, so that nobody is blamed for a busy machine."""

from __future__ import annotations

import logging
import os
import time

#: A loop that gives no sign of life for so much longer than usual stands still, in seconds.
STALL_S = 0.25
#: Two looks between which a thread waits no longer are one, in seconds.
_TOGETHER_S = 0.01

log = logging.getLogger(__name__)


class ProcessorWaits:
    """Of the thread in which it is made; `now` is for that thread."""

    def __init__(self) -> None:
        self._turns = -1
        try:
            self._turns = os.open("/proc/thread-self/schedstat", os.O_RDONLY | os.O_CLOEXEC)
        except OSError:
            log.warning("this kernel does not tell how long a thread waits for a processor")

    def now(self) -> tuple[float, float]:
        """The monotonic clock, and for how long the thread has waited until then, in seconds."""
        while True:
            before_s, now, waited_s = self._seconds(), time.monotonic(), self._seconds()
            if waited_s - before_s < _TOGETHER_S:  # else it waited between the two
                return now, waited_s

    def close(self) -> None:
        """Look no more."""
        if self._turns >= 0:
            os.close(self._turns)
            self._turns = -1

    def _seconds(self) -> float:
        return int(os.pread(self._turns, 64, 0).split()[1]) / 1e9 if self._turns >= 0 else 0.0
