"""`woz doctor` for a panel: looks, opens, and lets go again; nothing is sent."""

from __future__ import annotations

import os
from pathlib import Path

from woz_drivers.midi import devices
from woz_drivers.midi.panel_layouts import LAYOUTS
from woz_drivers.midi.resolved_map import mapped_controls
from woz_drivers.midi.settings import MidiSettings
from woz_tui.drivers.contract import DeviceLostError, Finding

#: Names of free controls that are worth telling.
_SHOWN = 12


def examine(
    subject: str,
    settings: MidiSettings,
    folder: Path,
    dev: Path = devices.DEV,
    proc: Path = devices.PROC,
) -> list[Finding]:
    """What there is to say; never raises. `dev` and `proc` are where the system lists devices."""
    return [
        *_devices(subject, dev, proc),
        _opened(subject, settings, folder, dev, proc),
        *_free_controls(subject, settings),
    ]


def _devices(subject: str, dev: Path, proc: Path) -> list[Finding]:
    found = []
    for device in devices.present_devices(dev, proc):
        name = f"{device.path}: {device.name or device.card}"
        if os.access(device.path, os.R_OK | os.W_OK):
            found.append(Finding("info", subject, name))
        else:
            remedy = "sudo usermod -aG audio $USER, then log out and in again"
            found.append(Finding("warning", subject, f"{name}, but you may not use it", remedy))
    return found


def _opened(subject: str, settings: MidiSettings, folder: Path, dev: Path, proc: Path) -> Finding:
    panel = settings.panel
    wanted = settings.device or panel.device or LAYOUTS[panel.layout].device
    try:
        path, fd, writable = devices.open_one(wanted, folder, dev, proc)
    except DeviceLostError as error:
        return Finding("error", subject, error.what, error.remedy)
    os.close(fd)
    lights = "" if writable else "; its lights cannot be switched"
    return Finding("ok", subject, f"{path} can be opened{lights}")


def _free_controls(subject: str, settings: MidiSettings) -> list[Finding]:
    controls = mapped_controls(settings)
    free = [it.name for it in controls if it.free]
    used = f"{len(controls) - len(free)} controls do something"
    if len(free) == len(controls):
        return [Finding("warning", subject, "no control does anything", "see docs/how-to/midi.md")]
    if not free:
        return [Finding("ok", subject, used)]
    dots = ", ..." if len(free) > _SHOWN else ""
    return [Finding("info", subject, f"{used}; free: {', '.join(free[:_SHOWN])}{dots}")]
