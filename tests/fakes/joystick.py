"""A gamepad as Linux's joystick interface has it: records of eight bytes, and a cable to pull."""

from __future__ import annotations

import struct

from tests.fakes.plugged_device import PluggedDevice

_BUTTONS = {
    name: number
    for number, name in enumerate(
        (
            *("south", "east", "west", "north", "left-bumper", "right-bumper"),
            *("select", "start", "home", "left-stick", "right-stick"),
        )
    )
}
_AXES = {
    name: number
    for number, name in enumerate(
        (
            *("left-stick-x", "left-stick-y", "left-trigger"),
            *("right-stick-x", "right-stick-y", "right-trigger", "hat-x", "hat-y"),
        )
    )
}


class Joystick(PluggedDevice):
    """An Xbox pad on a pseudo-terminal."""

    def press(self, *names: str) -> None:
        for name in names:
            self._send(1, 0x01, _BUTTONS[name])

    def let_go(self, *names: str) -> None:
        for name in names:
            self._send(0, 0x01, _BUTTONS[name])

    def push(self, name: str, share: float) -> None:
        """As the kernel counts: -1 is left and up, and a trigger that is not pulled."""
        self._send(round(share * 32767), 0x02, _AXES[name])

    def _send(self, value: int, kind: int, number: int) -> None:
        self.send(struct.pack("<IhBB", 0, value, kind, number))
