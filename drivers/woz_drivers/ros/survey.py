"""What a robot offers by its own word, compared with what the robot file says of it.

ROS 2's `/rosapi/message_details` is not asked: on the distributions since Jazzy rosapi itself ends
over that question, because it does not know a field that Python adds to every message. Definitions
come from `/rosapi/topics_and_raw_types`, which has them for all topics that are in use.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from woz_drivers.ros.message_types import MessageTypes, parse_definitions, plain
from woz_drivers.ros.rosbridge import Rosbridge, ServiceFailedError
from woz_drivers.ros.settings import RosSettings
from woz_tui.drivers.contract import Finding

#: Texts of all types of a large robot take their time.
_TEXTS_S = 15.0
_ROSAPI = "start rosapi beside rosbridge: the launch file of rosbridge_server does it"


@dataclass(slots=True)
class Survey:
    """Topics, services and actions with their types, and what does not fit the file.

    Attributes:
        ros: The version, 0 if nobody said it.
        wrong: Findings by the verb, or sensor, that they are about; empty: about the robot.
    """

    types: MessageTypes
    ros: int = 0
    topics: dict[str, str] = field(default_factory=dict)
    services: dict[str, str] = field(default_factory=dict)
    actions: dict[str, str] = field(default_factory=dict)
    wrong: list[tuple[str, Finding]] = field(default_factory=list)

    @property
    def broken(self) -> dict[str, Finding]:
        """Errors by verb."""
        return {name: finding for name, finding in self.wrong if finding.level == "error" and name}


async def survey(robot: Rosbridge, settings: RosSettings, *, all_services: bool = False) -> Survey:
    """Ask the robot about everything that the file names. Raises `DeviceLostError`.

    `all_services`: also the types of services that the file does not name.
    """
    found = Survey(settings.known_types())
    try:
        await _ask(robot, settings, found, all_services)
    except ServiceFailedError as error:
        text = f"nothing can be compared with the robot: {error.what}"
        found.wrong.append(("", Finding("warning", "rosapi", text, _ROSAPI)))
        return found
    found.wrong += _compared(settings, found)
    return found


async def _ask(robot: Rosbridge, settings: RosSettings, found: Survey, all_services: bool) -> None:
    raw = await robot.call("/rosapi/topics_and_raw_types", {}, _TEXTS_S)
    names, kinds, texts = (_texts(raw, key) for key in ("topics", "types", "typedefs_full_text"))
    found.topics = dict(zip(names, kinds, strict=False))
    for kind, text in zip(kinds, texts, strict=False):
        # A definition that could not be had begins with a comment that says so.
        if text and not text.startswith("# failed"):
            for name, fields in parse_definitions(kind, text).items():
                found.types.learn(name, fields)
    try:
        version = await robot.call("/rosapi/get_ros_version", {})
        found.ros = int(version["version"])
    except (ServiceFailedError, KeyError, TypeError, ValueError):
        found.ros = 1  # that of ROS 1 does not know the question
    services = _texts(await robot.call("/rosapi/services", {}), "services")
    named = {verb.service for verb in settings.verbs.values()}
    named |= {verb.stop.service for verb in settings.verbs.values() if verb.stop is not None}
    for service in services:
        found.services[service] = ""
        if service in named or (all_services and not _is_plumbing(service)):
            answer = await robot.call("/rosapi/service_type", {"service": service})
            found.services[service] = str(answer.get("type", "")) if answer else ""
    servers = await robot.call("/rosapi/action_servers", {})
    for action in _texts(servers, "action_servers"):
        goal = found.topics.get(f"{action}/goal", "")
        found.actions[action] = goal.removesuffix("ActionGoal")
    if found.ros == 1:
        await _learn_of_ros_1(robot, settings, found)


async def _learn_of_ros_1(robot: Rosbridge, settings: RosSettings, found: Survey) -> None:
    """Types of messages and services that no topic has at the moment."""
    for verb in settings.verbs.values():
        question = "service_request_details" if verb.service else "message_details"
        kind = verb.type_.removesuffix("Action") + "Goal" if verb.action else verb.type_
        try:
            answer = await robot.call(f"/rosapi/{question}", {"type": plain(kind)})
        except ServiceFailedError:
            continue
        for at, typedef in enumerate(answer.get("typedefs") or () if answer else ()):
            name, fields = _typedef(typedef)
            found.types.learn(verb.part if at == 0 else name, fields)


def _typedef(typedef: Mapping[str, Any]) -> tuple[str, dict[str, str]]:
    fields = {}
    for name, kind, length in zip(
        typedef["fieldnames"], typedef["fieldtypes"], typedef["fieldarraylen"], strict=True
    ):
        fields[name] = plain(kind) + ("" if length < 0 else f"[{length or ''}]")
    return plain(typedef["type"]), fields


def _texts(answer: Any, key: str) -> list[str]:
    found = answer.get(key) if isinstance(answer, dict) else None
    return [one for one in found if isinstance(one, str)] if isinstance(found, list) else []


def _is_plumbing(service: str) -> bool:
    """Services that every node of ROS has."""
    last = service.rpartition("/")[2]
    return (
        service.startswith("/rosapi/")
        or "parameter" in last
        or last in ("get_loggers", "set_logger_level", "get_type_description")
        or "/_action/" in service
    )


# -- comparing -------------------------------------------------------------------------------------


def _compared(settings: RosSettings, found: Survey) -> Iterator[tuple[str, Finding]]:
    if found.ros and found.ros != settings.ros:
        text = f"this is ROS {found.ros}, and the file says ros: {settings.ros}"
        yield "", Finding("error", "ros", text, f"write ros: {found.ros}")
    for path, wrong in settings.misfits(found.types):
        name = path.split(".")[1] if path.startswith("verbs.") else ""
        remedy = "correct the robot file"
        yield name, Finding("error", path, f"does not fit the robot's type: {wrong}", remedy)
    for name, verb in settings.verbs.items():
        path = f"verbs.{name}"
        if verb.publish:
            yield from _topic(name, f"{path}.publish", verb.publish, verb.type_, found)
        elif verb.service:
            yield from _service(name, f"{path}.service", verb.service, verb.type_, found)
        else:
            yield from _action(name, f"{path}.action", verb.action, found)
        if verb.ends.subscribe:
            place = f"{path}.ends.subscribe"
            yield from _topic(name, place, verb.ends.subscribe, verb.ends.type_, found)
        if verb.stop is not None and verb.stop.publish:
            place = f"{path}.stop.publish"
            yield from _topic(name, place, verb.stop.publish, verb.stop.type_, found)
        elif verb.stop is not None:
            place = f"{path}.stop.service"
            yield from _service(name, place, verb.stop.service, verb.stop.type_, found)
    for name, sensor in settings.sensors.items():
        place = f"sensors.{name}.subscribe"
        yield from _topic("", place, sensor.subscribe, sensor.type_, found)
    if settings.drive is not None:
        drive = settings.drive
        yield from _topic("drive", "drive.topic", drive.topic, drive.type_, found)
        if drive.odometry:
            place = "drive.odometry"
            yield from _topic("", place, drive.odometry, "nav_msgs/Odometry", found)


def _topic(
    name: str, path: str, topic: str, kind: str, found: Survey
) -> Iterator[tuple[str, Finding]]:
    there = found.topics.get(_absolute(topic))
    if not there:
        yield (
            name,
            Finding("warning", path, f"the robot has no topic {topic}", _near(topic, found.topics)),
        )
    elif plain(there) != plain(kind):
        text = f"{topic} is {plain(there)} on the robot, not {plain(kind)}"
        yield name, Finding("error", path, text, f"write type: {plain(there)}")


def _service(
    name: str, path: str, service: str, kind: str, found: Survey
) -> Iterator[tuple[str, Finding]]:
    there = found.services.get(_absolute(service))
    if there is None:
        yield (
            name,
            Finding(
                "warning",
                path,
                f"the robot has no service {service}",
                _near(service, found.services),
            ),
        )
    elif there and plain(there) != plain(kind):
        text = f"{service} is {plain(there)} on the robot, not {plain(kind)}"
        yield name, Finding("error", path, text, f"write type: {plain(there)}")


def _action(name: str, path: str, action: str, found: Survey) -> Iterator[tuple[str, Finding]]:
    if _absolute(action) not in found.actions:
        yield (
            name,
            Finding(
                "warning", path, f"the robot has no action {action}", _near(action, found.actions)
            ),
        )


def _absolute(name: str) -> str:
    return name if name.startswith("/") else f"/{name}"


def _near(name: str, there: Mapping[str, str]) -> str:
    word = name.rpartition("/")[2]
    near = [one for one in there if word in one][:3]
    return f"is it {' or '.join(near)}?" if near else "start its node, or correct the name"
