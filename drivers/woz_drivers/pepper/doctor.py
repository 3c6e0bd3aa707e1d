"""Examines the robots of a file for `woz doctor`: it asks, and moves nothing."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from woz_drivers.naoqi_robot.doctor import RobotCheck, examine_robots, word
from woz_drivers.naoqi_robot.served_files import is_address
from woz_drivers.pepper.settings import PepperSettings
from woz_drivers.pepper.tablet_page import REMEDY, places
from woz_tui.drivers.contract import DriverError, Finding, Probe


async def examine(probe: Probe) -> list[Finding]:
    """Everything about every robot of the file. Never raises."""
    settings: PepperSettings = probe.settings
    tablet = RobotCheck("ALTabletService", "getWifiStatus", _tablet)
    return [*await examine_robots(probe, (tablet,)), *_default(settings, probe.folder)]


def _tablet(status: Any) -> tuple[str, str, str]:
    if status == "CONNECTED":
        return "ok", "the tablet is there, its wireless network is connected", ""
    return (
        "warning",
        f"the tablet answers, its wireless network is {word(status).lower()}",
        "it reaches this machine through that alone: use `tablet: wifi`, or its own settings",
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
