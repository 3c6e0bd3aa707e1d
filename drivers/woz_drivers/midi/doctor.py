"""`woz doctor` for a panel: looks, opens, listens, and lets go again; nothing is sent."""

from __future__ import annotations

import asyncio
import contextlib
import os
from pathlib import Path

from woz_drivers.midi import devices
from woz_drivers.midi.panel_layouts import LAYOUTS
from woz_drivers.midi.resolved_map import PanelSignals, mapped_controls
from woz_drivers.midi.settings import MidiSettings
from woz_drivers.midi.wire import MidiDecoder
from woz_tui.drivers.contract import DeviceLostError, Finding

#: Names of free controls that are worth telling.
_SHOWN = 12
#: So long it is listened to, in seconds, and so much is read.
_LISTEN_S, _MOST = 1.5, 1 << 16


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


async def listen(subject: str, settings: MidiSettings, folder: Path) -> list[Finding]:
    """Whether what the panel sends meanwhile is what its controls send. Never raises."""
    panel = settings.panel
    wanted = settings.device or panel.device or LAYOUTS[panel.layout].device
    try:
        path, fd, _ = devices.open_one(wanted, folder)
    except DeviceLostError:
        return []  # which `examine` has told
    try:
        await asyncio.sleep(_LISTEN_S)
        with contextlib.suppress(OSError):  # nothing came, or it was unplugged
            return _heard(subject, path, settings, os.read(fd, _MOST))
    finally:
        os.close(fd)
    return [Finding("info", subject, f"{path} sent nothing", "move a control while this listens")]


def _heard(subject: str, path: str, settings: MidiSettings, data: bytes) -> list[Finding]:
    signals = PanelSignals(settings, mapped_controls(settings))
    senders = [signals.control_of(message) for message in MidiDecoder().feed(data)]
    if signals.other_mode:
        return [Finding("error", subject, f"{path}: {signals.other_mode}", signals.own_mode)]
    names = dict.fromkeys(it.name for it in senders if it is not None)
    if not names:
        return []
    return [Finding("ok", subject, f"{path} sent {', '.join([*names][:_SHOWN])}")]


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
