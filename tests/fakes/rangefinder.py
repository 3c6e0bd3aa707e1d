"""Rangefinders on a pseudo-terminal: frames as the data sheets draw them, a cable to pull."""

from __future__ import annotations

import fcntl
import os
import select
import sys
import termios

from tests.fakes.plugged_device import PluggedDevice


class PluggedSensor(PluggedDevice):
    """A sensor on a serial adapter."""

    def deliver(self, data: bytes) -> None:
        """`send`, and return when it has arrived. Only where nobody reads it meanwhile: bytes may
        be under way for a moment in which `unread` does not count them.
        """
        assert self._ends is not None, "the cable is out"
        self.send(data)
        if data:
            assert select.select([self._ends[1]], [], [], 10)[0], "it never arrived"

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
