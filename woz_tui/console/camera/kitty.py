"""Writes kitty's graphics protocol: pictures behind placeholders, characters that show them.

The picture is sent once, invisible; wherever the placeholder U+10EEEE stands the terminal draws
the part of the picture that belongs there. To Textual these are characters like all others: it
moves, covers and erases them, and with them the picture.
Source: https://sw.kovidgoyal.net/kitty/graphics-protocol/ ("Unicode placeholders").
"""

from __future__ import annotations

import unicodedata
from functools import cache

#: Does the terminal take pictures? One pixel, loaded and thrown away; the answer begins as
#: `scanner.GRAPHICS`.
QUESTION = "\x1b_Gi=31,s=1,v=1,a=q,t=d,f=24;AAAA\x1b\\"
PLACEHOLDER = "\U0010eeee"
#: Names of the two pictures that take turns, as colours of the 256: the next one comes while the
#: last one is still shown.
NAMES = (213, 214)
#: Bytes of a picture in one sequence.
CHUNK = 4096
#: A placeholder's row is a mark above it; so many there are.
MOST_ROWS = 132
#: Letters composed of marks lie below this code.
_LETTERS = 0x3100


def transmission(name: int, columns: int, rows: int, data: str) -> str:
    """Make the PNG file `data` (in base64) the picture `name`, in `columns` x `rows` cells."""
    chunks = [data[start : start + CHUNK] for start in range(0, len(data), CHUNK)] or [""]
    head = f"a=T,U=1,q=2,f=100,i={name},c={columns},r={rows},"
    last = len(chunks) - 1
    return "".join(
        f"\x1b_G{'q=2,' if number else head}m={int(number < last)};{chunk}\x1b\\"
        for number, chunk in enumerate(chunks)
    )


def deletion(*names: int) -> str:
    """Let go of pictures, and of the memory they take."""
    return "".join(f"\x1b_Ga=d,d=I,i={name},q=2\x1b\\" for name in names)


def placeholders(row: int, columns: int) -> str:
    """The text of one row, `columns` cells wide: the first says which row and column it is, and
    each of the others is one further than the one at its left.
    """
    marks = row_marks()
    return f"{PLACEHOLDER}{marks[row]}{marks[0]}" + PLACEHOLDER * (columns - 1)


@cache
def row_marks() -> str:
    """The marks for the rows 0, 1, 2 ... in the protocol's order: of Unicode 6.0 those above a
    letter (class 230) that are part of no composed letter. The protocol has more of them, for more
    rows than a window has.
    """
    fused = {
        part
        for code in range(_LETTERS)
        if (parts := unicodedata.decomposition(chr(code))) and not parts.startswith("<")
        for part in parts.split()
    }
    return "".join(
        chr(code)
        for code in range(0x300, 0x955)
        if unicodedata.combining(chr(code)) == 230
        and f"{code:04X}" not in fused
        and not unicodedata.decomposition(chr(code))
        and not 0x890 <= code < 0x900  # came with later versions
    )


def tmux_passthrough(text: str) -> str:
    """Sequences in tmux's envelope: with `allow-passthrough on` it hands them to its terminal."""
    pieces = text.split("\x1b\\")[:-1]
    return "".join(_enveloped(f"{piece}\x1b\\") for piece in pieces)


def _enveloped(sequence: str) -> str:
    return f"\x1bPtmux;{sequence.replace(chr(27), chr(27) * 2)}\x1b\\"
