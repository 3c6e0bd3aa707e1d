"""A MIDI panel on a pseudo-terminal: sends what hands do, remembers which lights are on."""

from __future__ import annotations

import os
import pty
import tty
from pathlib import Path


class MidiPanelFake:
    """Speaks as a Korg nanoKONTROL2 does. `port` is the device's name, as under /dev/snd."""

    def __init__(self, port: Path) -> None:
        self.port = port
        self.received = bytearray()
        self._ends: tuple[int, int] | None = None
        self.plug()

    def plug(self) -> None:
        """Put the cable in: the name appears, pointing at a new device."""
        panel_end, computer_end = pty.openpty()
        tty.setraw(computer_end)
        os.set_blocking(panel_end, False)
        self._ends = (panel_end, computer_end)
        self.received.clear()
        self.port.symlink_to(os.ttyname(computer_end))

    def unplug(self) -> None:
        """Pull the cable: the name goes, and whoever has the device open is cut off."""
        if self._ends is not None:
            for end in self._ends:
                os.close(end)
            self._ends = None
            self.port.unlink()

    def send(self, data: bytes) -> None:
        """Bytes from the panel."""
        assert self._ends is not None, "the cable is out"
        os.write(self._ends[0], data)

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
