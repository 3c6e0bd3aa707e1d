"""A MIDI panel on a pseudo-terminal: sends what hands do, remembers which lights are on."""

from __future__ import annotations

import os
from pathlib import Path

from tests.fakes.plugged_device import PluggedDevice


class MidiPanelFake(PluggedDevice):
    """Speaks as a Korg nanoKONTROL2 does. `port` is the device's name, as under /dev/snd."""

    def __init__(self, port: Path) -> None:
        self.received = bytearray()
        super().__init__(port)

    def plug(self) -> None:
        """Put the cable in; what was sent before is forgotten."""
        self.received.clear()
        super().plug()

    def turn(self, number: int, *values: int, channel: int = 1) -> None:
        """A knob or slider passes through `values`, with running status as the real one sends."""
        body = b"".join(bytes((number, value)) for value in values)
        self.send(bytes((0xB0 | channel - 1,)) + body)

    def press(self, number: int, channel: int = 1) -> None:
        """A button goes down and comes up again."""
        self.turn(number, 127, 0, channel=channel)

    def hear(self) -> bytes:
        """All bytes that the computer sent since the cable was put in."""
        assert self._ends is not None, "the cable is out"
        while True:
            try:
                data = os.read(self._ends[0], 65536)
            except BlockingIOError:
                return bytes(self.received)
            self.received += data

    def lamps(self, channel: int = 16) -> set[int]:
        """Control numbers of the buttons whose lights are on now."""
        on: set[int] = set()
        data = self.hear()
        at = 0
        while at < len(data):
            if data[at] == 0xF0:
                at = data.index(0xF7, at) + 1
                continue
            assert data[at] == 0xB0 | channel - 1, data[at:].hex(" ")
            number, value = data[at + 1], data[at + 2]
            (on.add if value > 0x40 else on.discard)(number)
            at += 3
        return on
