"""Pictures in another size, with numpy: loaded when the first picture is asked for."""

from __future__ import annotations

import base64
import struct
import zlib

import numpy as np

from woz_tui.host.colour_palette import COLOURS, Pixels, quantised
from woz_tui.host.sixel import sixels
from woz_tui.protocol.camera_pictures import Picture, PictureFormat

#: Quick is better than small: on a picture the best level saves a twentieth and takes ten times as
#: long.
_LEVEL = 3


def fitting(width: int, height: int, most_width: int, most_height: int) -> tuple[int, int]:
    """The largest size with the proportions of `width` x `height` that fits, at least 1 x 1."""
    across = most_width * height <= most_height * width
    if across:
        return most_width, min(most_height, max(1, round(most_width * height / width)))
    return min(most_width, max(1, round(most_height * width / height))), most_height


def scaled(pixels: Pixels, width: int, height: int) -> Pixels:
    """`pixels` in a smaller size, each new pixel the mean of those it covers; a larger size repeats
    pixels.
    """
    rows, columns = pixels.shape[:2]
    if width > columns or height > rows:
        across = np.arange(width) * columns // width
        larger: Pixels = pixels[np.arange(height) * rows // height][:, across]
        return larger
    tops = np.arange(height) * rows // height
    lefts = np.arange(width) * columns // width
    # Columns first: what is left of the rows then is in one piece.
    sums = np.add.reduceat(np.add.reduceat(pixels, tops, 0, np.uint32), lefts, 1, np.uint32)
    high = np.diff(tops, append=rows).astype(np.uint32)
    wide = np.diff(lefts, append=columns).astype(np.uint32)
    counts = high[:, None, None] * wide[None, :, None]
    means: Pixels = ((sums + counts // 2) // counts).astype(np.uint8)
    return means


def encoded(
    picture: Picture, most_width: int, most_height: int, wanted: PictureFormat
) -> tuple[int, int, str]:
    """Width, height and data of `picture` as a `PictureShown` has them.

    A sixel picture fills the room, which costs few bytes more. The others are never larger than the
    camera's picture: whoever draws them can repeat pixels. Raises `ValueError` if the picture is
    not as large as it says.
    """
    size = picture.width * picture.height * 3
    if picture.width < 1 or picture.height < 1 or len(picture.rgb) != size:
        shape = f"{picture.width} x {picture.height}"
        raise ValueError(f"a picture of {shape} pixels has {len(picture.rgb)} bytes")
    pixels = np.frombuffer(picture.rgb, np.uint8).reshape(picture.height, picture.width, 3)
    width, height = fitting(picture.width, picture.height, most_width, most_height)
    if wanted == "sixel":
        return width, height, sixels(scaled(pixels, width, height))
    width, height = min(width, picture.width), min(height, picture.height)
    smaller = scaled(pixels, width, height)
    data = png(smaller) if wanted == "png" else zlib.compress(smaller.tobytes(), _LEVEL)
    return width, height, base64.b64encode(data).decode()


def png(pixels: Pixels, colours: int = COLOURS) -> bytes:
    """A PNG file in a palette of its own: a third of the bytes that all colours would need.

    Source: PNG specification, third edition, chapters 5, 9 and 11.
    """
    height, width = pixels.shape[:2]
    palette, drawn_in = quantised(pixels, colours)
    rows = np.zeros((height, width + 1), np.uint8)  # the first byte of a row: it is not filtered
    rows[:, 1:] = drawn_in
    head = struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0)
    parts = (
        (b"IHDR", head),
        (b"PLTE", np.rint(palette).astype(np.uint8).tobytes()),
        (b"IDAT", zlib.compress(rows.tobytes(), _LEVEL)),
        (b"IEND", b""),
    )
    return b"\x89PNG\r\n\x1a\n" + b"".join(_chunk(kind, data) for kind, data in parts)


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
