"""How a value gets from one place to the next: shares of the way over shares of the time."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

# -- gliding --------------------------------------------------------------------------------------
# Values that may be changed at any moment, again and again, without a jump.


class GlidingValue:
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


# -- paths ----------------------------------------------------------------------------------------
# Values that go from place to place, each time from rest to rest.

#: Places (seconds or beats, rising) and the values there.
TimedValues = tuple[tuple[float, float], ...]


def along(path: TimedValues, place: float) -> float:
    """The value at `place`, by minimum jerk; outside the path that of its nearer end."""
    before_place, before = path[0]
    for after_place, after in path:
        if place < after_place:
            if before_place == after_place:
                return after
            share = (place - before_place) / (after_place - before_place)
            return before + (after - before) * ease("minimum-jerk", share)
        before_place, before = after_place, after
    return before


# --------------------------------------------------------------------------------------------------

Easing = Callable[[float], float]


def linear(share: float) -> float:
    """At one speed; starts and stops with a jerk."""
    return share


def smooth(share: float) -> float:
    """From rest to rest (cubic); at its fastest 1.5 times the mean speed."""
    return share * share * (3 - 2 * share)


def minimum_jerk(share: float) -> float:
    """As people move an arm (Flash and Hogan 1985): speed and acceleration are zero at both ends,
    at its fastest 1.875 times the mean speed.
    """
    return share * share * share * (10 - share * (15 - 6 * share))


def hold(share: float) -> float:
    """Stays, and jumps at the end; the speed limits make the fastest possible move of it."""
    return 1.0 if share >= 1.0 else 0.0


#: Every easing by its name in files.
EASINGS: Mapping[str, Easing] = {
    "linear": linear,
    "smooth": smooth,
    "minimum-jerk": minimum_jerk,
    "hold": hold,
}

#: Those of gaze and pose, and the highest speed of each as a multiple of the mean speed.
PEAK_SPEEDS: Mapping[str, float] = {"linear": 1.0, "smooth": 1.5, "minimum-jerk": 1.875}


def ease(name: str, share: float) -> float:
    """The share of the way after `share` of the time, both 0..1; shares outside are clamped."""
    return EASINGS[name](min(1.0, max(0.0, share)))


def swell(place: float, length: float, ramp: float) -> float:
    """0 at both ends of `length`, 1 between, rising and falling smoothly within `ramp`.

    Multiplied with it, any swing begins and ends at zero with zero speed.
    """
    return smooth(min(1.0, max(0.0, min(place, length - place) / ramp)))


def low_pass(value: float, goal: float, time_constant: float, dt: float) -> float:
    """`value` after it followed `goal` for `dt` seconds as a first-order filter does.

    The result does not depend on how `dt` is cut into steps; without a time constant it is there.
    """
    if time_constant <= 0.0:
        return goal
    return goal + (value - goal) * math.exp(-dt / time_constant)
