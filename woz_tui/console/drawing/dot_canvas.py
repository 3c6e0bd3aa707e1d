"""Draws with dots: two columns of four in every cell (braille), or one sign a cell in ASCII."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import NamedTuple

from woz_tui.console.drawing.cells import Piece, Row
from woz_tui.console.drawing.glyphs import Glyphs
from woz_tui.console.drawing.meter_rows import merge_pieces

#: Dots of a cell, and the bit of each in Unicode's braille block, by column and row.
ACROSS, DOWN = 2, 4
_BITS = ((0x01, 0x02, 0x04, 0x40), (0x08, 0x10, 0x20, 0x80))
_BRAILLE = 0x2800

Dot = tuple[int, int]


class DotLayer(NamedTuple):
    """What dots mean: their look, their sign in ASCII, and whether they vanish from cells in which
    a higher layer has dots; else they stay, in its look.
    """

    look: str
    sign: str
    yields: bool = False


class DotCanvas:
    """A sheet of `width` x `height` cells; dots count from 0 at the upper left.

    `layers` go from the lowest to the highest. What lies outside the sheet is not drawn.
    """

    def __init__(self, width: int, height: int, layers: Mapping[str, DotLayer]) -> None:
        self.width, self.height = width, height
        self._layers = layers
        self._bits: dict[str, dict[Dot, int]] = {name: {} for name in layers}

    def dot(self, x: int, y: int, layer: str) -> None:
        cell = (x // ACROSS, y // DOWN)
        if 0 <= cell[0] < self.width and 0 <= cell[1] < self.height:
            bits = self._bits[layer]
            bits[cell] = bits.get(cell, 0) | _BITS[x % ACROSS][y % DOWN]

    def line(self, start: Dot, end: Dot, layer: str, every: int = 1) -> None:
        """A straight line; of its dots only one in `every`."""
        (x, y), (to_x, to_y) = start, end
        steps = max(abs(to_x - x), abs(to_y - y))
        for step in range(0, steps + 1, every):
            share = step / steps if steps else 0.0
            self.dot(round(x + (to_x - x) * share), round(y + (to_y - y) * share), layer)

    def stamp(self, at: Dot, shape: Iterable[Dot], layer: str) -> None:
        """Dots around `at`."""
        for x, y in shape:
            self.dot(at[0] + x, at[1] + y, layer)

    def dots(self, *layers: str) -> set[Dot]:
        """All dots that are set in these layers."""
        return {
            (column * ACROSS + x, row * DOWN + y)
            for layer in layers
            for (column, row), bits in self._bits[layer].items()
            for x in range(ACROSS)
            for y in range(DOWN)
            if bits & _BITS[x][y]
        }

    def rows(self, glyphs: Glyphs) -> list[Row]:
        """The sheet as rows of cells."""
        rows = []
        for line in range(self.height):
            cells: list[Piece] = []
            for column in range(self.width):
                sign, look = self._cell((column, line), glyphs)
                if sign == " " and cells:
                    look = cells[-1][1]  # one look for longer: a blank has none of its own
                cells.append((sign, look))
            rows.append(merge_pieces(cells))
        return rows

    def _cell(self, cell: Dot, glyphs: Glyphs) -> Piece:
        there = [name for name in self._layers if cell in self._bits[name]]
        if not there:
            return (" ", "plain")
        top = self._layers[there[-1]]
        if glyphs.ascii:
            return (top.sign, top.look)
        bits = 0
        for name in there:
            if name == there[-1] or not self._layers[name].yields:
                bits |= self._bits[name][cell]
        return (chr(_BRAILLE + bits), top.look)


def braille(bits: int) -> str:
    """The sign for a cell's dots, as set by `bit`."""
    return chr(_BRAILLE + bits) if bits else " "


def bit(column: int, row: int) -> int:
    """The bit of one of a cell's dots."""
    return _BITS[column][row]
