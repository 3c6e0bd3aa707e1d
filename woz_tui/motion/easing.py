"""How a value gets from one place to the next: shares of the way over shares of the time."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

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


#: Every easing by its name in files; the first three are those of gaze and pose.
EASINGS: Mapping[str, Easing] = {
    "linear": linear,
    "smooth": smooth,
    "minimum-jerk": minimum_jerk,
    "hold": hold,
}

#: Those of gaze and pose, each with its highest speed as a multiple of the mean speed.
EASE: Mapping[str, tuple[Easing, float]] = {
    "linear": (linear, 1.0),
    "smooth": (smooth, 1.5),
    "minimum-jerk": (minimum_jerk, 1.875),
}


def ease(name: str, share: float) -> float:
    """The share of the way after `share` of the time, both 0..1; shares outside are clamped."""
    return EASINGS[name](min(1.0, max(0.0, share)))


def swell(place: float, length: float, ramp: float) -> float:
    """0 at both ends of `length`, 1 between, rising and falling smoothly within `ramp`.

    Multiplied with it, any swing begins and ends at zero with zero speed.
    """
    return smooth(min(1.0, max(0.0, min(place, length - place) / ramp)))


def followed(value: float, goal: float, time_constant: float, dt: float) -> float:
    """`value` after it followed `goal` for `dt` seconds as a first-order filter does.

    The result does not depend on how `dt` is cut into steps; without a time constant it is there.
    """
    if time_constant <= 0.0:
        return goal
    return goal + (value - goal) * math.exp(-dt / time_constant)
