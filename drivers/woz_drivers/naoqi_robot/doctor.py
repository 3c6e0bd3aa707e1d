"""Examines the robots of a file for `woz doctor`: it asks, and moves nothing."""

from __future__ import annotations

import asyncio
import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from woz_drivers.lines.answer_times import line_finding
from woz_drivers.naoqi_robot import memory
from woz_drivers.naoqi_robot.address import Address, parse
from woz_drivers.naoqi_robot.connection import simulated_naoqi
from woz_drivers.naoqi_robot.line import ESSENTIAL
from woz_drivers.naoqi_robot.link import (
    LinkError,
    Methods,
    NaoqiLink,
    ServiceMissingError,
    Unsubscribe,
    open_link,
)
from woz_drivers.naoqi_robot.microphones import heard
from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_tui.drivers.contract import DriverError, Finding, HeardSound, Probe

#: Seconds for each question; a robot that is slow shows as slow, not as gone.
_WITHIN_S = 3.0
_LISTENS = "restart it; `record_sound` records on the robot itself"
#: Charge below which an experiment of an hour may end early, in percent.
_LOW = 30
#: Room for a session's pictures and sounds, in bytes.
_ROOM = 500 * 1000 * 1000


async def examine_robots(probe: Probe, own: Sequence[RobotCheck] = ()) -> list[Finding]:
    """Everything about every robot of the file, `own` being what this kind of robot is asked, too.
    Never raises.
    """
    settings: NaoqiSettings = probe.settings
    findings: list[Finding] = []
    if not settings.addresses:
        findings.append(
            Finding("warning", "robots", "names no robot", "write an address, or `simulated`")
        )
    examined = await asyncio.gather(
        *(_robot(path, text, probe, own) for path, text in settings.addresses.items())
    )
    findings += [finding for robot_findings in examined for finding in robot_findings]
    findings.append(_disk(settings, probe.folder))
    return findings


async def _robot(path: str, text: str, probe: Probe, own: Sequence[RobotCheck]) -> list[Finding]:
    settings: NaoqiSettings = probe.settings
    try:
        address = parse(text)
    except DriverError as error:
        return [Finding("error", path, error.what, error.remedy)]
    simulated = simulated_naoqi(settings, probe.folder)
    try:
        real = parse(await simulated.address()) if address.simulated else address
        link = await open_link(real, settings)
    except DriverError as error:
        await simulated.close()
        return [Finding("error", address.shown, error.what, error.remedy)]
    try:
        return await _visit(address, link, settings, own)
    except LinkError as error:
        lost = f"was disconnected during the check: {error}"
        return [Finding("error", address.shown, lost, "check its network, and try again")]
    finally:
        await link.close()
        await simulated.close()


async def hear(probe: Probe, seconds: float) -> HeardSound | None:
    """Of the robot that a session would begin with. Raises `DriverError`."""
    settings: NaoqiSettings = probe.settings
    text = next(iter(settings.addresses.values()), "")
    if not text:
        return None
    address = parse(text)
    simulated = simulated_naoqi(settings, probe.folder)
    try:
        real = parse(await simulated.address()) if address.simulated else address
        link = await open_link(real, settings)
        try:
            return await heard(_Calls(link), seconds)
        finally:
            await link.close()
    finally:
        await simulated.close()


@dataclass(frozen=True, slots=True)
class _Calls:
    """A link's calls, whose errors are a driver's."""

    link: NaoqiLink

    async def call(self, service: str, method: str, *args: Any, within: float = _WITHIN_S) -> Any:
        try:
            return await self.link.call(service, method, *args, within=within)
        except LinkError as error:
            raise DriverError(f"{service}.{method}: {error}", _LISTENS) from None

    async def serve(self, name: str, methods: Methods) -> Unsubscribe:
        try:
            return await self.link.serve(name, methods)
        except LinkError as error:
            raise DriverError(f"it takes no sound service: {error}", _LISTENS) from None


async def _visit(
    address: Address, link: NaoqiLink, settings: NaoqiSettings, own: Sequence[RobotCheck]
) -> list[Finding]:
    """Findings about a connected robot. Raises `LinkError` if the connection is lost."""
    services = await link.services(_WITHIN_S)
    findings = [await line_finding(address.shown, lambda: link.ask(_WITHIN_S))]
    if address.secure:
        findings.append(_certificate(address, link, settings))
    findings.append(_services(address, settings.model.services, services))
    for question in (*_CHECKS, *own):
        if question.service in services:
            findings.append(await _check(address, link, question))
    return findings


def _certificate(address: Address, link: NaoqiLink, settings: NaoqiSettings) -> Finding:
    if settings.trusted:
        return Finding("ok", address.shown, "shows the trusted certificate")
    return Finding(
        "warning",
        address.shown,
        f"shows the certificate {link.certificate}; any is accepted",
        f"set `trusted: {link.certificate}`",
    )


def _services(address: Address, used: frozenset[str], services: frozenset[str]) -> Finding:
    missing = sorted(used - services)
    if not missing:
        return Finding("ok", address.shown, "all services are there")
    level = "error" if ESSENTIAL - services else "warning"
    remedy = "after its start they come one by one: wait; what never comes cannot be used"
    return Finding(level, address.shown, f"without {', '.join(missing)}", remedy)


@dataclass(frozen=True, slots=True)
class RobotCheck:
    """One call that changes nothing, and what its answer means: level, text, remedy."""

    service: str
    method: str
    judged: Callable[[Any], tuple[str, str, str]]


async def _check(address: Address, link: NaoqiLink, question: RobotCheck) -> Finding:
    what = f"{question.service}.{question.method}"
    try:
        answer = await link.call(question.service, question.method, within=_WITHIN_S)
        level, text, remedy = question.judged(answer)
    except ServiceMissingError as missing:
        return Finding("warning", address.shown, str(missing), "try again")
    except LinkError as error:
        return Finding("warning", address.shown, f"does not tell {what}: {error}", "restart it")
    except ValueError:
        text = f"{what} is {memory.brief(answer)}: not understood"
        return Finding("warning", address.shown, text, "restart it")
    return Finding(level, address.shown, text, remedy)


def word(answer: Any) -> str:
    """A name or a state. Raises `ValueError` for what is none."""
    found = memory.word(answer)
    if found is None:
        raise ValueError("no word")
    return found


def _charge(percent: Any) -> tuple[str, str, str]:
    charge = memory.within(percent, 0, 100)
    if charge is None:
        raise ValueError("no charge")
    text = f"battery at {int(charge)} %"
    if charge < _LOW:
        return "warning", text, "charge it before the session"
    return "ok", text, ""


def _awake(answer: Any) -> tuple[str, str, str]:
    awake = memory.flag(answer)
    if awake is None:
        raise ValueError("neither yes nor no")
    if awake:
        return "ok", "is awake", ""
    return "info", "rests: its motors are off", "wake it with `torque: {on: true}`"


def _life(state: Any) -> tuple[str, str, str]:
    text = f"autonomous life is {word(state)}"
    if state in ("interactive", "safeguard"):
        # From interactive the robot changes to disabled alone.
        quiet = ("disabled",) if state == "interactive" else ("solitary", "disabled")
        settings = " or ".join(f"`autonomy: {{state: {each}}}`" for each in quiet)
        return "warning", text, f"it may act by itself: set {settings}"
    return "ok", text, ""


_CHECKS = (
    RobotCheck("ALSystem", "systemVersion", lambda it: ("ok", f"runs NAOqi {word(it)}", "")),
    RobotCheck("ALSystem", "robotName", lambda it: ("ok", f"is called {word(it)}", "")),
    RobotCheck("ALBattery", "getBatteryCharge", _charge),
    RobotCheck("ALMotion", "robotIsWakeUp", _awake),
    RobotCheck("ALAutonomousLife", "getState", _life),
)


def _disk(settings: NaoqiSettings, folder: Path) -> Finding:
    """Room for pictures and sounds on this machine."""
    pictures_folder = folder / settings.pictures
    paths = (pictures_folder, *pictures_folder.parents)
    existing = next((path for path in paths if path.exists()), folder)
    try:
        free = shutil.disk_usage(existing).free
    except OSError as error:
        return Finding("warning", str(pictures_folder), f"cannot be looked at: {error.strerror}")
    text = f"{free / 1e9:.1f} GB free for pictures and sounds"
    if free < _ROOM:
        return Finding("warning", str(existing), text, "delete what is no longer needed")
    return Finding("ok", str(existing), text)
