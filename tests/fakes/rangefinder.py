"""Rangefinders on a pseudo-terminal: frames as the data sheets draw them, a cable to pull."""

from __future__ import annotations

import fcntl
import os
import pty
import sys
import termios
import tty
from pathlib import Path


class PluggedSensor:
    """A sensor on a serial adapter. `port` is its lasting name, as under /dev/serial/by-id."""

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
        """The sensor says `data`."""
        assert self._ends is not None, "the cable is out"
        os.write(self._ends[0], data)

    def unread(self) -> int:
        """How many bytes the computer has not fetched yet."""
        assert self._ends is not None, "the cable is out"
        waiting = fcntl.ioctl(self._ends[1], termios.FIONREAD, bytes(4))
        return int.from_bytes(waiting, sys.byteorder)

    def received(self) -> bytes:
        """What the computer sent since the last call."""
        assert self._ends is not None, "the cable is out"
        try:
            return os.read(self._ends[0], 65536)
        except BlockingIOError:
            return b""


def maxbotix(number: int, digits: int = 3) -> bytes:
    """`Rddd` and a carriage return."""
    return b"R%0*d\r" % (digits, number)


def tfmini(centimetres: int, strength: int = 1000, temperature: int = 2500) -> bytes:
    """Nine bytes: 59 59, distance, strength and temperature low byte first, sum."""
    body = b"\x59\x59" + b"".join(
        value.to_bytes(2, "little") for value in (centimetres, strength, temperature)
    )
    return body + bytes([sum(body) % 256])


def a02(millimetres: int) -> bytes:
    """Four bytes: FF, distance high byte first, sum."""
    body = b"\xff" + millimetres.to_bytes(2, "big")
    return body + bytes([sum(body) % 256])
