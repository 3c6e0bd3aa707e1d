"""A motion sensor in the hand that writes lines of text to a serial port, as an Arduino does.

A line is `roll pitch yaw` in degrees, or `w x y z` of a quaternion, with spaces or commas between
them; `down` or `up` behind it says whether the button is held, its clutch.
"""

from __future__ import annotations

import asyncio
import contextlib
import math
import os
import struct
from typing import NamedTuple

from woz_drivers.hands.device_models import IMU
from woz_drivers.hands.hand_device import HandDevice
from woz_drivers.hands.record_reader import RecordReader
from woz_drivers.lines.line_decoder import LineDecoder, LineError
from woz_drivers.lines.serial_line import LOSSES, explain_port_error, open_port

#: Unless the port's name ends with another, such as /dev/ttyUSB0@57600.
BAUD = 115200
#: Turned so far from where the clutch was pressed is the whole way.
FULL_DEG = 90
#: What has said nothing for so long, in seconds, holds nothing.
SILENT_S = 0.3
_REMEDY = "a line is `roll pitch yaw` in degrees or `w x y z`, and `down` or `up` for its button"

_BYTE = struct.Struct("c")

Quaternion = tuple[float, float, float, float]


class Sample(NamedTuple):
    """One line: how it is turned, and its button; None: it does not say."""

    turned: Quaternion
    down: bool | None = None


def sample_of(line: bytes) -> Sample:
    """What a line says. Raises `LineError`."""
    words = line.decode("ascii", "replace").replace(",", " ").split()
    down = {"down": True, "up": False}.get(words[-1].casefold()) if words else None
    try:
        numbers = [float(word) for word in (words if down is None else words[:-1])]
    except ValueError:
        numbers = []
    if len(numbers) not in (3, 4) or not all(map(math.isfinite, numbers)):
        raise LineError(f"{line[:40]!r} says no turn", _REMEDY)
    if len(numbers) == 3:
        return Sample(_of_angles(*map(math.radians, numbers)), down)
    length = math.hypot(*numbers)
    if length < 0.5:
        raise LineError(f"{line[:40]!r} is no turn: a quaternion has the length 1", _REMEDY)
    w, x, y, z = (number / length for number in numbers)
    return Sample((w, x, y, z), down)


def angles_between(start: Quaternion, end: Quaternion) -> tuple[float, float, float]:
    """Roll, pitch and yaw in degrees, seen from how it was turned at the start."""
    w, x, y, z = _product((start[0], -start[1], -start[2], -start[3]), end)
    return (
        math.degrees(math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))),
        math.degrees(math.asin(min(max(2 * (w * y - z * x), -1.0), 1.0))),
        math.degrees(math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))),
    )


def _product(a: Quaternion, b: Quaternion) -> Quaternion:
    return (
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    )


def _of_angles(roll: float, pitch: float, yaw: float) -> Quaternion:
    about_x = (math.cos(roll / 2), math.sin(roll / 2), 0.0, 0.0)
    about_y = (math.cos(pitch / 2), 0.0, math.sin(pitch / 2), 0.0)
    about_z = (math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2))
    return _product(about_z, _product(about_y, about_x))


class Imu(HandDevice):
    """A sensor that is open; turned from where its clutch was pressed, or from its first line.

    Args:
        path: The port, with `@` and its rate behind it where that is not 115200 baud.

    Raises `DeviceLostError` if it cannot be opened.
    """

    def __init__(self, path: str) -> None:
        port, _, rate = path.partition("@")
        super().__init__(IMU, f"motion sensor at {port}", path)
        baud = int(rate) if rate.isdigit() else BAUD
        self._lines = LineDecoder(sample_of, first_line=False)
        self._zero: Quaternion | None = None
        self._silent: asyncio.TimerHandle | None = None
        try:
            self._serial = open_port(port, baud)
        except (*LOSSES, ValueError) as error:
            raise explain_port_error(port, baud, error) from error
        fd = self._serial.fileno()
        self._reader = RecordReader(os.dup(fd), _BYTE, self._take, self._ended)

    def close(self) -> None:
        """Let go of it."""
        if self._silent is not None:
            self._silent.cancel()
        self._reader.close()
        with contextlib.suppress(*LOSSES):
            self._serial.close()

    def _ended(self) -> None:
        self.on_lost("unplugged")

    def _take(self, record: tuple[bytes]) -> None:
        for sample in self._lines.feed(record[0]):
            self._turn(sample)

    def _turn(self, sample: Sample) -> None:
        held = sample.down is not False
        if self._zero is None or (sample.down and not self.held.get("clutch")):
            self._zero = sample.turned
        angles = angles_between(self._zero, sample.turned) if held else (0.0, 0.0, 0.0)
        for axis, angle in zip("xyz", angles, strict=True):
            self.move(f"turn-{axis}", round(min(max(angle / FULL_DEG, -1.0), 1.0), 2) + 0.0)
        self.move("clutch", float(sample.down is True))
        if self._silent is not None:
            self._silent.cancel()
        self._silent = asyncio.get_running_loop().call_later(SILENT_S, self._rest)

    def _rest(self) -> None:
        for name in list(self.held):
            self.move(name, 0.0)
