"""Draws pictures in half blocks: two pixels a cell, one above the other, only what has changed.

A camera's picture is never twice the same: a pixel counts as changed when it is further from what
is shown than the camera's noise. Where the line cannot take all that has changed, the cells that
have changed most come first, and the others with the next picture.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

from rich.color import Color
from rich.style import Style
from textual.geometry import Region

#: Signs by their brightness on a dark ground, the darkest first.
RAMP = " .:-=+*#%@"
#: The sixteen colours as xterm has them; every terminal has its own idea of them.
_SIXTEEN = (
    (0, 0, 0),
    (205, 0, 0),
    (0, 205, 0),
    (205, 205, 0),
    (0, 0, 238),
    (205, 0, 205),
    (0, 205, 205),
    (229, 229, 229),
    (127, 127, 127),
    (255, 0, 0),
    (0, 255, 0),
    (255, 255, 0),
    (92, 92, 255),
    (255, 0, 255),
    (0, 255, 255),
    (255, 255, 255),
)
#: Steps of a channel in the cube of the 256 colours.
_CUBE = (0, 95, 135, 175, 215, 255)
#: All 256: the sixteen, the cube, steps of grey.
_PALETTE: tuple[tuple[int, int, int], ...] = (
    *_SIXTEEN,
    *((red, green, blue) for red in _CUBE for green in _CUBE for blue in _CUBE),
    *((grey, grey, grey) for grey in range(8, 248, 10)),
)

#: Red, green, blue -> the number by which a cell's colour is known, and whether it has changed.
Number = Callable[[int, int, int], int]


def of_24_bits(red: int, green: int, blue: int) -> int:
    """32 steps a channel: of neighbours nearly alike more are alike, and cost less."""
    return (red & 0xF8) << 16 | (green & 0xF8) << 8 | blue & 0xF8


def of_256(red: int, green: int, blue: int) -> int:
    """The nearest of xterm's 240 fixed colours, for 16 steps a channel."""
    return _nearest_256(red >> 4, green >> 4, blue >> 4)


def of_16(red: int, green: int, blue: int) -> int:
    """The nearest of the sixteen."""
    return _nearest_16(red >> 4, green >> 4, blue >> 4)


def brightness(red: int, green: int, blue: int) -> int:
    """Of ITU-R BT.601, 0 to 255."""
    return (77 * red + 150 * green + 29 * blue) >> 8


@lru_cache(4096)
def _nearest_256(red: int, green: int, blue: int) -> int:
    wanted = (red * 17, green * 17, blue * 17)
    steps = [min(range(6), key=lambda n, c=c: abs(_CUBE[n] - c)) for c in wanted]  # type: ignore[misc]
    cube = 16 + 36 * steps[0] + 6 * steps[1] + steps[2]
    grey = 232 + min(23, max(0, round((sum(wanted) / 3 - 8) / 10)))
    return min(cube, grey, key=lambda number: _distance(wanted, _PALETTE[number]))


@lru_cache(4096)
def _nearest_16(red: int, green: int, blue: int) -> int:
    wanted = (red * 17, green * 17, blue * 17)
    return min(range(16), key=lambda number: _distance(wanted, _PALETTE[number]))


def _distance(one: tuple[int, int, int], other: tuple[int, int, int]) -> int:
    """Green counts most and blue least, as eyes see them."""
    red, green, blue = (a - b for a, b in zip(one, other, strict=True))
    return 3 * red * red + 6 * green * green + blue * blue


def rgb_of(number: int, colours: int) -> tuple[int, int, int]:
    """Red, green and blue of a number, for terminals of so many colours."""
    if colours > 256:
        return number >> 16 & 255, number >> 8 & 255, number & 255
    return _PALETTE[number]


@lru_cache(4_096)
def style(upper: int, lower: int, colours: int) -> Style:
    """A half block's colours; of a blank where both are the same."""
    if upper == lower:
        return Style.from_color(None, _colour(lower, colours))
    return Style.from_color(_colour(upper, colours), _colour(lower, colours))


@lru_cache(4_096)
def _colour(number: int, colours: int) -> Color:
    return Color.from_rgb(*rgb_of(number, colours)) if colours > 256 else Color.from_ansi(number)


#: How far red, green and blue of a pixel together may be from what is shown, of 3 x 255.
NOISE = 24
#: About so many bytes a cell costs by itself: both colours, its sign, a share of a move.
COSTS = {1 << 24: 60, 256: 42, 16: 30, 0: 14}


class HalfBlockCanvas:
    """What `columns` x `rows` cells show, in so many `colours`; 0: in signs of ASCII."""

    def __init__(self, columns: int, rows: int, colours: int) -> None:
        self.columns, self.rows, self.colours = columns, rows, colours
        self._number = {1 << 24: of_24_bits, 256: of_256, 16: of_16, 0: brightness}[colours]
        self._shown: bytearray | None = None
        blank = (0, 0) if colours else (-1, -1)
        self._cells: list[tuple[int, int]] = [blank] * (columns * rows)

    @property
    def size(self) -> tuple[int, int]:
        """Pixels: as wide as the cells, twice as high."""
        return self.columns, 2 * self.rows

    def cell(self, column: int, row: int) -> tuple[int, int]:
        """The numbers of a cell's two colours, the upper one first."""
        return self._cells[row * self.columns + column]

    def sign(self, column: int, row: int) -> str:
        """A cell without colours: the sign for how bright it is."""
        upper, lower = self.cell(column, row)
        if upper < 0:
            return " "
        return RAMP[(upper + lower) * len(RAMP) // 512]

    def paint(self, rgb: bytes, allowance: int) -> list[Region]:
        """Show a picture of `size`, as far as `allowance` bytes reach; returns what to paint."""
        differences = self._differences(rgb)
        changed = [place for place, by in enumerate(differences) if by > NOISE]
        most = max(1, allowance // COSTS[self.colours])
        if len(changed) > most:  # those that differ most
            changed.sort(key=differences.__getitem__, reverse=True)
            changed = sorted(changed[:most])
        shown = self._shown = self._shown or bytearray(len(rgb))
        painted = []
        stride, number = 3 * self.columns, self._number
        for place in changed:
            row, column = divmod(place, self.columns)
            upper = 2 * row * stride + 3 * column
            lower = upper + stride
            shown[upper : upper + 3] = top = rgb[upper : upper + 3]
            shown[lower : lower + 3] = bottom = rgb[lower : lower + 3]
            cell = (number(*top), number(*bottom))
            if cell != self._cells[place]:
                self._cells[place] = cell
                painted.append(place)
        return self._regions(painted)

    def _differences(self, rgb: bytes) -> list[int]:
        """For each cell how far its worse pixel is from what is shown; of the first picture all
        cells differ.
        """
        shown = self._shown
        if shown is None:
            return [3 * 255 + 1] * (self.columns * self.rows)
        channels = [abs(a - b) for a, b in zip(rgb, shown, strict=True)]
        pixels = [
            r + g + b for r, g, b in zip(channels[::3], channels[1::3], channels[2::3], strict=True)
        ]
        wide, cells = self.columns, list[int]()
        for top in range(0, len(pixels), 2 * wide):
            upper, lower = pixels[top : top + wide], pixels[top + wide : top + 2 * wide]
            cells += map(max, upper, lower)
        return cells

    def _regions(self, places: list[int]) -> list[Region]:
        """Cells in their order as stretches within lines."""
        found: list[Region] = []
        for place in places:
            row, column = divmod(place, self.columns)
            if found and (found[-1].y, found[-1].right) == (row, column):
                found[-1] = found[-1].grow((0, 1, 0, 0))
            else:
                found.append(Region(column, row, 1, 1))
        return found
