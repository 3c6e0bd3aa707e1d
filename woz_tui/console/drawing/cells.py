"""Rows of text drawn by the line API: a widget that repaints only the cells that changed.

A row is a tuple of pieces, a piece a text and the name of its look. What a widget shows is made
by a plain function from the state to rows, so it can be tested without a screen.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from rich.cells import cell_len, set_cell_size
from rich.segment import Segment
from rich.style import Style
from textual.geometry import Region
from textual.message import Message
from textual.strip import Strip
from textual.widget import Widget

from woz_tui.console.drawing.glyphs import Glyphs, PaintFrame
from woz_tui.console.drawing.theme import look_style
from woz_tui.system import text_cleaning

Piece = tuple[str, str]
Row = tuple[Piece, ...]

#: Every text that is drawn goes through it; before it is measured, where it may be anybody's.
clean = text_cleaning.clean

#: Texts all of whose characters take one cell each: Latin letters, lines, blocks, dots.
_SINGLE = re.compile("[\\x20-\\x7e\\xa0-\\u02ff\\u2500-\\u25ff\\u2800-\\u28ff]*")

#: A word with the blanks before it, or the blanks at the end.
_WORD = re.compile(r"\s*\S+|\s+")

#: Unchanged cells between two changed ones that are cheaper to paint again than to jump over.
REPAINT_GAP_CELLS = 8


def clean_paste(text: str) -> str:
    """`text` as it may stand in a field: its lines stay lines, whatever ended them, and nothing is
    left that a terminal would obey.
    """
    return "\n".join(map(clean, text.replace("\0", "").splitlines()))


def fit(text: str, width: int, ellipsis: str = "…", right: bool = False) -> str:
    """`text` in exactly `width` cells: cut with an ellipsis or filled with blanks."""
    if width <= 0:
        return ""
    text = clean(text)
    length = cell_len(text)
    if length > width:
        return set_cell_size(text, width - 1) + ellipsis
    blanks = " " * (width - length)
    return blanks + text if right else text + blanks


def length(row: Row) -> int:
    """Cells a row takes."""
    return sum(cell_len(text) for text, _ in row)


def cut(row: Row, width: int, ellipsis: str = "…") -> Row:
    """A row in exactly `width` cells."""
    pieces: list[Piece] = []
    left = width
    for index, (text, look) in enumerate(row):
        size = cell_len(text)
        if size > left or (size == left and length(row[index + 1 :])):
            if left:
                pieces.append((set_cell_size(text, left - 1) + ellipsis, look))
            return tuple(pieces)
        pieces.append((text, look))
        left -= size
    if left:
        pieces.append((" " * left, "plain"))
    return tuple(pieces)


def cut_rows(rows: Sequence[Row], frame: PaintFrame, foot: Sequence[Row] = ()) -> list[Row]:
    """Rows as wide as the frame and as many as fit; those of a `foot` stand at its bottom."""
    room = max(0, frame.height - len(foot))
    blank = [()] * (room - len(rows)) if foot else []
    shown = [*rows[:room], *blank, *foot][: frame.height]
    return [cut(row, frame.width, frame.glyphs.ellipsis) for row in shown]


def fit_most(text: str, width: int, ellipsis: str) -> str:
    """`text`, cut if it is longer than `width` cells."""
    text = clean(text)
    return text if cell_len(text) <= width else fit(text, width, ellipsis)


def spread(left: Row, right: Row, width: int, ellipsis: str = "…") -> Row:
    """`left` at the left, `right` at the right end; `left` gives way."""
    room = width - length(right)
    if room < 1:
        return cut(right, width, ellipsis)
    return cut(left, room, ellipsis) + right


def wrap_row(row: Row, indent: int, width: int) -> list[Row]:
    """A row that is too long as several ones, broken between words, all but the first indented.

    A word that is wider than the row stays whole: whoever draws it folds it.
    """
    if length(row) <= width or 2 * indent >= width:
        return [row]
    rows: list[Row] = []
    line: list[Piece] = []
    used = 0
    for text, look in row:
        for part in _WORD.findall(text):
            word = part
            if used + cell_len(word) > width and used > indent:
                if not word.strip():
                    continue  # blanks at the end are worth no row
                rows.append(tuple(line))
                line, used, word = [(" " * indent, "plain")], indent, part.lstrip()
            line.append((word, look))
            used += cell_len(word)
    return [*rows, tuple(line)]


def heading(title: str, frame: PaintFrame) -> Row:
    """A title with a thin line behind it, over the frame's whole width."""
    rule = frame.glyphs.rule * max(0, frame.width - cell_len(title) - 3)
    return ((f" {title} ", "title"), (rule, "faint"), (" ", "plain"))


class Cells(Widget):
    """Shows rows. `show` compares them with what is there and repaints the difference."""

    can_focus = False

    class Resized(Message):
        """The widget has a new size; its rows are still those of the old one."""

        def can_replace(self, message: Message) -> bool:
            """One painting serves all widgets that are resized together."""
            return isinstance(message, Cells.Resized)

    def __init__(self, *, id: str | None = None, classes: str | None = None) -> None:  # noqa: A002
        super().__init__(id=id, classes=classes)
        self._rows: list[Row] = []
        self._styles_of_looks: dict[str, Style] = {}

    @property
    def rows(self) -> list[Row]:
        return self._rows

    @property
    def text(self) -> str:
        """What is shown, without looks."""
        return "\n".join("".join(text for text, _ in row) for row in self._rows)

    def frame(self, now: int, glyphs: Glyphs) -> PaintFrame:
        """Its room, for one painting."""
        return PaintFrame(self.size.width, self.size.height, now, glyphs)

    def on_resize(self) -> None:
        """Ask for rows that fit the new size."""
        self.post_message(self.Resized())

    def show(self, rows: Sequence[Row]) -> None:
        """Show `rows` from the top; only cells that differ are repainted."""
        before, self._rows = self._rows, list(rows)
        changed = []
        for y in range(max(len(before), len(self._rows))):
            old = before[y] if y < len(before) else ()
            new = self._rows[y] if y < len(self._rows) else ()
            if old != new:
                changed += differences(old, new, y, self.size.width)
        if changed:
            self.refresh(*changed)

    def style_of(self, look: str) -> Style:
        """How a look is drawn on the widget's own background.

        Computed when it is drawn: as component classes, each widget would have the style sheet
        applied to every look there is, whenever a dialog opens or closes.

        Raises:
            KeyError: There is no such look.
        """
        if look not in self._styles_of_looks:
            self._styles_of_looks[look] = self.rich_style + look_style(look, self.app)
        return self._styles_of_looks[look]

    def notify_style_update(self) -> None:
        """The theme or the background may be another one."""
        self._styles_of_looks.clear()
        super().notify_style_update()

    def render_line(self, y: int) -> Strip:
        """One row, padded with the widget's own background."""
        base = self.style_of("plain")
        width = self.size.width
        if y >= len(self._rows):
            return Strip.blank(width, base)
        segments = [
            Segment(clean(text), self.style_of(look)) for text, look in self._rows[y] if text
        ]
        return Strip(segments).adjust_cell_length(width, base)


def differences(old: Row, new: Row, y: int, width: int) -> list[Region]:
    """The cells of line `y` that differ, as few stretches as are worth moving the cursor for."""
    before, after = _cells(old), _cells(new)
    if before is None or after is None or len(before) != len(after):
        return [_difference(old, new, y, width)]
    stretches: list[tuple[int, int]] = []
    for x, (was, now) in enumerate(zip(before, after, strict=True)):
        if was == now:
            continue
        if stretches and x - stretches[-1][1] <= REPAINT_GAP_CELLS:
            stretches[-1] = (stretches[-1][0], x + 1)
        else:
            stretches.append((x, x + 1))
    if not stretches:  # the same cells, cut into pieces in another way
        return []
    return [Region(start, y, end - start, 1) for start, end in stretches]


def _cells(row: Row) -> list[Piece] | None:
    """Each cell with its look; None where a character may take another number of cells."""
    if not all(_SINGLE.fullmatch(text) for text, _ in row):
        return None
    return [(sign, look) for text, look in row for sign in text]


def _difference(old: Row, new: Row, y: int, width: int) -> Region:
    """The cells of line `y` from the first to the last piece that differs."""
    if length(old) != length(new):
        return Region(0, y, width, 1)
    start = 0
    for a, b in zip(old, new, strict=False):
        if a != b:
            break
        start += cell_len(a[0])
    end = length(new)
    for a, b in zip(reversed(old), reversed(new), strict=False):
        if a != b:
            break
        end -= cell_len(a[0])
    if end <= start:
        return Region(0, y, width, 1)
    return Region(start, y, end - start, 1)
