"""Writes camera pictures as PNG files."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

from woz_drivers import picture_files
from woz_tui.protocol.camera_pictures import Picture


def keep(folder: Path, name: str, picture: Picture) -> Path:
    """Write a picture into `folder` as `picture_files.keep` does; for threads."""
    content = png(picture.width, picture.height, picture.rgb)
    return picture_files.keep(folder, name, ".png", content)


# -- PNG -------------------------------------------------------------------------------------------
# W3C, "Portable Network Graphics", third edition: 8 bits a colour.

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
#: Colour type 2 is red, green, blue; no interlacing, no filter on any row.
_BITS, _RGB = 8, 2


def png(width: int, height: int, rgb: bytes) -> bytes:
    """A whole file for `height` rows of `width` pixels of three bytes.

    Raises `ValueError` if the bytes are not that many, or there is no pixel at all.
    """
    row = 3 * width
    if width < 1 or height < 1 or len(rgb) != row * height:
        raise ValueError(f"{len(rgb)} bytes are no picture of {width} x {height}")
    rows = b"".join(b"\0" + rgb[start : start + row] for start in range(0, len(rgb), row))
    header = struct.pack(">IIBBBBB", width, height, _BITS, _RGB, 0, 0, 0)
    chunks = _chunk(b"IHDR", header), _chunk(b"IDAT", zlib.compress(rows, 6)), _chunk(b"IEND", b"")
    return _SIGNATURE + b"".join(chunks)


def _chunk(name: bytes, body: bytes) -> bytes:
    check = zlib.crc32(name + body)
    return struct.pack(">I", len(body)) + name + body + struct.pack(">I", check)
