"""Directions of what a laser scanner measures, as seen from the robot."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

SCAN = "sensor_msgs/LaserScan"
#: Fields of a scan without which nobody knows where an entry of it looks.
ANGLES = ("angle_min", "angle_increment")
#: Fields that are distances, of a scan and of a `sensor_msgs/Range`.
DISTANCES = ("ranges", "range")
#: Directions in words, each a quarter, and the degrees in the middle of it.
QUARTERS: Mapping[str, float] = {"front": 0.0, "left": 90.0, "behind": 180.0, "right": -90.0}
#: Angles of a message are 32-bit floats: so many degrees are none.
_ROUNDING = 0.01


def directions(scan: Mapping[str, Any], count: int, mounted: float) -> list[float] | None:
    """Degrees at which so many entries of a scan look, to the robot's left from its front.

    `mounted`: where the scanner's own zero points. None: the scan does not say it.
    """
    first, step = (scan.get(name) for name in ANGLES)
    if not isinstance(first, int | float) or not isinstance(step, int | float) or step == 0:
        return None
    return [turned(math.degrees(first + at * step) + mounted) for at in range(count)]


def turned(degrees: float) -> float:
    """The same direction as an angle of -180 to 180 degrees."""
    return (degrees + 180.0) % 360.0 - 180.0


def lies_within(first: float, last: float) -> Callable[[float], bool]:
    """Whether a direction lies between two, counted to the left from the first to the last."""
    width = min(last - first, 360.0) if last >= first else (last - first) % 360.0

    def contains(direction: float) -> bool:
        return (direction - first + _ROUNDING) % 360.0 <= width + 2 * _ROUNDING

    return contains


def toward(degrees: float, there: Sequence[float], step: float) -> int | None:
    """Which of these directions is this one; None if the scanner does not look there."""
    at = min(range(len(there)), key=lambda one: abs(turned(there[one] - degrees)), default=None)
    near = at is not None and abs(turned(there[at] - degrees)) <= abs(step) / 2 + _ROUNDING
    return at if near else None


def is_echo(item: Any, message: Mapping[str, Any]) -> bool:
    """Whether a distance is a measurement: a scan, or a `sensor_msgs/Range`, says itself between
    what it measures.
    """
    if isinstance(item, bool) or not isinstance(item, int | float) or not math.isfinite(item):
        return False
    low = message.get("range_min", message.get("min_range"))
    high = message.get("range_max", message.get("max_range"))
    return (not isinstance(low, int | float) or item >= low) and (
        not isinstance(high, int | float) or item <= high
    )


def nearest_of_quarters(scan: Mapping[str, Any], mounted: float) -> dict[str, str] | None:
    """In each direction the nearest that is seen there, in words; None if this is no scan."""
    ranges = scan.get("ranges")
    if not isinstance(ranges, list):
        return None
    there = directions(scan, len(ranges), mounted)
    if not there:
        return None
    said = {}
    for name, middle in QUARTERS.items():
        contains = lies_within(middle - 45.0, middle + 45.0)
        looks = [(ranges[at], way) for at, way in enumerate(there) if contains(way)]
        echoes = [(metres, way) for metres, way in looks if is_echo(metres, scan)]
        if echoes:
            metres, way = min(echoes)
            said[name] = f"{metres:.2f} m at {way:.0f} deg"
        else:
            said[name] = "nothing" if looks else "not looked at"
    return said
