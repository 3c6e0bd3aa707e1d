"""A device on a pseudo-terminal, with a cable to pull."""

from __future__ import annotations

import os
import pty
import tty
from pathlib import Path


class PluggedDevice:
    """Something that is plugged in at `port`: a lasting name, as under /dev/serial/by-id."""

    def __init__(self, port: Path) -> None:
        self.port = port
        self._ends: tuple[int, int] | None = None
        self.plug()

    def plug(self) -> None:
        """Put the cable in: the name appears, pointing at a new device."""
        device_end, computer_end = pty.openpty()
        tty.setraw(computer_end)
        os.set_blocking(device_end, False)
        self._ends = (device_end, computer_end)
        self.port.symlink_to(os.ttyname(computer_end))

    def unplug(self) -> None:
        """Pull the cable: the name goes, and whoever has the device open is cut off."""
        if self._ends is not None:
            for end in self._ends:
                os.close(end)
            self._ends = None
            self.port.unlink()

    def send(self, data: bytes) -> None:
        """The device says `data`."""
        assert self._ends is not None, "the cable is out"
        os.write(self._ends[0], data)
