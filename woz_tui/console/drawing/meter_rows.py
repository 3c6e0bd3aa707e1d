"""How a meter's row is built: a name, a track with marks on it, a value at the right."""

from __future__ import annotations

from collections.abc import Sequence

from woz_tui.console.drawing.cells import Piece, Row, cut, fit
from woz_tui.console.drawing.glyphs import Glyphs, PaintFrame
from woz_tui.console.drawing.number_text import age
from woz_tui.session.redactor import HIDDEN

#: Cells of the names at the left and the values at the right.
NAME, VALUE = 11, 17


def name_piece(name: str) -> Piece:
    """The name at the left, with a blank at each side."""
    return (f" {fit(name, NAME - 2)} ", "muted")


def meter_row(name: str, body: Row, value: str, look: str) -> Row:
    """A whole row."""
    return (name_piece(name), *body, (f" {fit(value, VALUE - 2)} ", look))


def track_width(frame: PaintFrame) -> int:
    """Cells between name and value."""
    return max(5, frame.width - NAME - VALUE)


def track_cell(share: float, width: int) -> int:
    """The cell of `share` (0..1) on a track; what lies beyond is drawn at the end."""
    return min(width - 1, int(min(1.0, max(0.0, share)) * width))


def ruler(
    width: int, ticks: dict[int, str], spots: dict[int, tuple[str, str]], glyphs: Glyphs
) -> Row:
    """A line with ticks on it and spots on top of them."""
    cells = [spots.get(x, (ticks.get(x, glyphs.track), "faint")) for x in range(width)]
    return merge_pieces(cells)


def merge_pieces(cells: list[Piece]) -> Row:
    """Neighbours of one look as one piece."""
    pieces: list[Piece] = []
    for text, look in cells:
        if pieces and pieces[-1][1] == look:
            pieces[-1] = (pieces[-1][0] + text, look)
        else:
            pieces.append((text, look))
    return tuple(pieces)


def hidden_row(name: str, frame: PaintFrame) -> Row:
    """The row of something that is kept from the wizard on purpose."""
    return meter_row(name, ((frame.glyphs.track * track_width(frame), "faint"),), HIDDEN, "faint")


def age_note(t: int, frame: PaintFrame) -> str:
    """How old a value of `t` is that should not be trusted any more."""
    return f"{frame.glyphs.stale}{age(frame.now - t)} old"


def side_by_side(
    blocks: Sequence[tuple[Sequence[Row], int]], height: int, glyphs: Glyphs, gap: int = 1
) -> list[Row]:
    """Blocks of rows side by side, each in its own width, with `gap` blanks between them."""
    rows: list[Row] = []
    for y in range(height):
        row: Row = ()
        for number, (block, width) in enumerate(blocks):
            if number:
                row += ((" " * gap, "plain"),)
            row += (
                cut(block[y], width, glyphs.ellipsis)
                if y < len(block)
                else ((" " * width, "plain"),)
            )
        rows.append(row)
    return rows
