"""What sensors are called where several drivers have one of the same name."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from woz_tui.experiment.shape import DriverSpec


def published_names(specs: Sequence[DriverSpec]) -> dict[str, dict[str, str]]:
    """For each driver, its sensors' own names and the names under which they are published.

    A name that only one driver has stays as it is. A shared one gets the robot's name in front
    (`left.distance`), or the driver's where one robot has two of them (`front.distance`).
    """
    owners = Counter(sensor for spec in specs for sensor in set(spec.sensors))
    in_robot = Counter((_robot(spec), sensor) for spec in specs for sensor in set(spec.sensors))
    return {
        spec.name: {
            sensor: _name(spec, sensor, owners[sensor], in_robot[_robot(spec), sensor])
            for sensor in spec.sensors
        }
        for spec in specs
    }


def _robot(spec: DriverSpec) -> str:
    """The robot of a driver called `left.head`; with one robot drivers have simple names."""
    robot, dot, _ = spec.name.partition(".")
    return robot if dot else ""


def _name(spec: DriverSpec, sensor: str, everywhere: int, in_robot: int) -> str:
    if everywhere == 1:
        return sensor
    if in_robot == 1 and _robot(spec):
        return f"{_robot(spec)}.{sensor}"
    return f"{spec.name}.{sensor}"
