"""A gamepad by Linux's joystick interface, /dev/input/js0: no library needed.

Source: Linux, "input/joydev/joystick-api.rst" (records, ioctls) and "input/gamepad.rst" (codes).
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import struct
from collections.abc import Sequence
from pathlib import Path

from woz_drivers.hands.device_models import GAMEPAD
from woz_drivers.hands.event_listing import other_kind
from woz_drivers.hands.hand_device import HandDevice
from woz_drivers.hands.record_reader import RecordReader, open_device
from woz_tui.drivers.contract import DeviceLostError

DEV = Path("/dev/input")
_SYSFS = Path("/sys/class/input")
#: struct js_event: time in ms, value, type, number.
RECORD = struct.Struct("<IhBB")
BUTTON_TYPE, AXIS_TYPE, INIT = 0x01, 0x02, 0x80
_FULL = 32767

_NAME, _AXES, _BUTTONS = 0x80006A13 | 128 << 16, 0x80016A11, 0x80016A12
#: Event codes of axes (64 bytes) and of buttons (512 words), in the order of their numbers.
_AXIS_CODES, _BUTTON_CODES = 0x80406A32, 0x84006A34

_X, _Y, _Z, _RX, _RY, _RZ, _GAS, _BRAKE, _HAT_X, _HAT_Y = 0, 1, 2, 3, 4, 5, 9, 10, 16, 17
_BUTTON_NAMES = {
    **{0x130: "south", 0x131: "east", 0x133: "north", 0x134: "west"},
    **{0x136: "left-bumper", 0x137: "right-bumper"},
    **{0x138: "left-trigger", 0x139: "right-trigger"},
    **{0x13A: "select", 0x13B: "start", 0x13C: "home"},
    **{0x13D: "left-stick", 0x13E: "right-stick"},
    **{0x220: "up", 0x221: "down", 0x222: "left", 0x223: "right"},
}
#: Codes of buttons by which the kernel says what a device is (BTN_GAMEPAD, BTN_JOYSTICK).
_GAMEPAD_BUTTONS, _JOYSTICK_BUTTONS = range(0x130, 0x140), range(0x120, 0x130)
#: The order of an Xbox pad, for what is no device: a FIFO, a recording.
_PLAIN_AXES: tuple[int, ...] = (_X, _Y, _Z, _RX, _RY, _RZ, _HAT_X, _HAT_Y)
_PLAIN_BUTTONS: tuple[int, ...] = (
    *(0x130, 0x131, 0x134, 0x133, 0x136, 0x137),
    *(0x13A, 0x13B, 0x13C, 0x13D, 0x13E),
)


def axis_names(codes: Sequence[int]) -> dict[int, str]:
    """Number of an axis -> its name; a hat is `hat-x` and `hat-y`."""
    there = set(codes)
    names = {_X: "left-stick-x", _Y: "left-stick-y", _HAT_X: "hat-x", _HAT_Y: "hat-y"}
    if {_GAS, _BRAKE} <= there:  # over Bluetooth
        names |= {_BRAKE: "left-trigger", _GAS: "right-trigger"}
        names |= {_Z: "right-stick-x", _RZ: "right-stick-y"}
    elif {_RX, _RY} <= there:
        names |= {_RX: "right-stick-x", _RY: "right-stick-y"}
        names |= {_Z: "left-trigger", _RZ: "right-trigger"}
    else:
        names |= {_Z: "right-stick-x", _RZ: "right-stick-y"}
    return {number: names[code] for number, code in enumerate(codes) if code in names}


def button_names(codes: Sequence[int], device: str, driver: str = "") -> dict[int, str]:
    """Number of a button -> its name. Linux has X and Y of an Xbox pad the wrong way round, and of
    every other one that its `driver` xpad serves.
    """
    names = dict(_BUTTON_NAMES)
    if driver == "xpad" or "xbox" in device.casefold().replace("-", ""):
        names |= {0x133: "west", 0x134: "north"}
    return {number: names[code] for number, code in enumerate(codes) if code in names}


def _kernel_driver(path: str) -> str:
    """What serves it, such as xpad or hid-generic; empty: unknown, or it is no device."""
    with contextlib.suppress(OSError):
        return (_SYSFS / Path(path).name / "device/device/driver").readlink().name
    return ""


def why_no_gamepad(path: str, name: str, buttons: Sequence[int]) -> DeviceLostError | None:
    """Why this device is none, in spite of what the joystick interface makes of it; None: it is.

    A 6-D mouse and a Wii Remote's sensors have axes with the numbers of sticks and triggers. What
    has a button of a gamepad or a joystick is one.
    """
    if (kind := other_kind(name)) != "":
        remedy = f"a panel with `device: {kind}` reads it, by another way"
    elif any(code in _GAMEPAD_BUTTONS or code in _JOYSTICK_BUTTONS for code in buttons):
        return None
    else:
        remedy = "none of its buttons is one of a gamepad; docs/how-to/hands.md has what is known"
    return DeviceLostError(f"{path}: {name or 'this device'} is no gamepad", remedy)


class Gamepad(HandDevice):
    """A gamepad that is open. Raises `DeviceLostError` if it cannot be opened, or is none."""

    def __init__(self, path: str) -> None:
        fd = open_device(path)
        axes, buttons = _PLAIN_AXES, _PLAIN_BUTTONS
        name = ""
        with contextlib.suppress(OSError):  # no device
            reply = fcntl.ioctl(fd, _NAME, bytes(128))
            name = reply.split(b"\0")[0].decode("utf-8", "replace")
            axes, buttons = _codes(fd)
        if (refusal := why_no_gamepad(path, name, buttons)) is not None:
            os.close(fd)
            raise refusal
        super().__init__(GAMEPAD, name or Path(path).name, path)
        self._axes = axis_names(axes)
        self._buttons = button_names(buttons, self.name, _kernel_driver(path))
        #: A trigger that is an axis and a button is read as the axis.
        self._pulled = set(self._axes.values())
        self._reader = RecordReader(fd, RECORD, self._take, self._ended)
        if name:  # how it stands when it is plugged in: nobody has pressed that
            self._reader.read()

    def close(self) -> None:
        """Let go of it."""
        self._reader.close()

    def _ended(self) -> None:
        self.on_lost("unplugged")

    def _take(self, record: tuple[int, ...]) -> None:
        _, value, kind, number = record
        if kind & ~INIT == AXIS_TYPE and number in self._axes:
            self._axis(self._axes[number], value)
        elif kind & ~INIT == BUTTON_TYPE:
            name = self._buttons.get(number, "")
            if name and name not in self._pulled:
                self.move(name, float(bool(value)))

    def _axis(self, name: str, value: int) -> None:
        share = max(-1.0, value / _FULL)
        match name:
            case "hat-x" | "hat-y":
                low, high = ("left", "right") if name == "hat-x" else ("up", "down")
                self.move(low, float(share < -0.5))
                self.move(high, float(share > 0.5))
            case "left-trigger" | "right-trigger":
                self.move(name, round((share + 1) / 2, 2))
            case _:  # the kernel counts down as positive
                self.move(name, round(-share if name.endswith("-y") else share, 2) + 0.0)


def _codes(fd: int) -> tuple[tuple[int, ...], tuple[int, ...]]:
    axes = fcntl.ioctl(fd, _AXES, b"\0")[0]
    buttons = fcntl.ioctl(fd, _BUTTONS, b"\0")[0]
    axis_codes = fcntl.ioctl(fd, _AXIS_CODES, bytes(64))
    button_codes = struct.unpack("<512H", fcntl.ioctl(fd, _BUTTON_CODES, bytes(1024)))
    return tuple(axis_codes[:axes]), button_codes[:buttons]


def device_name(path: str) -> str:
    """What a gamepad calls itself, from the system's list; empty where nobody knows."""
    listed = Path("/sys/class/input") / Path(path).name / "device" / "name"
    try:
        return listed.read_text("utf-8").strip()
    except (OSError, ValueError):
        return ""


def present_gamepads() -> list[str]:
    """The paths of gamepads that are plugged in, in the order of their numbers."""
    found = [path for path in DEV.glob("js*") if path.name[2:].isdigit()]
    return [str(path) for path in sorted(found, key=lambda path: int(path.name[2:]))]
