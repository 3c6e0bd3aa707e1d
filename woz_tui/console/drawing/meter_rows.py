"""How a meter's row is built: a name, a track with marks on it, a value at the right."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from rich.cells import cell_len

from woz_tui.config.screen_language import say
from woz_tui.console.drawing.cells import Piece, Row, clean, cut, fit
from woz_tui.console.drawing.glyphs import Glyphs, PaintFrame
from woz_tui.console.drawing.number_text import age

#: Cells that names at the left, values at the right and the tracks between them have where there
#: are 33 or more; in fewer the value is cut.
NAME, VALUE, TRACK = 11, 17, 5
#: Cells of a second name beside a track, with the blank behind its own track.
SECOND = 12


@dataclass(frozen=True, slots=True)
class MeterFrame(PaintFrame):
    """Room for meters: all names have `name` cells, and all tracks `track`, so that they begin and
    end in the same columns.
    """

    name: int = NAME
    track: int = TRACK

    @property
    def value(self) -> int:
        """Cells of what stands at the right, without the blanks around it."""
        return self.width - self.name - self.track - 2


def meter_frame(frame: PaintFrame, names: Iterable[str]) -> MeterFrame:
    """Room for meters of these names: none is cut while values and two tracks side by side have
    what they need.
    """
    longest = max((cell_len(clean(name)) + 2 for name in names), default=NAME)
    most = min(frame.width * 2 // 5, frame.width - TRACK - VALUE)
    name = max(NAME, min(longest, most))
    track = max(TRACK, (frame.width - name - SECOND) // 2)
    return MeterFrame(frame.width, frame.height, frame.now, frame.glyphs, name, track)


def name_piece(name: str, frame: MeterFrame) -> Piece:
    """The name at the left, with a blank at each side."""
    return (f" {fit(name, frame.name - 2, frame.glyphs.ellipsis)} ", "muted")


def meter_row(name: str, body: Row, value: str, look: str, frame: MeterFrame) -> Row:
    shown = fit(value, frame.value, frame.glyphs.ellipsis)
    return (name_piece(name, frame), *body, (f" {shown} ", look))


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


def hidden_row(name: str, frame: MeterFrame) -> Row:
    """The row of something that is kept from the wizard on purpose."""
    track: Row = ((frame.glyphs.track * frame.track, "faint"),)
    return meter_row(name, track, hidden_word(), "muted", frame)


def hidden_word() -> str:
    """What stands in place of what is kept from the wizard."""
    return say("meters.hidden", "hidden")


def age_note(t: int, frame: PaintFrame) -> str:
    """How old a value of `t` is that should not be trusted any more."""
    return f"{frame.glyphs.stale}{say('meters.old', '{age} old', age=age(frame.now - t))}"


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
