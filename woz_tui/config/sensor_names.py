"""What sensors are called where several drivers have one of the same name; which stand first."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence

from woz_tui.config.experiment import DriverSpec
from woz_tui.config.problems import did_you_mean, quoted
from woz_tui.config.yaml_cursor import Cursor, texts_of
from woz_tui.protocol.sentence import Sentence

#: What may be named among the sensors though it is none: the model, and all joints.
ENGAGEMENT, POSE = "engagement", "pose"


def published_names(specs: Sequence[DriverSpec]) -> dict[str, dict[str, str]]:
    """For each driver, its sensors' own names and the names under which they are published.

    A name that only one driver has stays as it is. A shared one gets the robot's name in front
    (`left.distance`), or the driver's where one robot has two of them (`front.distance`).
    """
    owners = Counter(sensor for spec in specs for sensor in set(spec.offer.sensors))
    in_robot = Counter(
        (_robot(spec), sensor) for spec in specs for sensor in set(spec.offer.sensors)
    )
    return {
        spec.name: {
            sensor: _published_name(spec, sensor, owners[sensor], in_robot[_robot(spec), sensor])
            for sensor in spec.offer.sensors
        }
        for spec in specs
    }


def _robot(spec: DriverSpec) -> str:
    """The robot of a driver called `left.head`; with one robot drivers have simple names."""
    robot, dot, _ = spec.name.partition(".")
    return robot if dot else ""


def _published_name(spec: DriverSpec, sensor: str, everywhere: int, in_robot: int) -> str:
    if everywhere == 1:
        return sensor
    if in_robot == 1 and _robot(spec):
        return f"{_robot(spec)}.{sensor}"
    return f"{spec.name}.{sensor}"


def check_shown(cursor: Cursor | None, published: Collection[str] | None, has_model: bool) -> None:
    """Check the section `sensors`: what stands first among the meters.

    `published`: names of all sensors; None where a driver is missing. What none of them is near to
    may be something that only the running robot knows.
    """
    known = {ENGAGEMENT, POSE}
    for name in published or ():
        known |= {name, name.rpartition(".")[2], name.rpartition(".")[0]} - {""}
    for entry, name in texts_of(cursor):
        near = entry.report.nearest(name, known)
        if name == ENGAGEMENT and not has_model:
            entry.warning(
                Sentence(
                    "check.nothing_shows_it", "nothing shows it: the file has no section engagement"
                )
            )
        elif name in known or published is None:
            continue
        elif near is not None:
            entry.error(
                Sentence(
                    "check.no_sensor",
                    "there is no sensor {name}{near}",
                    name=quoted(name),
                    near=did_you_mean(near),
                )
            )
        else:
            entry.warning(
                Sentence(
                    "check.sensor_not_named",
                    "no driver names a sensor {name}; it is shown if the running robot"
                    " gives it (`woz check --all` lists them)",
                    name=quoted(name),
                )
            )
