"""What the simulated robot must offer so that a robot file finds everything that it names."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from woz_drivers.ros.message_types import PRIMITIVES, MessageTypes, plain
from woz_drivers.ros.settings import RosSettings, samples
from woz_drivers.ros.templates import fill
from woz_drivers.ros.verbs import arguments_of


def options(settings: RosSettings) -> tuple[str, ...]:
    """Options of `python -m robot_simulators.rosbridge`."""
    common = ("--ros", str(settings.ros), "--pace", f"{settings.pace:g}")
    if not (settings.verbs or settings.sensors or settings.drive):
        return common  # then it has its own
    return (*common, "--interface", json.dumps(_interface(settings)))


def _interface(settings: RosSettings) -> dict[str, Any]:
    types = settings.known_types()
    topics: dict[str, str] = {}
    services: dict[str, str] = {}
    actions: dict[str, str] = {}
    speech = []
    for name, verb in settings.verbs.items():
        if types.fields(verb.part) is None:
            message = fill(verb.message, next(samples(verb, arguments_of(name, verb))))
            types.learn(verb.part, dict(_guessed(message, verb.part, types)))
        kinds = topics if verb.publish else services if verb.service else actions
        kinds[verb.target] = verb.type_
        if verb.stop is not None:
            (services if verb.stop.service else topics)[verb.stop.service or verb.stop.publish] = (
                verb.stop.type_
            )
        ends = verb.ends
        if ends.subscribe:
            topics[ends.subscribe] = ends.type_
            voice = {"topic": verb.target, "says": ends.subscribe, "field": ends.value}
            speech.append({**voice, "begun": ends.begun, "ended": ends.ended})
    drive = settings.drive
    odometry = drive.odometry if drive is not None else ""
    if drive is not None:
        topics[drive.topic] = drive.type_
    if odometry:
        topics[odometry] = "nav_msgs/Odometry"
    sensors = {
        name: {
            "topic": sensor.subscribe,
            "type": plain(sensor.type_),
            "joints": [*settings.joints],
            "mounted": sensor.mounted,
        }
        for name, sensor in settings.sensors.items()
        if sensor.subscribe != odometry
    }
    named = {*topics.values(), *(verb.part for verb in settings.verbs.values())}
    named |= {f"{kind}_Response" for kind in services.values()}
    named |= {f"{kind}_Request" for kind in services.values()}
    named |= {f"{kind}_Result" for kind in actions.values()}
    named |= {sensor.type_ for sensor in settings.sensors.values()}
    return {
        "types": {name: types.fields(name) for name in _closure(named, types)},
        "topics": topics,
        "services": services,
        "actions": actions,
        "drive": drive.topic if drive is not None else "",
        "odometry": odometry,
        "sensors": sensors,
        "speech": speech,
    }


def _closure(names: set[str], types: MessageTypes) -> set[str]:
    """These types that are known, and all within them."""
    found: set[str] = set()
    left = [plain(name) for name in names]
    while left:
        name = left.pop()
        fields = types.fields(name)
        if name in found or fields is None:
            continue
        found.add(name)
        left += [kind.partition("[")[0] for kind in fields.values()]
    return found - PRIMITIVES


def _guessed(message: Any, name: str, types: MessageTypes) -> Iterator[tuple[str, str]]:
    """Fields of a type that nobody gives, by what is sent."""
    for field, value in message.items() if isinstance(message, dict) else ():
        many = isinstance(value, list)
        one = value[0] if many and value else "" if many else value
        if isinstance(one, dict):
            kind = f"{name}_{field}"
            types.learn(kind, dict(_guessed(one, kind, types)))
        else:
            kind = {bool: "bool", int: "int64", float: "float64"}.get(type(one), "string")
        yield field, kind + ("[]" if many else "")
