"""A picture in half blocks: two pixels a cell, one above the other, and only what has changed.

A camera's picture is never twice the same: a pixel counts as changed when it is further from what
is shown than the camera's noise. Where the line cannot take all that has changed, the cells that
have changed most come first, and the others with the next picture.
"""

from __future__ import annotations

from dataclasses import dataclass

from woz_tui.console.camera import terminal_colours as c

#: How far red, green and blue of a pixel together may be from what is shown, of 3 x 255.
NOISE = 24
#: About so many bytes a cell costs by itself: both colours, its sign, a share of a move.
COSTS = {1 << 24: 60, 256: 42, 16: 30, 0: 14}


@dataclass(frozen=True, slots=True)
class CellRun:
    """Cells from `begin` up to `end` of line `row`."""

    row: int
    begin: int
    end: int


class HalfBlockCanvas:
    """What `columns` x `rows` cells show, in so many `colours`; 0: in signs of ASCII."""

    def __init__(self, columns: int, rows: int, colours: int) -> None:
        self.columns, self.rows, self.colours = columns, rows, colours
        self._number = {1 << 24: c.of_24_bits, 256: c.of_256, 16: c.of_16, 0: c.brightness}[colours]
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
        return c.RAMP[(upper + lower) * len(c.RAMP) // 512]

    def take(self, rgb: bytes, allowance: int) -> list[CellRun]:
        """Show a picture of `size`, as far as `allowance` bytes reach; returns what to paint."""
        changed = self._worst(self._differences(rgb), max(1, allowance // COSTS[self.colours]))
        shown = self._shown if self._shown is not None else bytearray(len(rgb))
        self._shown = shown
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
        return self._stretches(painted)

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

    def _worst(self, differences: list[int], most: int) -> list[int]:
        """The cells that have changed, in their order; if too many, those that differ most."""
        changed = [place for place, by in enumerate(differences) if by > NOISE]
        if len(changed) > most:
            changed.sort(key=lambda place: -differences[place])
            changed = sorted(changed[:most])
        return changed

    def _stretches(self, places: list[int]) -> list[CellRun]:
        """Cells in their order as stretches within lines."""
        found: list[CellRun] = []
        for place in places:
            row, column = divmod(place, self.columns)
            last = found[-1] if found else None
            if last is not None and last.row == row and last.end == column:
                found[-1] = CellRun(row, last.begin, column + 1)
            else:
                found.append(CellRun(row, column, column + 1))
        return found
