"""The face of lights: its very firmware, compiled for this machine, on a pseudo-terminal."""

from __future__ import annotations

import asyncio
import ctypes
import functools
import subprocess
import tempfile
from pathlib import Path

from tests.fakes.rangefinder import PluggedSensor
from woz_tui.motion.light_frames import LightFrame

ROOT = Path(__file__).parents[2]
SKETCH = ROOT / "drivers" / "firmware" / "led_face"
#: Undefined behaviour and indices out of range end the program, and so fail the test.
COMPILE = (
    *("g++", "-std=c++11", "-O1", "-Wall", "-Wextra", "-Werror", f"-I{SKETCH}"),
    *("-fsanitize=undefined,bounds", "-fsanitize-undefined-trap-on-error"),
)
_ROOM = 1 << 16


@functools.cache
def firmware() -> ctypes.CDLL:
    """The compiled firmware; the file may go once it is loaded."""
    with tempfile.TemporaryDirectory() as folder:
        library = Path(folder) / "led_face.so"
        source = Path(__file__).with_name("led_face_device.cpp")
        command = [*COMPILE, "-shared", "-fPIC", "-o", str(library), str(source)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        loaded = ctypes.CDLL(str(library))
    loaded.device_new.restype = ctypes.c_void_p
    loaded.device_crc16.restype = ctypes.c_uint16
    return loaded


def crc16(data: bytes) -> int:
    """The firmware's CRC."""
    return int(firmware().device_crc16(data, ctypes.c_uint16(len(data))))


def unstuffed(data: bytes) -> bytes | None:
    """What the firmware takes out of COBS; None if it says that it is none."""
    buffer = ctypes.create_string_buffer(data, max(1, len(data)))
    size = int(firmware().device_unstuff(buffer, ctypes.c_uint16(len(data))))
    return None if size < 0 else buffer.raw[:size]


def ht1632_tape(picture: bytes, brightness: int, *, blocks: bool) -> bytes:
    """What happens on the pins of an HT1632: 0 and 1 are bits, 2 chosen, 3 released."""
    out = ctypes.create_string_buffer(_ROOM)
    size = firmware().ht1632_tape(blocks, picture, ctypes.c_uint8(brightness), out, _ROOM)
    return out.raw[:size]


def max7219_tape(
    picture: bytes, brightness: int, *, from_right: bool, winding: bool, mirrored: bool
) -> bytes:
    """The same for a chain of 3 x 2 MAX7219."""
    out = ctypes.create_string_buffer(_ROOM)
    size = firmware().max7219_tape(
        from_right, winding, mirrored, picture, ctypes.c_uint8(brightness), out, _ROOM
    )
    return out.raw[:size]


class Board:
    """One board with the firmware on it."""

    def __init__(self, width: int = 24, height: int = 16) -> None:
        self.size = (width, height)
        made = firmware().device_new(width, height)
        assert made, f"led_face_device.cpp has no {width} x {height}"
        self._device = ctypes.c_void_p(made)

    def __del__(self) -> None:
        if hasattr(self, "_device"):
            firmware().device_free(self._device)

    def take(self, data: bytes) -> bytes:
        """Its answer to these bytes."""
        firmware().device_take(self._device, data, len(data))
        return self._answers()

    def introduce(self) -> bytes:
        """What it says when it starts."""
        firmware().device_introduce(self._device)
        return self._answers()

    def _answers(self) -> bytes:
        out = ctypes.create_string_buffer(_ROOM)
        size = firmware().device_answers(self._device, out, _ROOM)
        return out.raw[:size]

    @property
    def picture(self) -> bytes:
        """Bytes of the picture it shows; none before the first."""
        out = ctypes.create_string_buffer(_ROOM)
        size = firmware().device_picture(self._device, out, _ROOM)
        return out.raw[:size]

    @property
    def frame(self) -> LightFrame | None:
        """The picture it shows, light by light."""
        width, height = self.size
        picture, size = self.picture, (width + 7) // 8
        if not picture:
            return None
        rows = (picture[row * size : (row + 1) * size] for row in range(height))
        return LightFrame(
            width, tuple(int.from_bytes(row, "big") >> (size * 8 - width) for row in rows)
        )

    @property
    def brightness(self) -> int:
        """Of the picture it shows, 0..255."""
        return int(firmware().device_brightness(self._device))

    @property
    def frames(self) -> int:
        """How many frames it has shown."""
        return int(firmware().device_frames(self._device))


class PluggedFace(PluggedSensor):
    """A board on a serial adapter, served by the running event loop.

    Attributes:
        board: What is at the other end of the cable.
        mute: It hears and shows, but its answers are lost.
        hello: What it answers instead of its own answers, if set.
        noise: What comes over the cable in front of each answer.
        heard: All bytes that came.
    """

    def __init__(self, port: Path, board: Board | None = None) -> None:
        self.board = board or Board()
        self.mute = False
        self.hello: bytes | None = None
        self.noise = b""
        self.heard = b""
        super().__init__(port)

    def plug(self) -> None:
        """Put the cable in."""
        super().plug()
        assert self._ends is not None
        asyncio.get_running_loop().add_reader(self._ends[0], self._serve)

    def unplug(self) -> None:
        """Pull the cable."""
        if self._ends is not None:
            asyncio.get_running_loop().remove_reader(self._ends[0])
        super().unplug()

    def reset(self) -> None:
        """It starts anew, dark, and says who it is."""
        self.board = Board(*self.board.size)
        self.send(self.board.introduce())

    def grow_strange(self) -> None:
        """It answers like something else from now on."""
        self.hello = b"\x00what is this\x00"

    def _serve(self) -> None:
        data = self.received()
        self.heard += data
        answers = self.board.take(data)
        if self.hello is not None:
            answers = self.hello if answers else b""
        if answers and not self.mute:
            self.send(self.noise + answers)
