"""A reader of sixel sequences, written from DEC STD 070 and for tests alone."""

from __future__ import annotations

import re

import numpy as np
import numpy.typing as npt

_WHOLE = re.compile(r"\x1bP([0-9;]*)q(.*)\x1b\\", re.DOTALL)
_TOKEN = re.compile(r'"[0-9;]+|#[0-9;]+|![0-9]+[?-~]|[?-~]|[$-]')


def read_sixel(sequence: str) -> npt.NDArray[np.uint8]:
    """The pixels, shape (rows, columns, 3). Every pixel must have been drawn, once, inside."""
    whole = _WHOLE.fullmatch(sequence)
    assert whole, "not one whole sequence"
    colours: dict[int, tuple[int, int, int]] = {}
    picture: npt.NDArray[np.uint8] | None = None
    times = np.zeros((1, 1), int)
    x = y = colour = at = 0
    while at < len(whole[2]):
        token = _TOKEN.match(whole[2], at)
        assert token, f"unknown: {whole[2][at : at + 20]!r}"
        at = token.end()
        text = token[0]
        if text[0] == '"':
            _, _, width, height = map(int, text[1:].split(";"))
            picture, times = np.zeros((height, width, 3), np.uint8), np.zeros((height, width), int)
        elif text[0] == "#":
            number, *values = map(int, text[1:].split(";"))
            if values:
                assert values[0] == 2
                assert max(values[1:]) <= 100
                red, green, blue = (round(value * 255 / 100) for value in values[1:])
                colours[number] = red, green, blue
            colour = number
        elif text in "$-":
            x, y = 0, y + 6 * (text == "-")
        else:
            count = int(text[1:-1]) if text[0] == "!" else 1
            bits = ord(text[-1]) - 63
            assert picture is not None, "no size"
            for row in range(6):
                if bits >> row & 1:
                    picture[y + row, x : x + count] = colours[colour]
                    times[y + row, x : x + count] += 1
                    assert x + count <= picture.shape[1]
            x += count
    assert picture is not None
    assert (times == 1).all()
    return picture
