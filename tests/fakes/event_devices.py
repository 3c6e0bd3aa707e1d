"""Devices of Linux's event interface on pseudo-terminals, with the system's list of them."""

from __future__ import annotations

import fcntl
import os
import struct
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from woz_drivers.hands import event_listing, gamepad, spacemouse

from tests.fakes.plugged_device import PluggedDevice

RECORD = struct.Struct("@llHHi")
KEY, REL, ABS = 1, 2, 3


class EventDevicePort(PluggedDevice):
    """One event device; what it says is followed by a report's end, as from the kernel."""

    def say(self, *events: tuple[int, int, int]) -> None:
        """Type, code and value of each."""
        for event in (*events, (0, 0, 0)):
            self.send(RECORD.pack(0, 0, *event))


class InputDevices:
    """What is plugged in: /dev/input, /sys/class/input, and what the kernel says of an axis.

    Args:
        spans: The ends of each absolute axis, by its code; none: it has no such axes.
    """

    def __init__(
        self,
        folder: Path,
        patch: pytest.MonkeyPatch,
        spans: Mapping[int, tuple[int, int]] | None = None,
    ) -> None:
        self._dev, self._sysfs = folder / "dev", folder / "sys"
        self._dev.mkdir()
        self._sysfs.mkdir()
        self._spans = spans or {}
        self._ports: list[EventDevicePort] = []
        patch.setattr(event_listing, "DEV", self._dev)
        patch.setattr(event_listing, "SYSFS", self._sysfs)
        patch.setattr(gamepad, "DEV", self._dev)
        patch.setattr(spacemouse, "SOCKETS", ())
        patch.setattr(fcntl, "ioctl", self._ioctl)

    def plug(self, name: str, hardware: str = "1") -> EventDevicePort:
        """One more, with the next number."""
        number = len(self._ports)
        listed = self._sysfs / f"event{number}" / "device"
        listed.mkdir(parents=True)
        (listed / "name").write_text(name + "\n")
        (listed / "device").symlink_to(self._sysfs / f"hardware-{hardware}")
        port = EventDevicePort(self._dev / f"event{number}")
        self._ports.append(port)
        return port

    def unplug(self) -> None:
        """All of them."""
        for port in self._ports:
            port.unplug()

    def _ioctl(self, fd: int, request: int, argument: Any = 0, *_: Any) -> Any:
        low, high = self._spans.get(request - 0x80184540, (0, 0))
        if not os.isatty(fd) or low == high:
            raise OSError(25, "Inappropriate ioctl for device")
        return struct.pack("=6i", 0, low, high, 0, 0, 0)
