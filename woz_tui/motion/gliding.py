"""Values that may be changed at any moment, again and again, without a jump."""

from __future__ import annotations

import math


class Gliding:
    """Follows its goal as a critically damped spring does: gently off, gently there, not beyond.

    A goal that keeps moving (a knob being turned) is followed on the way; a change is done by 95 %
    after `4.75 / rate` seconds. The result hardly depends on how time is cut into steps.
    """

    __slots__ = ("_pace", "_rate", "value")

    def __init__(self, value: float, rate: float) -> None:
        self.value = value
        self._pace = 0.0
        self._rate = rate

    def step(self, goal: float, dt: float) -> float:
        """The value, `dt` seconds later."""
        if goal == self.value and self._pace == 0.0:
            return goal
        beside = self.value - goal
        turn = (self._pace + self._rate * beside) * dt
        fade = math.exp(-self._rate * dt)
        self._pace = (self._pace - self._rate * turn) * fade
        left = (beside + turn) * fade
        if abs(left) < 1e-6 and abs(self._pace) < 1e-6:
            left, self._pace = 0.0, 0.0
        self.value = goal + left
        return self.value
