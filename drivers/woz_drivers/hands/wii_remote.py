"""A Wii Remote by Linux's hid-wiimote, which makes an event device of its buttons and one of each
sensor.

Source: Linux, "drivers/hid/hid-wiimote-modules.c".
"""

from __future__ import annotations

import math

from woz_drivers.hands.device_models import WII_REMOTE
from woz_drivers.hands.hand_device import HandDevice
from woz_drivers.hands.record_reader import RecordReader, open_device
from woz_drivers.hands.spacemouse import ABS, EVENT_RECORD, KEY, SYN

_BUTTONS = {
    **{103: "up", 105: "left", 106: "right", 108: "down"},
    **{0x130: "a", 0x131: "b", 0x101: "one", 0x102: "two"},
    **{0x197: "plus", 0x19C: "minus", 0x13C: "home"},
}
#: The accelerometer's axes: to the side, along it, out of its face; about 100 is 1 g.
_SENSED = {3: "x", 4: "y", 5: "z"}
#: Below this it falls or is thrown, and nobody knows where down is.
_LEAST = 30
#: A tilt of so many degrees is the whole way.
FULL_DEG = 90


class WiiRemote(HandDevice):
    """Its buttons, and how it is tilted as far as it says that.

    Args:
        name: What it calls itself.
        path: Its buttons' device.
        accelerometer: Its accelerometer's; empty: it has none here.

    Raises `DeviceLostError` if it cannot be opened.
    """

    def __init__(self, name: str, path: str, accelerometer: str = "") -> None:
        super().__init__(WII_REMOTE, name, path)
        self._sensed = {"x": 0, "y": 0, "z": 0}
        paths = [path, *filter(None, (accelerometer,))]
        self._readers: list[RecordReader] = []
        try:
            for each in paths:
                reader = RecordReader(open_device(each), EVENT_RECORD, self._take, self._ended)
                self._readers.append(reader)
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Let go of it."""
        for reader in self._readers:
            reader.close()

    def _ended(self) -> None:
        self.on_lost("unplugged")

    def _take(self, record: tuple[int, ...]) -> None:
        _, _, kind, code, value = record
        if kind == KEY and code in _BUTTONS:
            self.move(_BUTTONS[code], float(bool(value)))
        elif kind == ABS and code in _SENSED:
            self._sensed[_SENSED[code]] = value
        elif kind == SYN and code == 0:
            self._tilt()

    def _tilt(self) -> None:
        x, y, z = self._sensed["x"], self._sensed["y"], self._sensed["z"]
        if math.hypot(x, y, z) < _LEAST:
            return
        self.move("tilt-x", _share(math.atan2(x, z)))
        self.move("tilt-y", _share(math.atan2(y, math.hypot(x, z))))


def _share(angle: float) -> float:
    return round(min(max(math.degrees(angle) / FULL_DEG, -1.0), 1.0), 2) + 0.0
