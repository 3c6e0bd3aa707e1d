"""Examines the robots of a file for `woz doctor`: it asks, and moves nothing."""

from __future__ import annotations

import asyncio
import shutil
import statistics
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from woz_drivers.naoqi_robot import memory
from woz_drivers.naoqi_robot.address import Address, parse
from woz_drivers.naoqi_robot.naoqi_link import LinkError, NaoqiLink, ServiceMissingError, open_link
from woz_drivers.naoqi_robot.robot_connection import simulated_naoqi
from woz_drivers.naoqi_robot.robot_line import ESSENTIAL, USED_SERVICES
from woz_drivers.naoqi_robot.served_files import REMEDY, places
from woz_drivers.pepper.settings import PepperSettings
from woz_drivers.pepper.tablet_page import is_address
from woz_tui.drivers.contract import DriverError, Finding, Probe

#: Seconds for each question; a robot that is slow shows as slow, not as gone.
_WITHIN_S = 3.0
_QUESTIONS = 20
#: A slower line lags visibly behind the wizard's key, in milliseconds.
_SLOW_MS = 50.0
#: Charge below which an experiment of an hour may end early, in percent.
_LOW = 30
#: Room for a session's pictures and sounds, in bytes.
_ROOM = 500 * 1000 * 1000


async def examine(probe: Probe) -> list[Finding]:
    """Everything about every robot of the file. Never raises."""
    settings: PepperSettings = probe.settings
    findings: list[Finding] = []
    if not settings.robots:
        findings.append(
            Finding("warning", "robots", "names no robot", "write an address, or `simulated`")
        )
    examined = await asyncio.gather(*(_robot(text, probe) for text in settings.robots))
    findings += [finding for robot_findings in examined for finding in robot_findings]
    findings += _default(settings, probe.folder)
    findings.append(_disk(settings, probe.folder))
    return findings


async def _robot(text: str, probe: Probe) -> list[Finding]:
    settings: PepperSettings = probe.settings
    try:
        address = parse(text)
    except DriverError as error:
        return [Finding("error", "robots", error.what, error.remedy)]
    simulated = simulated_naoqi(settings.pace, probe.folder)
    try:
        real = parse(await simulated.address()) if address.simulated else address
        link = await open_link(real, settings)
    except DriverError as error:
        await simulated.close()
        return [Finding("error", address.shown, error.what, error.remedy)]
    try:
        return await _visit(address, link, settings)
    except LinkError as error:
        lost = f"was disconnected during the check: {error}"
        return [Finding("error", address.shown, lost, "check its network, and try again")]
    finally:
        await link.close()
        await simulated.close()


async def _visit(address: Address, link: NaoqiLink, settings: PepperSettings) -> list[Finding]:
    """Findings about a connected robot. Raises `LinkError` if the connection is lost."""
    services = await link.services(_WITHIN_S)
    findings = [await _line(address, link)]
    if address.secure:
        findings.append(_certificate(address, link, settings))
    findings.append(_services(address, services))
    for question in _CHECKS:
        if question.service in services:
            findings.append(await _check(address, link, question))
    return findings


async def _line(address: Address, link: NaoqiLink) -> Finding:
    loop = asyncio.get_running_loop()
    times_ms = []
    for _ in range(_QUESTIONS):
        begun = loop.time()
        await link.ask(_WITHIN_S)
        times_ms.append((loop.time() - begun) * 1000)
    median, worst = statistics.median(times_ms), max(times_ms)
    text = f"answers in {median:.1f} ms (worst of {_QUESTIONS}: {worst:.1f} ms)"
    if median > _SLOW_MS:
        remedy = "use a cable, or a wireless network of its own on 5 GHz"
        return Finding("warning", address.shown, text, remedy)
    return Finding("ok", address.shown, text)


def _certificate(address: Address, link: NaoqiLink, settings: PepperSettings) -> Finding:
    if settings.trusted:
        return Finding("ok", address.shown, "shows the trusted certificate")
    return Finding(
        "warning",
        address.shown,
        f"shows the certificate {link.certificate}; any is accepted",
        f"set `trusted: {link.certificate}`",
    )


def _services(address: Address, services: frozenset[str]) -> Finding:
    missing = sorted(USED_SERVICES - services)
    if not missing:
        return Finding("ok", address.shown, "all services are there")
    level = "error" if ESSENTIAL - services else "warning"
    remedy = "after its start they come one by one: wait; what never comes cannot be used"
    return Finding(level, address.shown, f"without {', '.join(missing)}", remedy)


@dataclass(frozen=True, slots=True)
class _RobotCheck:
    """One call that changes nothing, and what its answer means: level, text, remedy."""

    service: str
    method: str
    judged: Callable[[Any], tuple[str, str, str]]


async def _check(address: Address, link: NaoqiLink, question: _RobotCheck) -> Finding:
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


def _word(answer: Any) -> str:
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
    text = f"autonomous life is {_word(state)}"
    if state in ("interactive", "safeguard"):
        remedy = "it may act by itself: set `autonomy: {state: solitary}` or disabled"
        return "warning", text, remedy
    return "ok", text, ""


def _tablet(status: Any) -> tuple[str, str, str]:
    if status == "CONNECTED":
        return "ok", "the tablet is there, its wireless network is connected", ""
    return (
        "warning",
        f"the tablet answers, its wireless network is {_word(status).lower()}",
        "it reaches this machine through that alone: use `tablet: wifi`, or its own settings",
    )


_CHECKS = (
    _RobotCheck("ALSystem", "systemVersion", lambda it: ("ok", f"runs NAOqi {_word(it)}", "")),
    _RobotCheck("ALSystem", "robotName", lambda it: ("ok", f"is called {_word(it)}", "")),
    _RobotCheck("ALBattery", "getBatteryCharge", _charge),
    _RobotCheck("ALMotion", "robotIsWakeUp", _awake),
    _RobotCheck("ALAutonomousLife", "getState", _life),
    _RobotCheck("ALTabletService", "getWifiStatus", _tablet),
)


def _default(settings: PepperSettings, folder: Path) -> list[Finding]:
    """Whether what the tablet shows on connect is there; a page elsewhere is not asked for."""
    shown = settings.tablet.default
    if not shown or is_address(shown):
        return []
    try:
        paths = places(shown, settings.tablet.root, folder)
        if any(path.is_file() for path in paths):
            return [Finding("ok", "tablet", f"its default is {shown}")]
    except (DriverError, OSError):
        pass  # no name that a file can have
    return [Finding("warning", "tablet", f"its default {shown!r} is no file", REMEDY)]


def _disk(settings: PepperSettings, folder: Path) -> Finding:
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
