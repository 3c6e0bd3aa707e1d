"""Pictures as DEC sixel sequences, the pixels of terminals since the VT240.

Six rows of pixels at a time are a band. In a band each colour that occurs in it draws all its
pixels from left to right, one character for six pixels one above the other (`?` and the six bits);
`$` goes back to the left, `-` on to the next band, `!9x` repeats `x` nine times.
Source: DEC STD 070, Video Systems Reference Manual, chapter 9.
"""

from __future__ import annotations

import re

import numpy as np

from woz_tui.host.colour_palette import COLOURS, Indices, Pixels, quantised

_BAND = 6
#: Four or more of one character are shorter when counted.
_RUN = re.compile(rb"(.)\1{3,}", re.DOTALL)
_BEGIN, _END = "\x1bP0;1;0q", "\x1b\\"


def sixels(pixels: Pixels, colours: int = COLOURS) -> str:
    """The sequence that draws `pixels`, shape (rows, columns, 3), at the cursor.

    The colours are the picture's own: the most common ones, merged until there are `colours`.
    """
    height, width = pixels.shape[:2]
    palette, drawn = quantised(pixels, colours)
    percent = np.rint(palette * (100 / 255)).astype(int)
    registers = (f"#{n};2;{r};{g};{b}" for n, (r, g, b) in enumerate(percent.tolist()))
    bands = (_band(drawn[top : top + _BAND]) for top in range(0, height, _BAND))
    return f'{_BEGIN}"1;1;{width};{height}{"".join(registers)}{"-".join(bands)}{_END}'


def _band(drawn: Indices) -> str:
    """At most six rows, shape (rows, columns): every colour that occurs, one line each."""
    present, places = np.unique(drawn, return_inverse=True)
    width = drawn.shape[1]
    bits = np.zeros((len(present), width), np.uint8)
    columns = np.arange(width)
    for row, line in enumerate(places.reshape(drawn.shape)):
        bits[line, columns] |= 1 << row
    signs = bits + np.uint8(63)
    lines = (
        f"#{colour}{_short(line.tobytes())}" for colour, line in zip(present, signs, strict=True)
    )
    return "$".join(lines)


def _short(signs: bytes) -> str:
    """A line's characters with repeats counted, without those at its end that draw nothing."""
    short = _RUN.sub(lambda run: b"!%d%b" % (len(run[0]), run[1]), signs.rstrip(b"?"))
    return short.decode("ascii")
