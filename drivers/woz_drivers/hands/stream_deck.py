"""A Stream Deck by the library `streamdeck`, which is imported only where one is wanted."""

from __future__ import annotations

import asyncio
import contextlib
import textwrap
from collections.abc import Mapping
from typing import Any

from woz_drivers.hands.device_models import MOST_DIALS, MOST_KEYS, STREAM_DECK
from woz_drivers.hands.hand_device import HandDevice, KeyFace
from woz_tui.drivers.contract import DeviceLostError
from woz_tui.system.extras import install_command

#: How often the library looks for pressed keys, in Hz; its own 20 would make a press 50 ms late.
_POLL_HZ = 100
_BRIGHTNESS = 60
#: State -> colour of the key, and of its words.
_COLOURS = {
    "": ("#202428", "#ffffff"),
    "ready": ("#202428", "#ffffff"),
    "running": ("#0b5cad", "#ffffff"),
    "queued": ("#3c4a5a", "#ffffff"),
    "done": ("#1f7a3a", "#ffffff"),
    "failed": ("#a01020", "#ffffff"),
    "refused": ("#8a5a00", "#ffffff"),
    "locked": ("#101214", "#6c747c"),
    "unreachable": ("#101214", "#6c747c"),
    "stop": ("#c00018", "#ffffff"),
    "stopped": ("#ffffff", "#c00018"),
}


def find_decks() -> list[Any]:
    """The Stream Decks that are plugged in, not opened. Raises `DeviceLostError` if nobody can
    look. It may take 100 ms: call it in a thread.
    """
    try:
        from StreamDeck.DeviceManager import DeviceManager, ProbeError  # noqa: PLC0415
    except ImportError as error:
        raise DeviceLostError(
            "a Stream Deck cannot be read: the package streamdeck is missing",
            install_command("hands"),
        ) from error
    try:
        return list(DeviceManager().enumerate())
    except ProbeError as error:
        raise DeviceLostError(
            "a Stream Deck cannot be read: the library hidapi is missing",
            "sudo apt install libhidapi-libusb0",
        ) from error


class StreamDeckKeys(HandDevice):
    """A Stream Deck that is open; its keys count from 1, row by row.

    Raises `DeviceLostError` if it cannot be opened.
    """

    def __init__(self, deck: Any) -> None:
        super().__init__(STREAM_DECK, str(deck.deck_type()), str(deck.id()))
        self._deck = deck
        self._loop = asyncio.get_running_loop()
        self._shown: dict[str, KeyFace] = {}
        self._wanted: dict[str, KeyFace] = {}
        self._drawing: asyncio.Task[None] | None = None
        try:
            deck.set_poll_frequency(_POLL_HZ)
            deck.open()
            deck.reset()
            with contextlib.suppress(Exception):
                deck.set_brightness(_BRIGHTNESS)
        except Exception as error:  # the library's own, or an operating system's
            raise DeviceLostError(
                f"{self.name} cannot be opened: {error}",
                "end other programs that use it, and see docs/how-to/hands.md for permissions",
            ) from error
        deck.set_key_callback(self._from_thread("key", MOST_KEYS))
        deck.set_dial_callback(self._dial)

    @property
    def open(self) -> bool:
        """Whether the library still reads it."""
        return bool(self._deck.is_open())

    def close(self) -> None:
        """Go dark and let go of it."""
        if self._drawing is not None:
            self._drawing.cancel()
        with contextlib.suppress(Exception):
            self._deck.reset()
        with contextlib.suppress(Exception):
            self._deck.close()

    def _from_thread(self, stem: str, most: int) -> Any:
        def pressed(deck: Any, index: int, state: bool) -> None:
            if index < most:
                with contextlib.suppress(RuntimeError):  # the loop has closed
                    name = f"{stem}-{index + 1}"
                    self._loop.call_soon_threadsafe(self.move, name, float(bool(state)))

        return pressed

    def _dial(self, deck: Any, index: int, event: Any, value: Any) -> None:
        if getattr(event, "name", "") == "PUSH":
            self._from_thread("dial", MOST_DIALS)(deck, index, bool(value))

    # -- faces ---------------------------------------------------------------------------------

    def show(self, faces: Mapping[str, KeyFace]) -> None:
        """Show these; only what is new is sent, the newest first served."""
        if not self._deck.is_visual():
            return
        self._wanted = {name: KeyFace(*face) for name, face in faces.items()}
        if self._drawing is None or self._drawing.done():
            self._drawing = self._loop.create_task(self._draw())

    async def _draw(self) -> None:
        """Send what has changed, key by key, until nothing is new."""
        while (name := self._next()) is not None:
            face = self._wanted.get(name, KeyFace(""))
            self._shown[name] = face
            try:
                await asyncio.to_thread(self._send, int(name.removeprefix("key-")) - 1, face)
            except Exception as error:  # noqa: BLE001 - the library's own, or a picture's
                if self.open:
                    self.on_lost(str(error))
                return

    def _next(self) -> str | None:
        count = int(self._deck.key_count())
        for number in range(1, count + 1):
            name = f"key-{number}"
            if self._wanted.get(name, KeyFace("")) != self._shown.get(name, KeyFace("")):
                return name
        return None

    def _send(self, index: int, face: KeyFace) -> None:
        from StreamDeck.ImageHelpers import PILHelper  # noqa: PLC0415

        picture = draw_face(PILHelper.create_key_image(self._deck), face)
        native = PILHelper.to_native_key_format(self._deck, picture)
        with self._deck:
            self._deck.set_key_image(index, native)


def draw_face(picture: Any, face: KeyFace) -> Any:
    """Draw a face into a Pillow image of a key: a colour for the state, the label, the note."""
    from PIL import ImageDraw, ImageFont  # noqa: PLC0415

    width, height = picture.size
    ground, words = _COLOURS.get(face.state, _COLOURS[""])
    if not face.label:
        return picture
    draw = ImageDraw.Draw(picture)
    draw.rectangle((0, 0, width, height), fill=ground)
    font = ImageFont.load_default(size=max(10, height // 6))
    lines = textwrap.wrap(face.label, 10)[:3]
    draw.multiline_text(
        (width / 2, height * (0.4 if face.note else 0.5)),
        "\n".join(lines),
        fill=words,
        font=font,
        anchor="mm",
        align="center",
    )
    if face.note:
        draw.text((width / 2, height * 0.86), face.note, fill=words, font=font, anchor="mm")
    return picture
