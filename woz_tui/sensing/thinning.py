"""Fewer samples than a quick sensor sends, so that the places of a queue last as long as meant."""

from __future__ import annotations

from woz_tui.sensing.passing import SECOND


class Thinning:
    """One sample in each period of a steady beat counts: the first that comes.

    The first sample of all lies in the middle of its period, so that a sensor of just this rate
    may be half a period early or late and loses nothing. A sample that counts does so at once, and
    which ones do follows from their times (the model's, in microseconds) alone. `rate`: samples a
    second; None: all count.
    """

    def __init__(self, rate: float | None) -> None:
        self.rate = rate
        self.restart()

    def restart(self) -> None:
        """The next sample is the first."""
        self._began: int | None = None
        self._last = 0

    def beats(self, rate: float | None) -> None:
        """Another rate from now on."""
        if rate != self.rate:
            self.rate = rate
            self.restart()

    def counts(self, now: int) -> bool:
        """Whether a sample at `now`, no earlier than the one before, is to be taken."""
        if self.rate is None:
            return True
        if self._began is None:
            self._began, self._last = now, 0
            return True
        period = int((now - self._began) * self.rate / SECOND + 0.5)
        counts = period > self._last
        self._last = period
        return counts
