"""What a robot file says about a robot behind rosbridge: what each verb sends, what is a sensor."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Annotated

from woz_drivers.lines.network_address import host_and_port, joined
from woz_drivers.programs.simulated_process import SIMULATED
from woz_drivers.ros.declarations import (
    NAME,
    DriveDeclaration,
    EndDeclaration,
    SensorDeclaration,
    StopDeclaration,
    VerbDeclaration,
)
from woz_drivers.ros.laser_scans import SCAN
from woz_drivers.ros.message_types import MessageTypes, plain
from woz_drivers.ros.templates import TemplateError, ValuePath, fill, placeholders
from woz_drivers.ros.verbs import BRIEF, COMMON, DERIVED, DRIVE, arguments_of
from woz_tui.drivers.contract import Argument, RejectedError
from woz_tui.drivers.fields import Doc, Range, Section
from woz_tui.drivers.robot_settings import problem_at
from woz_tui.protocol.messages import Json

#: Where rosbridge listens unless it is told otherwise.
PORT = 9090
_BY_INDEX = (
    "counts from where the scanner begins, which is behind the robot for most: say it by angle,"
    " min(ranges[-15deg:15deg]); `woz doctor` says where it sees what"
)
_EXAMPLES = f"write robot.local, 192.168.1.30:{PORT} or wss://robot.local/ros"


@dataclass(frozen=True, slots=True)
class RosSettings(Section):
    """A robot behind rosbridge."""

    address: Annotated[
        str, Doc("host, host:port, ws:// or wss:// address of rosbridge, or simulated")
    ] = SIMULATED
    ros: Annotated[int, Range(1, 2), Doc("the version of ROS on the robot")] = 2
    verbs: Annotated[dict[str, VerbDeclaration], Doc("what each verb sends")] = field(
        default_factory=dict
    )
    drive: Annotated[DriveDeclaration | None, Doc("the base, if it has one")] = None
    sensors: Annotated[dict[str, SensorDeclaration], Doc("readings by name")] = field(
        default_factory=dict
    )
    joints: Annotated[
        dict[str, tuple[float, float]], Doc("joints of `pose`: lowest and highest, degrees")
    ] = field(default_factory=dict)
    types: Annotated[
        dict[str, dict[str, str]], Doc("fields of types that are not standard, for woz check")
    ] = field(default_factory=dict)
    pace: Annotated[
        float, Range(0.01, 100), Doc("of the simulated robot only: how fast its time passes")
    ] = 1.0

    def known_types(self) -> MessageTypes:
        """The standard types and those of the file."""
        return MessageTypes(self.ros, self.types)

    def problems(self) -> list[tuple[str, str]]:
        """What does not fit together, by the setting's path."""
        found: list[tuple[str, str]] = []
        with problem_at("address", found):
            url(self.address)
        return [*found, *self.misfits(self.known_types())]

    def warnings(self) -> list[tuple[str, str]]:
        """Verbs that go on after a stop, and scans that are read where nobody knows."""
        lasting = [
            (f"verbs.{name}", "cannot be stopped: say how with `stop`")
            for name, verb in self.verbs.items()
            if verb.stop is None and not verb.action and name not in BRIEF and _lasts(verb)
        ]
        by_index = [
            (f"sensors.{name}.value", _BY_INDEX)
            for name, sensor in self.sensors.items()
            if plain(sensor.type_) == SCAN and _counts(sensor.value)
        ]
        return lasting + by_index

    # -- what a file says, compared with types -------------------------------------------------

    def misfits(self, types: MessageTypes) -> Iterator[tuple[str, str]]:
        """What is wrong with the verbs and sensors when these are the types."""
        for name, verb in self.verbs.items():
            yield from _verb_misfits(f"verbs.{name}", name, verb, types)
            if name == "pose" and not self.joints:
                yield f"verbs.{name}", "needs the joints with their ranges: `joints` beside `verbs`"
        for name, sensor in self.sensors.items():
            path = f"sensors.{name}"
            yield from _name_misfit(f"{path}.subscribe", sensor.subscribe)
            yield from _path_misfit(f"{path}.value", sensor.value, sensor.type_, types)
        for name, (low, high) in self.joints.items():
            if low >= high:
                yield f"joints.{name}", f"the lowest angle ({low:g}) comes first"
        if self.drive is not None:
            yield from _name_misfit("drive.topic", self.drive.topic)
            if self.drive.odometry:
                yield from _name_misfit("drive.odometry", self.drive.odometry)


def shown(address: str) -> str:
    """What a wizard reads for an address: without its query, which may have a password in it."""
    return "the simulated robot" if address == SIMULATED else address.partition("?")[0]


def url(address: str) -> str:
    """Where rosbridge listens, as ws:// or wss://; empty for the simulated robot. Raises
    `RejectedError` for what is no address.
    """
    if address == SIMULATED:
        return ""
    scheme, separator, rest = address.rpartition("://")
    if separator and scheme not in ("ws", "wss"):
        raise RejectedError(f"rosbridge is not reached by {scheme}", _EXAMPLES)
    place, slash, path = rest.partition("/")
    host, port = host_and_port(place, PORT, _EXAMPLES)
    return f"{scheme or 'ws'}://{joined(host, port)}{slash or '/'}{path}"


def _counts(value: str) -> bool:
    """Whether a value is one of some entries that are counted."""
    try:
        steps = ValuePath.parse(value).steps
    except TemplateError:
        return False
    return any(step["colon"] or step["at"] for step in steps)


def _lasts(verb: VerbDeclaration) -> bool:
    ends = verb.ends
    return bool(verb.service or ends.subscribe or ends.seconds > 0.5 or ends.per_character)


def _name_misfit(path: str, name: str) -> Iterator[tuple[str, str]]:
    if not re.fullmatch(NAME.regex, name):
        yield path, f"expected {NAME.meaning}, not {name!r}"


def _path_misfit(
    path: str, value: str, kind: str, types: MessageTypes
) -> Iterator[tuple[str, str]]:
    try:
        wrong = types.path_misfit(ValuePath.parse(value), kind)
    except TemplateError as error:
        wrong = str(error)
    if wrong:
        yield path, wrong


def _verb_misfits(
    path: str, name: str, verb: VerbDeclaration, types: MessageTypes
) -> Iterator[tuple[str, str]]:
    targets = [one for one in ("publish", "service", "action") if getattr(verb, one)]
    if len(targets) != 1:
        yield path, "needs one of publish, service and action"
        return
    yield from _name_misfit(f"{path}.{targets[0]}", verb.target)
    if name == DRIVE or name in DERIVED:
        yield (
            path,
            {
                DRIVE: "is declared beside `verbs`: drive: {topic: /cmd_vel}",
            }.get(name, f"comes with {DERIVED.get(name)!r}: remove it"),
        )
        return
    arguments = arguments_of(name, verb)
    for unknown in {*verb.values, *(verb.arguments if name in COMMON else ())} - {*arguments}:
        there = ", ".join(arguments) or "none"
        yield path, f"{name} has no argument {unknown!r}; it has {there}"
    try:
        found = [*placeholders(verb.message)]
    except TemplateError as error:
        yield f"{path}.message", str(error)
        return
    for place, argument, _ in found:
        if argument not in arguments:
            there = ", ".join(f"{{{one}}}" for one in arguments) or "none"
            text = f"{name} has no argument {argument!r}; there is {there}"
            yield f"{path}.message.{place}", text
            return
    seen: set[str] = set()
    for sample in samples(verb, arguments):
        try:
            filled = fill(verb.message, sample)
        except TemplateError as error:
            yield f"{path}.message", str(error)
            return
        for place, wrong in types.misfits(filled, verb.part):
            if place not in seen:
                seen.add(place)
                yield f"{path}.message.{place}" if place else f"{path}.message", wrong
    yield from _end_misfits(f"{path}.ends", verb.ends, types)
    if verb.stop is not None:
        yield from _stop_misfits(f"{path}.stop", verb.stop, types)


def samples(verb: VerbDeclaration, arguments: Mapping[str, Argument]) -> Iterator[dict[str, Json]]:
    """Values that the arguments may have: one of each kind, and every word of `values`."""
    kinds: dict[str, Json] = {
        **{"text": "text", "file": "file", "choice": "word", "number": 0.5, "seconds": 0.5},
        **{"whole": 1, "flag": True, "joints": {"joint": 1.0}},
    }
    first: dict[str, Json] = {
        name: "#ff8000" if name == "color" else kinds[argument.kind]
        for name, argument in arguments.items()
    }
    for name, words in verb.values.items():
        first[name] = next(iter(words.values()), None)
    yield first
    for name, words in verb.values.items():
        for value in words.values():
            yield {**first, name: value}


def _end_misfits(path: str, ends: EndDeclaration, types: MessageTypes) -> Iterator[tuple[str, str]]:
    if not ends.subscribe:
        return
    yield from _name_misfit(f"{path}.subscribe", ends.subscribe)
    yield from _path_misfit(f"{path}.value", ends.value, ends.type_, types)


def _stop_misfits(
    path: str, stop: StopDeclaration, types: MessageTypes
) -> Iterator[tuple[str, str]]:
    if bool(stop.publish) == bool(stop.service):
        yield path, "needs one of publish and service"
        return
    try:
        fill(stop.message, {})
    except TemplateError as error:
        yield f"{path}.message", f"a stop has no arguments: {error}"
        return
    part = stop.type_ + ("_Request" if stop.service else "")
    for place, wrong in types.misfits(stop.message, part):
        yield f"{path}.message.{place}" if place else f"{path}.message", wrong
