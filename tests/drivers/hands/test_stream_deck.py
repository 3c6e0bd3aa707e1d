"""A Stream Deck at the level of its reports: the library is the real one, its USB is not."""

from __future__ import annotations

import asyncio
import io
import queue
from typing import Any

import pytest
from PIL import Image
from StreamDeck.Devices.StreamDeckOriginalV2 import StreamDeckOriginalV2
from StreamDeck.Transport.Dummy import Dummy
from StreamDeck.Transport.Transport import TransportError
from woz_drivers.hands import stream_deck
from woz_drivers.hands.device_watch import DeviceWatch
from woz_drivers.hands.hand_device import HandDevice, KeyFace
from woz_drivers.hands.stream_deck import StreamDeckKeys, find_decks

from tests.drivers.published_messages import until
from woz_tui.drivers.contract import DeviceLostError

KEYS = 15


class Usb(Dummy.Device):  # type: ignore[misc]
    """A Stream Deck of 15 keys: input reports out of a queue, pictures put together of reports."""

    def __init__(self) -> None:
        super().__init__(0x0FD9, 0x006D)
        self.reports: queue.Queue[bytes | None] = queue.Queue()
        self.pictures: dict[int, bytes] = {}
        self.sent = 0
        self._parts: dict[int, bytes] = {}

    def press(self, *keys: int) -> None:
        """Exactly these are down, counted from 1."""
        states = bytes(number in keys for number in range(1, KEYS + 1))
        self.reports.put(bytes((1, 0, KEYS, 0)) + states)

    def unplug(self) -> None:
        self.reports.put(None)

    def read(self, length: int) -> bytes | None:
        if not self.is_open():  # which ends the library's thread
            raise TransportError("no such device")
        try:
            report = self.reports.get_nowait()
        except queue.Empty:
            return None
        if report is None:
            raise TransportError("no such device")
        return report.ljust(length, b"\0")

    def write(self, payload: Any) -> bool:
        if bytes(payload[:2]) == b"\x02\x07":
            key, last, size = payload[2], payload[3], payload[4] | payload[5] << 8
            self._parts[key] = self._parts.get(key, b"") + bytes(payload[8 : 8 + size])
            if last:
                self.sent += 1
                self.pictures[key + 1] = self._parts.pop(key)
        return True

    def colour(self, key: int) -> tuple[int, int, int]:
        """The colour in a corner of what a key shows."""
        picture = Image.open(io.BytesIO(self.pictures[key])).convert("RGB")
        pixel = picture.getpixel((2, 2))
        assert isinstance(pixel, tuple)
        return pixel[0], pixel[1], pixel[2]


async def deck() -> tuple[Usb, HandDevice, DeviceWatch]:
    """A deck that has been found."""
    usb = Usb()
    found: list[HandDevice] = []
    watch = DeviceWatch(find_decks=lambda: [StreamDeckOriginalV2(usb)])
    watch.on_found = found.append
    await watch.look({"stream-deck"})
    return usb, found[0], watch


async def test_keys_are_pressed_and_let_go() -> None:
    usb, device, _ = await deck()
    usb.press(1, 15)
    await until(lambda: device.held == {"key-1": 1.0, "key-15": 1.0})
    usb.press(15)
    await until(lambda: device.held == {"key-15": 1.0})
    usb.press()
    await until(lambda: device.held == {})
    device.close()


async def test_keys_show_states_and_only_changes_are_sent() -> None:
    usb, device, _ = await deck()
    faces = {"key-1": KeyFace("Hello"), "key-3": KeyFace("STOP", "stop")}
    device.show(faces)
    await until(lambda: {1, 3} <= usb.pictures.keys())
    red, green, blue = usb.colour(3)
    assert red > 150 > green + blue
    sent = usb.sent
    device.show({**faces, "key-1": KeyFace("Hello", "running", "3.2 s")})
    await until(lambda: usb.sent == sent + 1)
    red, green, blue = usb.colour(1)
    assert blue > red + green
    device.show({"key-3": faces["key-3"]})
    await until(lambda: usb.sent == sent + 2)
    assert max(usb.colour(1)) < 40, "a key that is not named any more is dark"
    device.close()


async def test_a_deck_that_is_pulled_out_holds_nothing_and_is_found_again() -> None:
    usb, device, watch = await deck()
    gone: list[str] = []
    device.on_gone = lambda: gone.append(device.name)
    usb.press(2)
    await until(lambda: device.held == {"key-2": 1.0})
    usb.unplug()
    await until(lambda: not usb.is_open())
    await watch.look({"stream-deck"})
    assert len(gone) == 1
    assert device.held == {}
    [again] = watch.devices
    usb.press(4)
    await until(lambda: again.held == {"key-4": 1.0})
    again.close()


@pytest.mark.parametrize("label", ["", "a", "x" * 500, "日本語 ー", "a b\nc \x00", "🎉" * 40])
def test_any_label_can_be_drawn(label: str) -> None:
    for state in ("", "running", "no such state"):
        stream_deck.draw_face(Image.new("RGB", (72, 72)), KeyFace(label, state, "99.9 s"))


async def test_a_missing_library_is_told_once_with_what_to_install() -> None:
    troubles: list[tuple[str, str]] = []

    def missing() -> list[Any]:
        raise DeviceLostError("the package streamdeck is missing", "pip install")

    watch = DeviceWatch(find_decks=missing)
    watch.on_trouble = lambda what, remedy: troubles.append((what, remedy))
    await watch.look()
    await watch.look()
    assert troubles == [("the package streamdeck is missing", "pip install")]


def test_without_the_extra_a_sentence_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(__import__("sys").modules, "StreamDeck.DeviceManager", None)
    with pytest.raises(DeviceLostError) as error:
        find_decks()
    assert "woz-tui[hands]" in error.value.remedy


async def test_a_deck_in_use_is_told() -> None:
    usb = Usb()

    def busy() -> None:
        raise TransportError("Could not open HID device.")

    usb.open = busy
    with pytest.raises(DeviceLostError, match="cannot be opened"):
        StreamDeckKeys(StreamDeckOriginalV2(usb))
    await asyncio.sleep(0)
