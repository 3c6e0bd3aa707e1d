"""Unpacks pictures and fits them into cells."""

from __future__ import annotations

import base64
import binascii
import zlib
from dataclasses import dataclass

from woz_tui.config.screen_language import say
from woz_tui.protocol.camera_pictures import PictureShown

#: Width and height of a cell in pixels, where the terminal does not tell.
CELL = (8, 16)


class PictureError(ValueError):
    """A picture is damaged."""


@dataclass(frozen=True, slots=True)
class CellArea:
    """Cells that a picture takes, and the size of a cell in pixels."""

    columns: int
    rows: int
    cell: tuple[int, int] = CELL

    @property
    def pixels(self) -> tuple[int, int]:
        """Width and height in the terminal's pixels."""
        return self.columns * self.cell[0], self.rows * self.cell[1]


def area_for(width: int, height: int, within: CellArea) -> CellArea:
    """The largest part of `within` with the proportions of `width` x `height` pixels."""
    most_wide, most_high = within.pixels
    scale = min(most_wide / width, most_high / height)
    columns = round(width * scale / within.cell[0])
    rows = round(height * scale / within.cell[1])
    return CellArea(
        max(1, min(columns, within.columns)), max(1, min(rows, within.rows)), within.cell
    )


def shrunk_size(width: int, height: int, pixels: float) -> tuple[int, int]:
    """`width` x `height` pixels in their proportions, about `pixels` of them; 16 x 12 at least."""
    scale = min(1.0, (pixels / (width * height)) ** 0.5)
    return max(min(16, width), int(width * scale)), max(min(12, height), int(height * scale))


def unpacked(shown: PictureShown) -> bytes:
    """The pixels of an `rgb` picture, rows from the top. Raises `PictureError`."""
    size = shown.width * shown.height * 3
    unpacker = zlib.decompressobj()
    try:
        rgb = unpacker.decompress(base64.b64decode(shown.data, validate=True), size + 1)
    except (zlib.error, binascii.Error, ValueError) as error:
        raise PictureError(
            say("camera.unreadable", "the picture cannot be read: {error}", error=error)
        ) from error
    if len(rgb) != size or size <= 0:
        raise PictureError(
            say(
                "camera.wrong_size",
                "the picture has {length} bytes instead of {size}",
                length=len(rgb),
                size=size,
            )
        )
    return rgb


def resized(rgb: bytes, width: int, height: int, columns: int, rows: int) -> bytes:
    """`width` x `height` pixels as `columns` x `rows`: repeated, or left out."""
    if (width, height) == (columns, rows):
        return rgb
    places = [3 * (x * width // columns) for x in range(columns)]
    stride = 3 * width
    lines: dict[int, bytes] = {}
    out = []
    for y in range(rows):
        source = y * height // rows
        if source not in lines:
            line = rgb[source * stride : (source + 1) * stride]
            lines[source] = b"".join([line[at : at + 3] for at in places])
        out.append(lines[source])
    return b"".join(out)
