"""How punctual ticks were, counted without keeping them."""

from __future__ import annotations

from array import array

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
