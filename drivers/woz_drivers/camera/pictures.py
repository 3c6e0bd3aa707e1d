"""Raw pictures: bytes as a program writes them, to arrays of red, green and blue."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

#: A picture: shape (rows, columns, 3), red, green, blue, 0 to 255.
Picture = npt.NDArray[np.uint8]

#: How pictures may come. rgb24 and bgr24: three bytes a pixel. yuv420: all brightness, then two
#: planes of colour with half as many rows and columns (I420, what rpicam-vid calls yuv420 and
#: ffmpeg yuv420p).
FORMATS = ("rgb24", "bgr24", "yuv420")
#: Larger pictures are looked at in every second, third ... row and column: it saves time, and
#: changes the middle of what is found by less than a pixel.
WIDEST, HIGHEST = 160, 120


def every(columns: int, rows: int) -> int:
    """Of how many rows and columns one is looked at."""
    return max(1, -(-columns // WIDEST), -(-rows // HIGHEST))


@dataclass(frozen=True, slots=True)
class Layout:
    """The shape of a raw picture: size in pixels; `stride` bytes from one row to the next."""

    width: int
    height: int
    format: str
    stride: int

    @property
    def size(self) -> int:
        """Bytes of one picture."""
        if self.format == "yuv420":
            return self.stride * self.height + 2 * self._half_stride * self._half_height
        return self.stride * self.height

    def decode(self, data: bytes) -> Picture:
        """One picture of `size` bytes. yuv420 comes out at half its size, as its colours are, and
        of a large one only every `thinned` pixel of these: the colours have to be computed.
        """
        if self.format == "yuv420":
            return self._of_planes(np.frombuffer(data, np.uint8))
        rows = np.frombuffer(data, np.uint8).reshape(self.height, self.stride)
        picture = rows[:, : 3 * self.width].reshape(self.height, self.width, 3)
        return picture[:, :, ::-1] if self.format == "bgr24" else picture

    @property
    def thinned(self) -> int:
        """Of how many rows and columns of a picture `decode` keeps one."""
        if self.format != "yuv420":
            return 1
        return 2 * every(self._half_width, self._half_height)

    @property
    def _half_width(self) -> int:
        return (self.width + 1) // 2

    @property
    def _half_stride(self) -> int:
        return (self.stride + 1) // 2

    @property
    def _half_height(self) -> int:
        return (self.height + 1) // 2

    def _of_planes(self, data: npt.NDArray[np.uint8]) -> Picture:
        """ITU-R BT.601 with limited range: what cameras' video is in."""
        whole, step = self.stride * self.height, self.thinned
        rows, columns = self._half_height, self._half_width
        bright = data[:whole].reshape(self.height, self.stride)[::step, : self.width : step]
        colours = data[whole:].reshape(2, rows, self._half_stride)
        colours = colours[:, :: step // 2, : columns : step // 2]
        y = 1.164 * (bright.astype(np.float32) - 16)
        u, v = colours.astype(np.float32) - 128
        planes = (y + 1.596 * v, y - 0.392 * u - 0.813 * v, y + 2.017 * u)
        picture: Picture = np.clip(np.rint(np.stack(planes, axis=-1)), 0, 255).astype(np.uint8)
        return picture


class Cutter:
    """Cuts a stream of bytes, however it is split, into pictures of `size` bytes."""

    def __init__(self, size: int, on_picture: Callable[[bytes], None]) -> None:
        self._size = size
        self._on_picture = on_picture
        self._pieces = bytearray()

    def feed(self, data: bytes) -> None:
        """Call `on_picture` for every picture that `data` completes."""
        self._pieces += data
        whole = len(self._pieces) // self._size * self._size
        for start in range(0, whole, self._size):
            self._on_picture(bytes(self._pieces[start : start + self._size]))
        del self._pieces[:whole]
