"""What `woz doctor` finds out about a robot behind rosbridge, and a draft of its robot file."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from woz_drivers.lines.answer_times import line_finding
from woz_drivers.programs.simulated_process import SIMULATED
from woz_drivers.ros import simulated_interface
from woz_drivers.ros.declarations import TWIST, TWIST_STAMPED
from woz_drivers.ros.laser_scans import SCAN, nearest_of_quarters
from woz_drivers.ros.message_types import MessageTypes, plain
from woz_drivers.ros.rosbridge import Rosbridge
from woz_drivers.ros.settings import RosSettings, shown
from woz_drivers.ros.survey import Survey, survey
from woz_drivers.ros.templates import ValuePath
from woz_tui.drivers.contract import DeviceLostError, DriverError, Finding, Health, Probe
from woz_tui.system.clock import Clock, RealClock

#: The robot must be found within so many seconds, looked at within so many more.
_FOUND_WITHIN_S, _SURVEY_S = 5.0, 8.0
_QUESTIONS = 10
#: A scanner turns five times a second or faster; so long its scan is waited for, in seconds.
_SCANNED_WITHIN_S = 2.0
#: So many names are listed on a line.
_LISTED = 12
_STAND_IN_FRONT = (
    "stand in front of the robot: if you are seen at -90 deg, its `mounted` is to be 90 more"
)
_TUNNEL = (
    "let it listen on 127.0.0.1 (address:=127.0.0.1) and come by ssh -L 9090:127.0.0.1:9090"
    " robot, or put it behind a proxy with wss and a password"
)


@dataclass
class _DoctorContext:
    """What a connection needs of a session: it keeps how the robot is."""

    folder: Path
    clock: Clock = field(default_factory=RealClock)
    health_told: asyncio.Queue[tuple[Health, str, str]] = field(default_factory=asyncio.Queue)

    def health(self, health: Health, detail: str = "", remedy: str = "") -> None:
        self.health_told.put_nowait((health, detail, remedy))

    def notice(self, *_: object, **__: object) -> None:
        """Nobody reads it."""


async def examine(probe: Probe) -> list[Finding]:
    """Compare the file with the robot. Never raises."""
    settings: RosSettings = probe.settings
    try:
        async with asyncio.timeout(_FOUND_WITHIN_S + _SURVEY_S):
            return await _examined(probe.name, settings, probe.folder)
    except DriverError as error:
        return [Finding("error", probe.name, error.what, error.remedy)]
    except TimeoutError:
        text = f"{shown(settings.address)} answers too slowly to be examined"
        return [Finding("error", probe.name, text, "look at the network and at rosbridge's log")]


async def _examined(name: str, settings: RosSettings, folder: Path) -> list[Finding]:
    scans: dict[str, Mapping[str, Any]] = {}
    line, found = await _visit(settings, folder, scans)
    findings = [line, *_protected(settings)]
    if found.ros:
        level = "ok" if found.ros == settings.ros else "info"
        findings.append(Finding(level, name, f"runs ROS {found.ros}"))
    findings += [finding for _, finding in found.wrong]
    if not found.wrong:
        findings.append(Finding("ok", name, "all that the file names is there, types fit"))
    findings += _seen(settings, scans)
    findings += _unchecked(settings, found)
    findings += _listed(found)
    if settings.address != SIMULATED:
        text = "can be drafted as a robot file"
        command = f"python -m woz_drivers.ros {shown(settings.address)} > robot.yaml"
        findings.append(Finding("info", name, text, command))
    return findings


async def _visit(
    settings: RosSettings, folder: Path, scans: dict[str, Mapping[str, Any]]
) -> tuple[Finding, Survey]:
    """Connect, look at everything, leave. `scans` gets, by topic, one of each that the file reads.
    Raises `DriverError`.
    """
    context = _DoctorContext(folder)

    async def ready() -> str:
        return "found"

    robot = Rosbridge(
        settings,
        context,  # type: ignore[arg-type]  # a connection tells no more than this
        simulated_interface.options(settings),
        get_ready=ready,
        on_lost=lambda _: None,
    )
    awaited = {
        sensor.subscribe for sensor in settings.sensors.values() if plain(sensor.type_) == SCAN
    }
    all_came = asyncio.Event()

    def keep(topic: str, scan: Mapping[str, Any]) -> None:
        scans[topic] = scan
        if awaited <= {*scans}:
            all_came.set()

    for topic in awaited:
        robot.subscribe(topic, SCAN, partial(keep, topic))
    robot.start()
    try:
        await _until_found(context)
        line = await line_finding(robot.shown, robot.wait_until_processed, _QUESTIONS)
        found = await survey(robot, settings, all_services=True)
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(_SCANNED_WITHIN_S if awaited else 0.0):
                await all_came.wait()
        return line, found
    finally:
        await robot.close()


async def _until_found(context: _DoctorContext) -> None:
    try:
        async with asyncio.timeout(_FOUND_WITHIN_S):
            while True:
                health, detail, remedy = await context.health_told.get()
                if health is Health.CONNECTED:
                    return
                if health is not Health.CONNECTING:
                    raise DeviceLostError(detail, remedy)
    except TimeoutError:
        raise DeviceLostError("the robot does not answer", "is rosbridge running?") from None


def _protected(settings: RosSettings) -> Iterator[Finding]:
    """Whoever reaches the server may drive the robot."""
    host = settings.address.partition("://")[2] or settings.address
    if settings.address.startswith("wss://") or settings.address == SIMULATED:
        return
    if host.startswith(("127.", "localhost", "[::1]")):
        return
    text = "asks for no password: whoever reaches it can drive the robot"
    yield Finding("warning", shown(settings.address), text, _TUNNEL)


def _seen(settings: RosSettings, scans: Mapping[str, Mapping[str, Any]]) -> Iterator[Finding]:
    """Where each scanner sees what: whoever stands in front of the robot sees whether it is so."""
    for name, sensor in settings.sensors.items():
        if plain(sensor.type_) != SCAN:
            continue
        subject = f"sensors.{name}"
        scan = scans.get(sensor.subscribe)
        nearest = None if scan is None else nearest_of_quarters(scan, sensor.mounted)
        if scan is None or nearest is None:
            silent = "is silent" if scan is None else "does not say at which angles it measures"
            yield Finding("warning", subject, f"{sensor.subscribe} {silent}", "start its node")
            continue
        said = ", ".join(f"{where} {what}" for where, what in nearest.items())
        yield Finding("info", subject, f"sees {said}", _STAND_IN_FRONT)
        path = ValuePath.parse(sensor.value, sensor.mounted)
        value, where = path.of(scan), ""
        if [step["name"] for step in path.steps] == ["ranges"]:
            looked = path.directions_of(scan)
            if not looked:
                what = f"{sensor.value}: {sensor.subscribe} does not look there"
                yield Finding("error", subject, what, "choose other angles, or correct `mounted`")
                continue
            if not path.steps[0]["from"]:
                where = f" looks at {looked[0]:.0f} to {looked[-1]:.0f} deg, and"
        number = isinstance(value, int | float)
        reads = "nothing" if value is None else f"{value:g}" if number else str(value)
        yield Finding("ok", subject, f"{sensor.value}{where} reads {reads}")


def _unchecked(settings: RosSettings, found: Survey) -> Iterator[Finding]:
    kinds = {verb.part for verb in settings.verbs.values() if found.types.fields(verb.part) is None}
    if kinds:
        text = f"not compared, since the robot does not tell their fields: {_some(sorted(kinds))}"
        yield Finding("info", "types", text, "write their fields under `types`, to be sure")


def _listed(found: Survey) -> Iterator[Finding]:
    for what, there in (
        ("topics", found.topics),
        ("services", {name: kind for name, kind in found.services.items() if kind}),
        ("actions", found.actions),
    ):
        if there:
            names = [f"{name} ({plain(kind)})" if kind else name for name, kind in there.items()]
            yield Finding("info", what, _some(sorted(names)))


def _some(names: list[str]) -> str:
    more = f" and {len(names) - _LISTED} more" if len(names) > _LISTED else ""
    return ", ".join(names[:_LISTED]) + more


# -- a draft ---------------------------------------------------------------------------------------


async def draft(settings: RosSettings) -> str:
    """A robot file with what the robot offers. Raises `DriverError`."""
    _, found = await _visit(settings, Path(), {})
    return "\n".join(_drafted(settings, found)) + "\n"


def _drafted(settings: RosSettings, found: Survey) -> Iterator[str]:
    topics = {name: plain(kind) for name, kind in found.topics.items() if kind}
    yield "# A draft: keep what you need, name the verbs, then run woz check and woz doctor."
    yield "name: robot"
    yield "drivers:"
    yield "  robot:"
    yield "    type: ros"
    yield f"    address: {settings.address}"
    yield f"    ros: {found.ros or settings.ros}"
    base = [name for name, kind in topics.items() if kind in (TWIST, TWIST_STAMPED)]
    if base:
        chosen = min(base, key=lambda name: (not name.endswith("cmd_vel"), len(name)))
        odometry = [name for name, kind in topics.items() if kind == "nav_msgs/Odometry"]
        others = ", ".join(name for name in base if name != chosen)
        yield f"    drive:{f'             # or {others}' if others else ''}"
        yield f"      topic: {chosen}"
        yield f"      type: {topics[chosen]}"
        yield "      speed: 0.1        # m/s: begin slowly"
        if odometry:
            yield f"      odometry: {min(odometry, key=len)}"
    sensors = [*_drafted_sensors(topics)]
    if sensors:
        yield "    sensors:"
        yield from sensors
    verbs = [*_drafted_verbs(found, topics)]
    yield "    verbs:" if any("#" not in line for line in verbs) else "    verbs: {}"
    yield from verbs


def _drafted_sensors(topics: dict[str, str]) -> Iterator[str]:
    values = {
        "sensor_msgs/Range": ("distance", "value: range, unit: m"),
        "sensor_msgs/LaserScan": ("distance", "value: 'min(ranges[-15deg:15deg])', unit: m"),
        "sensor_msgs/BatteryState": ("battery", "value: percentage, scale: 100, unit: '%'"),
    }
    used: set[str] = set()
    for topic, kind in topics.items():
        if kind in values:
            name, value = values[kind]
            mark = "" if name not in used else "# "
            used.add(name)
            yield f"      {mark}{name}: {{subscribe: {topic}, type: {kind}, {value}}}"
            if kind == SCAN and not mark:
                yield "      # Is its front not the robot's? woz doctor says it; then: mounted: 90"


def _drafted_verbs(found: Survey, topics: dict[str, str]) -> Iterator[str]:
    """Candidates: topics of a text, services, actions. All of them comments but the first voice."""
    words = ("say", "tts", "speech", "speak")
    voices = [
        name
        for name, kind in topics.items()
        if kind == "std_msgs/String" and any(word in name for word in words)
    ]
    for at, topic in enumerate(voices):
        mark = "" if at == 0 else "# "
        yield f"      {mark}say:"
        yield f"      {mark}  publish: {topic}"
        yield f"      {mark}  type: std_msgs/String"
        yield f'      {mark}  message: {{data: "{{text}}"}}'
        yield f"      {mark}  ends: {{seconds: 0.5 s, per_character: 60 ms}}"
    for action, kind in found.actions.items():
        yield f"      # play:              # {action}"
        yield f"      #   action: {action}"
        yield f"      #   type: {kind or 'PACKAGE/NAME'}"
        part = f"{kind}_Goal" if kind else ""
        yield f"      #   message: {_template(part, found.types)}"
    for service, kind in sorted(found.services.items()):
        if kind:
            yield f"      # {service.strip('/').replace('/', '_').lower()}:"
            yield f"      #   service: {service}"
            yield f"      #   type: {plain(kind)}"
            yield f"      #   message: {_template(f'{plain(kind)}_Request', found.types)}"


def _template(kind: str, types: MessageTypes) -> str:
    fields = types.fields(kind)
    if fields is None:
        return "{}"
    inner = ", ".join(f"{name}: {_empty(each)}" for name, each in fields.items())
    return f"{{{inner}}}"


def _empty(kind: str) -> str:
    if "[" in kind:
        return "[]"
    if "/" in kind or kind in ("time", "duration"):
        return "{}"
    words = {"string": '""', "bool": "false", "boolean": "false"}
    return words.get(kind, "0.0" if kind.startswith(("float", "double")) else "0")
