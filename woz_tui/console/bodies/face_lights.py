"""Draws a face: every light of its matrix, nothing else.

Half a cell a light where there is room, else eight lights a cell (braille). In ASCII half a cell
is a sign in its upper or lower part, and eight lights are a sign as dark as many of them are on.
"""

from __future__ import annotations

from woz_tui.console.drawing.cells import Row
from woz_tui.console.drawing.dot_canvas import ACROSS, DOWN, bit, braille
from woz_tui.console.drawing.glyphs import Glyphs
from woz_tui.motion.light_frames import LightFrame, blank
from woz_tui.protocol.messages import FaceShown

#: Upper and lower light of a cell: both out, upper, lower, both on.
_HALVES, _HALVES_ASCII = " ▀▄█", " '.#"
#: From none of a cell's eight lights to all of them.
_SHADES = " ...::++#"
#: Steps of brightness that look different.
LEVELS = 4


def size(width: int, height: int, *, compact: bool) -> tuple[int, int]:
    """Columns and lines that a matrix of lights takes."""
    across, down = (ACROSS, DOWN) if compact else (1, 2)
    return -(-width // across), -(-height // down)


def frame_of(shown: FaceShown | None, width: int, height: int) -> LightFrame:
    """The frame of a message; dark if there is none, or none that makes sense."""
    if shown is not None:
        try:
            return LightFrame.of_hex(shown.width, shown.rows)
        except (ValueError, OverflowError):
            pass
    return blank(width, height)


def brightness_look(brightness: float) -> str:
    """The look for a brightness of 0..1."""
    level = min(LEVELS, max(1, -int(-brightness * LEVELS // 1)))
    return f"face-{level}"


def light_rows(frame: LightFrame, glyphs: Glyphs, look: str, *, compact: bool) -> list[Row]:
    """The whole frame, `size` as large."""
    columns, lines = size(frame.width, frame.height, compact=compact)
    halves = _HALVES_ASCII if glyphs.ascii else _HALVES
    rows: list[Row] = []
    for y in range(lines):
        text = ""
        for x in range(columns):
            if compact:
                bits = 0
                for across in range(ACROSS):
                    for down in range(DOWN):
                        if _lit(frame, x * ACROSS + across, y * DOWN + down):
                            bits |= bit(across, down)
                text += _SHADES[bits.bit_count()] if glyphs.ascii else braille(bits)
            else:
                text += halves[_lit(frame, x, 2 * y) + 2 * _lit(frame, x, 2 * y + 1)]
        rows.append(((text, look),))
    return rows


def _lit(frame: LightFrame, column: int, row: int) -> bool:
    return column < frame.width and row < frame.height and frame.lit(column, row)
