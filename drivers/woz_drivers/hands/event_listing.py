"""The devices of Linux's event interface, /dev/input/event0, from the system's list: none is
opened.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from woz_drivers.hands.device_models import SPACEMOUSE, WII_REMOTE

DEV = Path("/dev/input")
SYSFS = Path("/sys/class/input")
#: What hid-wiimote calls a Wii Remote's buttons; its sensors have a word behind that.
WII_NAME, WII_ACCELEROMETER = "Nintendo Wii Remote", "Nintendo Wii Remote Accelerometer"
#: What is no part of a Wii Remote but a gamepad by that driver.
_WII_PADS = ("Pro Controller", "Classic Controller")
#: 6-D mice by what they call themselves, without spaces, and what else their maker sells.
_SPACE_NAMES = ("3dconnexion", "spacemouse", "spacenavigator", "spaceexplorer", "spacepilot")
_NO_SPACE_NAMES = ("cadmouse", "keyboard", "numpad")


class EventDevice(NamedTuple):
    """One that is plugged in; `hardware`: the same for all that belong to one device."""

    path: str
    name: str
    hardware: str = ""

    @property
    def kind(self) -> str:
        """What it is here: spacemouse, wii-remote; empty: something else."""
        kind = other_kind(self.name)
        return "" if kind == WII_REMOTE and self.name != WII_NAME else kind


def other_kind(name: str) -> str:
    """What a device of this name is, where it is no gamepad; empty: perhaps it is one."""
    if name.startswith(WII_NAME) and not name.endswith(_WII_PADS):
        return WII_REMOTE
    close = name.casefold().replace(" ", "")
    if any(word in close for word in _NO_SPACE_NAMES):
        return ""
    return SPACEMOUSE if any(word in close for word in _SPACE_NAMES) else ""


def present_event_devices() -> Iterator[EventDevice]:
    """In the order of their numbers."""
    found = [path for path in SYSFS.glob("event*") if path.name[5:].isdigit()]
    for listed in sorted(found, key=lambda path: int(path.name[5:])):
        device = listed / "device"
        yield EventDevice(
            str(DEV / listed.name),
            _text(device / "name"),
            str((device / "device").resolve()),
        )


def _text(path: Path) -> str:
    try:
        return path.read_text("utf-8").strip()
    except (OSError, ValueError):
        return ""
