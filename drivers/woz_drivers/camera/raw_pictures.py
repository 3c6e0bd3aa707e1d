"""Raw pictures: bytes as a program writes them, to arrays of red, green and blue."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

#: A picture: shape (rows, columns, 3), red, green, blue, 0 to 255.
Picture = npt.NDArray[np.uint8]
#: One number a pixel: shape (rows, columns), 0 to 255.
Plane = npt.NDArray[np.uint8]
#: Rows or columns of pixels, and colours from 0 to 1.
Places = npt.NDArray[np.intp]
Colours = npt.NDArray[np.float32]

#: How pictures may come. rgb24 and bgr24: three bytes a pixel. yuv420: all brightness, then two
#: planes of colour with half as many rows and columns (I420, what rpicam-vid calls yuv420 and
#: ffmpeg yuv420p).
FORMATS = ("rgb24", "bgr24", "yuv420")
#: Larger pictures are looked at in every second, third ... row and column: it saves time, and
#: changes the middle of what is found by less than a pixel.
WIDEST, HIGHEST = 160, 120


def thinning_step(columns: int, rows: int) -> int:
    """Of how many rows and columns one is looked at."""
    return max(1, -(-columns // WIDEST), -(-rows // HIGHEST))


@dataclass(frozen=True, slots=True)
class PictureLayout:
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
            bright, u, v = self._planes(np.frombuffer(data, np.uint8))
            step, half = self.thinned, self.thinned // 2
            return _colours(bright[::step, ::step], u[::half, ::half], v[::half, ::half])
        rows = np.frombuffer(data, np.uint8).reshape(self.height, self.stride)
        picture = rows[:, : 3 * self.width].reshape(self.height, self.width, 3)
        return picture[:, :, ::-1] if self.format == "bgr24" else picture

    def for_people(self, data: bytes, widest: int) -> Picture:
        """One picture for people, about `widest` pixels wide: every second, third ... row and
        column where it is at least twice as wide. Colours of yuv420 count for two by two pixels.
        """
        step = max(1, self.width // max(1, widest))
        if self.format != "yuv420":
            return self.decode(data)[::step, ::step]
        planes = np.frombuffer(data, np.uint8)
        bright, u, v = self._planes(planes)
        rows = np.arange(0, self.height, step)
        columns = np.arange(0, self.width, step)
        u, v = (plane[rows // 2][:, columns // 2] for plane in (u, v))
        return _colours(bright[::step, ::step], u, v)

    def planes(self, data: bytes) -> tuple[Plane, ...]:
        """One picture of `size` bytes as `colours_at` wants it, nothing computed."""
        if self.format == "yuv420":
            return self._planes(np.frombuffer(data, np.uint8))
        return (self.decode(data),)

    def colours_at(self, planes: tuple[Plane, ...], rows: Places, columns: Places) -> Colours:
        """Red, green and blue from 0 to 1 of these pixels, along a new last axis."""
        if self.format != "yuv420":
            found: Colours = planes[0][rows, columns].astype(np.float32)
            found *= np.float32(1 / 255)
            return found
        bright, u, v = planes
        half_rows, half_columns = rows >> 1, columns >> 1
        y = bright[rows, columns], u[half_rows, half_columns], v[half_rows, half_columns]
        found = np.stack(_red_green_blue(*y), axis=-1)
        found *= np.float32(1 / 255)
        return np.clip(found, 0.0, 1.0, out=found)

    @property
    def thinned(self) -> int:
        """Of how many rows and columns of a picture `decode` keeps one."""
        if self.format != "yuv420":
            return 1
        return 2 * thinning_step(self._half_width, self._half_height)

    @property
    def _half_width(self) -> int:
        return (self.width + 1) // 2

    @property
    def _half_stride(self) -> int:
        return (self.stride + 1) // 2

    @property
    def _half_height(self) -> int:
        return (self.height + 1) // 2

    def _planes(self, data: Plane) -> tuple[Plane, Plane, Plane]:
        """Brightness, and the two of colour with half as many rows and columns."""
        whole, rows = self.stride * self.height, self._half_height
        bright = data[:whole].reshape(self.height, self.stride)[:, : self.width]
        u, v = data[whole:].reshape(2, rows, self._half_stride)[:, :, : self._half_width]
        return bright, u, v


def _red_green_blue(bright: Plane, u: Plane, v: Plane) -> tuple[Colours, Colours, Colours]:
    """ITU-R BT.601 with limited range: what cameras' video is in. Not cut off at 0 and 255."""
    y = np.float32(1.164) * (bright.astype(np.float32) - np.float32(16))
    blue, red = u.astype(np.float32) - np.float32(128), v.astype(np.float32) - np.float32(128)
    return (
        y + np.float32(1.596) * red,
        y - np.float32(0.392) * blue - np.float32(0.813) * red,
        y + np.float32(2.017) * blue,
    )


def _colours(bright: Plane, u: Plane, v: Plane) -> Picture:
    planes = _red_green_blue(bright, u, v)
    picture: Picture = np.clip(np.rint(np.stack(planes, axis=-1)), 0, 255).astype(np.uint8)
    return picture
