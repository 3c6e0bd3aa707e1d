"""From single measurements to a distance one can act on; free of any input or output.

A text framing without a checksum turns line noise into plausible numbers, and every ultrasonic
sensor hears a stray echo now and then. So each value passes three gates: range, jump, median.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class FilterLimits:
    """What a distance must pass; lengths in metres.

    Outside `nearest` to `farthest` a value is noise. At or below `floor` the device only knows
    "this near or nearer", at or above `ceiling` "nothing in range": such values become the floor
    or the ceiling itself. A value more than `jump` away from the last accepted one (0: no limit)
    is held back until `confirm` values in all agree with it. The result is the median of the
    last `median` accepted values.
    """

    nearest: float
    farthest: float
    floor: float | None
    ceiling: float | None
    jump: float
    confirm: int
    median: int


@dataclass(frozen=True, slots=True)
class FilteredDistance:
    """A distance in metres, or None and why the value was not taken: range or jump."""

    metres: float | None
    why: str = ""


class DistanceFilter:
    """Applies `FilterLimits` to one stream of values."""

    def __init__(self, gates: FilterLimits) -> None:
        self._gates = gates
        self._accepted: deque[float] = deque(maxlen=gates.median)
        self._candidates: list[float] = []

    def judge(self, metres: float) -> FilteredDistance:
        """Judge the next value; NaN and infinity are out of range."""
        gates = self._gates
        if not gates.nearest <= metres <= gates.farthest:
            return FilteredDistance(None, "range")
        value = self._clamped(metres)
        if self._jumps(value) and not self._confirmed(value):
            return FilteredDistance(None, "jump")
        self._candidates.clear()
        self._accepted.append(value)
        ordered = sorted(self._accepted)
        return FilteredDistance(ordered[(len(ordered) - 1) // 2])

    def _clamped(self, metres: float) -> float:
        gates = self._gates
        if gates.floor is not None:
            metres = max(metres, gates.floor)
        if gates.ceiling is not None:
            metres = min(metres, gates.ceiling)
        return metres

    def _jumps(self, value: float) -> bool:
        return bool(
            self._gates.jump
            and self._accepted
            and abs(value - self._accepted[-1]) > self._gates.jump
        )

    def _confirmed(self, value: float) -> bool:
        """Whether enough values in a row say that something really moved that far.

        Then the old values are forgotten, so that the median follows at once.
        """
        if self._candidates and abs(value - self._candidates[-1]) > self._gates.jump:
            self._candidates.clear()
        self._candidates.append(value)
        if len(self._candidates) < self._gates.confirm:
            return False
        self._accepted.clear()
        self._accepted.extend(self._candidates[:-1])
        return True
