"""Finds the devices of this computer, opens them, and finds them again."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable, Collection, Iterator
from typing import Any

from woz_drivers.hands.device_models import (
    DEVICES,
    GAMEPAD,
    IMU,
    SPACEMOUSE,
    STREAM_DECK,
    WII_REMOTE,
)
from woz_drivers.hands.event_listing import WII_ACCELEROMETER, EventDevice, present_event_devices
from woz_drivers.hands.gamepad import Gamepad, device_name, present_gamepads
from woz_drivers.hands.hand_device import HandDevice
from woz_drivers.hands.imu import Imu
from woz_drivers.hands.spacemouse import EventMouse, SpacenavMouse, is_socket, present_socket
from woz_drivers.hands.stream_deck import StreamDeckKeys, find_decks
from woz_drivers.hands.wii_remote import WiiRemote
from woz_tui.drivers.contract import DeviceLostError

#: How often devices are looked for, in seconds.
LOOK_S = 1.0


class DeviceWatch:
    """Devices as they are plugged in.

    Args:
        wanted: Paths, or parts of names, of those that count; none: all.
        find_decks: Finds Stream Decks; called in a thread.
    """

    def __init__(
        self, wanted: Collection[str] = (), find_decks: Callable[[], list[Any]] = find_decks
    ) -> None:
        self._wanted = tuple(wanted)
        self._find_decks = find_decks
        self.devices: list[HandDevice] = []
        #: Called for each device that has been found and opened; then it can be heard.
        self.on_found: Callable[[HandDevice], None] = lambda device: None
        #: Called once for each thing that is wrong, and what to do.
        self.on_trouble: Callable[[str, str], None] = lambda what, remedy: None
        self._troubles: set[str] = set()

    async def run(self, kinds: Collection[str] = DEVICES) -> None:
        """Look for devices of these kinds until cancelled; then all are let go."""
        try:
            while True:
                await self.look(kinds)
                await asyncio.sleep(LOOK_S)
        finally:
            for device in self.devices:
                device.close()

    async def look(self, kinds: Collection[str] = DEVICES) -> None:
        """Look once."""
        for device in list(self.devices):
            if isinstance(device, StreamDeckKeys) and not device.open:
                device.on_lost("unplugged")
        if SPACEMOUSE in kinds:
            self._look_for_spacenavd()
        if SPACEMOUSE in kinds or WII_REMOTE in kinds:
            self._look_for_event_devices(kinds)
        if IMU in kinds:
            for path in self._named(IMU):
                self._open(path, Imu, path)
        if GAMEPAD in kinds:
            self._look_for_gamepads()
        if STREAM_DECK in kinds:
            await self._look_for_decks()

    def _look_for_gamepads(self) -> None:
        listed = [path for path in present_gamepads() if self._fits(path, device_name(path))]
        for path in dict.fromkeys((*self._named(GAMEPAD), *listed)):
            self._open(path, Gamepad, path)

    def _look_for_spacenavd(self) -> None:
        there = present_socket()
        named = self._named(SPACEMOUSE)
        for path in named or ([there] if there and self._fits(there, "spacenavd") else []):
            self._open(path, SpacenavMouse, path)

    def _look_for_event_devices(self, kinds: Collection[str]) -> None:
        """What spacenavd reads, it has for itself."""
        by_spacenavd = any(isinstance(device, SpacenavMouse) for device in self.devices)
        listed = list(present_event_devices())
        for each in listed:
            kind = each.kind
            if kind not in kinds or not self._fits(each.path, each.name):
                continue
            if kind == SPACEMOUSE and not by_spacenavd:
                self._open(each.path, EventMouse, each.path, each.name)
            elif kind == WII_REMOTE:
                self._open(each.path, WiiRemote, each.name, each.path, _accelerometer(each, listed))

    def _named(self, kind: str) -> list[str]:
        """The paths that were asked for and are of this kind, as far as a path tells that."""
        return [path for path in self._wanted if "/" in path and _kind_of(path) == kind]

    def _open(self, path: str, make: Callable[..., HandDevice], *arguments: str) -> None:
        if not self._has(path):
            with self._trouble_told():
                self._add(make(*arguments))

    async def _look_for_decks(self) -> None:
        decks: list[Any] = []
        with self._trouble_told():
            decks = await asyncio.to_thread(self._find_decks)
        for deck in decks:
            path, name = str(deck.id()), str(deck.deck_type())
            if not self._has(path) and self._fits(path, name):
                with self._trouble_told():
                    self._add(StreamDeckKeys(deck))

    def _has(self, path: str) -> bool:
        return any(device.path == path for device in self.devices)

    def _fits(self, path: str, name: str) -> bool:
        if not self._wanted:
            return True
        return any(
            wanted == path or ("/" not in wanted and wanted.casefold() in name.casefold())
            for wanted in self._wanted
        )

    def _add(self, device: HandDevice) -> None:
        self.devices.append(device)
        device.on_lost = lambda why: self._drop(device)
        self.on_found(device)

    def _drop(self, device: HandDevice) -> None:
        if device in self.devices:
            self.devices.remove(device)
            device.close()
            device.held.clear()
            device.on_gone()

    @contextlib.contextmanager
    def _trouble_told(self) -> Iterator[None]:
        """What cannot be opened in here is left out, and told once."""
        try:
            yield
        except DeviceLostError as error:
            if error.what not in self._troubles:
                self._troubles.add(error.what)
                self.on_trouble(error.what, error.remedy)


def _kind_of(path: str) -> str:
    """By its name; what the kernel lists says itself what it is."""
    name = path.rpartition("/")[2]
    if is_socket(path):
        return SPACEMOUSE
    if name.startswith("event"):
        return ""
    serial = name.startswith("tty") or "/serial/" in path or "@" in name
    return IMU if serial else GAMEPAD


def _accelerometer(buttons: EventDevice, listed: Collection[EventDevice]) -> str:
    """That of the same Wii Remote."""
    return next(
        (
            each.path
            for each in listed
            if each.name == WII_ACCELEROMETER and each.hardware == buttons.hardware
        ),
        "",
    )
