"""Units of the sensors that drivers have in common; drivers/README.md has their meanings."""

from __future__ import annotations

#: By name, or by the beginning of a name that ends with a dot.
_UNITS = {
    "distance": "m",
    "direction": "deg",
    "joint.": "deg",
    "setpoint.": "deg",
    "tick": "ms",
}


def sensor_unit(sensor: str) -> str:
    """The unit of a driver's sensor by its own name; empty: it has none, or nobody knows."""
    first, dot, _ = sensor.partition(".")
    return _UNITS.get(sensor, _UNITS.get(first + dot, ""))
