"""How a value gets from one key frame to the next: shares of the way over shares of the time."""

from __future__ import annotations

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


def ease(name: str, share: float) -> float:
    """The share of the way after `share` of the time, both 0..1; shares outside are clamped."""
    return EASINGS[name](min(1.0, max(0.0, share)))


def swell(place: float, length: float, ramp: float) -> float:
    """0 at both ends of `length`, 1 between, rising and falling smoothly within `ramp`.

    Multiplied with it, any swing begins and ends at zero with zero speed.
    """
    return smooth(min(1.0, max(0.0, min(place, length - place) / ramp)))
