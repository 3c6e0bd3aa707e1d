"""A 6-D mouse, by spacenavd's socket or by Linux's event interface: no library needed.

spacenavd, where it runs, has the device for itself. Sources: spacenavd, "src/proto_unix.c" and
"src/cfgfile.c"; Linux, "input/event-codes.rst".
"""

from __future__ import annotations

import asyncio
import fcntl
import socket
import stat
import struct
from pathlib import Path

from woz_drivers.hands.device_models import MOST_BUTTONS, SPACEMOUSE
from woz_drivers.hands.hand_device import HandDevice
from woz_drivers.hands.record_reader import RecordReader, open_device
from woz_tui.drivers.contract import DeviceLostError

#: Where spacenavd listens: of today, and of before /run.
SOCKETS = (Path("/run/spnav.sock"), Path("/var/run/spnav.sock"))
#: Of spacenavd's protocol 0: a type, six axes, the time since the last one. Of a button its number.
SPACENAV_RECORD = struct.Struct("=8i")
MOTION, PRESS, RELEASE = 0, 1, 2
#: What spacenavd makes of a whole push, unless its sensitivity is set otherwise.
SPACENAV_FULL = 500
_SPACENAV_AXES = ("push-x", "push-y", "push-z", "turn-x", "turn-y", "turn-z")

#: struct input_event: seconds, microseconds, type, code, value.
EVENT_RECORD = struct.Struct("@llHHi")
SYN, KEY, REL, ABS = 0, 1, 2, 3
SYN_DROPPED = 3
_ABS_INFO, _ABS_SIZE = 0x80184540, 24
_FIRST_BUTTON = 0x100
#: The farthest that a whole push goes where the kernel does not say it.
EVENT_FULL = 350
#: The same of REL and ABS: x, y towards the hand, z down, and the turns about them, as spacenavd
#: turns them round.
_EVENT_AXES = (
    *(("push-x", 1), ("push-z", -1), ("push-y", -1)),
    *(("turn-x", 1), ("turn-z", -1), ("turn-y", -1)),
)
#: A mouse that tells its place by REL says nothing at rest: so long after the last word, in
#: seconds, an axis is there.
REST_S = 0.1


def present_socket() -> str:
    """Where spacenavd listens; empty: nowhere."""
    return next((str(path) for path in SOCKETS if is_socket(str(path))), "")


def is_socket(path: str) -> bool:
    """Whether a program listens there, or did."""
    try:
        return stat.S_ISSOCK(Path(path).stat().st_mode)
    except OSError:
        return False


class _SpaceMouse(HandDevice):
    """What both ways have in common."""

    _reader: RecordReader

    def __init__(self, name: str, path: str) -> None:
        super().__init__(SPACEMOUSE, name, path)

    def close(self) -> None:
        """Let go of it."""
        self._reader.close()

    def _push(self, axis: str, share: float) -> None:
        self.move(axis, round(min(max(share, -1.0), 1.0), 2) + 0.0)

    def _press(self, number: int, down: bool) -> None:
        """A button, from 0."""
        if 0 <= number < MOST_BUTTONS:
            self.move(f"button-{number + 1}", float(down))

    def _ended(self) -> None:
        self.on_lost("unplugged")


class SpacenavMouse(_SpaceMouse):
    """One that spacenavd reads. Raises `DeviceLostError` if spacenavd does not answer."""

    def __init__(self, path: str) -> None:
        super().__init__("6-D mouse of spacenavd", path)
        line = socket.socket(socket.AF_UNIX)
        try:
            line.connect(path)
        except OSError as error:
            line.close()
            remedy = "sudo systemctl restart spacenavd"
            raise DeviceLostError(f"spacenavd: {path}: {error.strerror}", remedy) from error
        line.setblocking(False)
        self._reader = RecordReader(line.detach(), SPACENAV_RECORD, self._take, self._ended)

    def _take(self, record: tuple[int, ...]) -> None:
        kind, *fields = record
        if kind == MOTION:
            for axis, value in zip(_SPACENAV_AXES, fields, strict=False):
                self._push(axis, value / SPACENAV_FULL)
        elif kind in (PRESS, RELEASE):
            self._press(fields[0], kind == PRESS)


class EventMouse(_SpaceMouse):
    """One that nobody else reads. Raises `DeviceLostError` if it cannot be opened."""

    def __init__(self, path: str, name: str) -> None:
        super().__init__(name or Path(path).name, path)
        fd = open_device(path)
        self._spans = [_span(fd, code) for code in range(len(_EVENT_AXES))]
        self._resting: dict[str, asyncio.TimerHandle] = {}
        self._reader = RecordReader(fd, EVENT_RECORD, self._take, self._ended)

    def close(self) -> None:
        """Let go of it."""
        for timer in self._resting.values():
            timer.cancel()
        super().close()

    def _take(self, record: tuple[int, ...]) -> None:
        _, _, kind, code, value = record
        if kind == KEY:
            self._press(code - _FIRST_BUTTON, bool(value))
        elif kind in (REL, ABS) and code < len(_EVENT_AXES):
            axis, sign = _EVENT_AXES[code]
            low, high = self._spans[code] if kind == ABS else (-EVENT_FULL, EVENT_FULL)
            self._push(axis, sign * (2 * (value - low) / (high - low) - 1))
            if kind == REL:
                self._let_rest(axis)
        elif kind == SYN and code == SYN_DROPPED:  # something was lost: what, nobody knows
            for name in list(self.held):
                self.move(name, 0.0)

    def _let_rest(self, axis: str) -> None:
        if axis in self._resting:
            self._resting[axis].cancel()
        loop = asyncio.get_running_loop()
        self._resting[axis] = loop.call_later(REST_S, self.move, axis, 0.0)


def _span(fd: int, code: int) -> tuple[int, int]:
    """The ends of an axis by EVIOCGABS, or the usual ones."""
    try:
        reply = fcntl.ioctl(fd, _ABS_INFO + code, bytes(_ABS_SIZE))
    except OSError:
        return -EVENT_FULL, EVENT_FULL
    _, low, high, *_ = struct.unpack("=6i", reply)
    return (low, high) if low < high else (-EVENT_FULL, EVENT_FULL)
