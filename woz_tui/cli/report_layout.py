"""The page of `woz report`: how wide it is, which signs it may use, how numbers look."""

from __future__ import annotations

import io
import locale
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TextIO

from rich.cells import cell_len
from rich.console import Group, RenderableType
from rich.table import Column, Table
from rich.text import Text

from woz_tui.cli.safe_streams import raw_stream
from woz_tui.console.text_console import TextConsole

#: Columns of a page that goes into a file or a pipe.
_PAGE = 80
#: Cells between two columns of a table, and between two blocks.
_GAP, _BETWEEN = 2, 4
#: What stands where there is no figure.
NONE = "-"


@dataclass(frozen=True, slots=True)
class TextSigns:
    """What is drawn with. `levels` are those of an engagement: nobody, somebody there, engaged,
    somebody speaks, the visitor waits. `bars` rise from an empty to a full cell.
    """

    bars: str = " ▁▂▃▄▅▆▇█"
    rows: str = " ▏▎▍▌▋▊▉█"
    levels: str = "·░▒▓█"
    running: str = "─"
    failed: str = "✗"
    stop: str = "■"
    lost: str = "▒"
    marker: str = "◆"
    note: str = "•"
    opens: str = "├"
    closes: str = "┤"
    line: str = "─"
    tick: str = "┬"
    arrow: str = "→"
    warning: str = "▲"
    ellipsis: str = "…"
    dot: str = "·"
    dash: str = "–"  # noqa: RUF001 - between two numbers
    over: str = "≥"


PLAIN = TextSigns(
    bars=" .:-=+*##",
    rows="        #",
    levels=".-=%#",
    running="-",
    failed="x",
    stop="#",
    lost="x",
    marker="m",
    note="n",
    opens="[",
    closes="]",
    line="-",
    tick="+",
    arrow="->",
    warning="!",
    ellipsis="...",
    dot="-",
    dash="-",
    over=">=",
)


#: A head and what stands under it; empty: nothing is to be told.
Block = list[RenderableType]


@dataclass(frozen=True, slots=True)
class ReportPage:
    """Where it is printed, and with which signs."""

    console: TextConsole
    signs: TextSigns

    @property
    def width(self) -> int:
        """Cells of a line."""
        return self.console.width

    @property
    def wide(self) -> bool:
        """Whether two things have room beside each other."""
        return self.width >= 130

    def say(self, text: str | Text = "", style: str = "") -> None:
        """One line or more; what is too long goes on in the next one."""
        self.console.print(text, style=style)

    def head(self, text: str) -> None:
        """What comes now."""
        self.say()
        self.say(text, style="bold")

    @property
    def half(self) -> int:
        """Cells of each of two things beside each other; of a whole line where there is no room."""
        return (self.width - _BETWEEN) // 2 if self.wide else self.width

    def put(self, made: Table, room: int = 0) -> None:
        """A table, as wide as the page unless there is less `room`."""
        for piece in fitted(made, room or self.width):
            self.console.print(piece)

    def beside(self, left: Block, right: Block) -> None:
        """Two blocks beside each other where there is room, else one after the other."""
        if self.wide and left and right:
            grid = Table.grid(padding=(0, _BETWEEN, 0, 0), pad_edge=False)
            grid.add_column(width=self.half)
            grid.add_column(width=self.half)
            grid.add_row(*(Group(*_pieces(block, self.half)) for block in (left, right)))
            self.say()
            self.console.print(grid)
            return
        for block in filter(None, (left, right)):
            self.say()
            for each in _pieces(block, self.width):
                self.console.print(each)

    def trouble(self, text: str) -> None:
        """Something that is wrong with the data."""
        self.say(f"{self.signs.warning} {text}", style="yellow")


def report_page(stream: TextIO | None = None, width: int | None = None) -> ReportPage:
    """For `stream`, by default standard output; a sign that it cannot show becomes another one."""
    file = raw_stream(sys.stdout) if stream is None else stream
    if isinstance(file, io.TextIOWrapper):
        file.reconfigure(errors="replace")
    console = TextConsole(file=file, width=width, page=None if width else _PAGE)
    shown = all(_shows(name, TextSigns()) for name in (console.encoding, locale.getencoding()))
    return ReportPage(console, TextSigns() if shown else PLAIN)


def _shows(encoding: str, signs: TextSigns) -> bool:
    try:
        "".join((signs.bars, signs.rows, signs.levels, signs.marker, signs.over)).encode(encoding)
    except (UnicodeEncodeError, LookupError):
        return False
    return True


def text_table(*heads: str, left: int = 1) -> Table:
    """A table without lines whose first `left` columns are words, the others figures."""
    made = Table(box=None, pad_edge=False, padding=(0, _GAP, 0, 0), header_style="dim")
    for place, head in enumerate(heads):
        if place < left:
            made.add_column(head, overflow="fold")
        else:
            made.add_column(head, justify="right")
    return made


def fitted(made: Table, room: int) -> list[Table]:
    """The table in `room` cells without a broken word: words go on in the next line, and figures
    for which there is no room stand in a further table beside the same names. Only a word that is
    longer than its line is broken.
    """
    widths = [_widths(column) for column in made.columns]
    figures = [place for place, each in enumerate(made.columns) if each.justify == "right"]
    names = [place for place in range(len(widths)) if place not in figures]
    least = sum(widths[place][0] + _GAP for place in names)
    groups: list[list[int]] = [[]]
    left = room - least + _GAP
    for place in figures:
        taken = widths[place][0] + _GAP
        if taken > left and groups[-1]:
            groups.append([])
            left = room - least + _GAP
        groups[-1].append(place)
        left -= taken
    return [_part(made, [*names, *group], widths, room) for group in groups]


def _widths(column: Column) -> tuple[int, int]:
    """Of a column's longest word, and of its longest line."""
    lines = [line for cell in (column.header, *column.cells) for line in str(cell).split("\n")]
    words = [word for line in lines for word in line.split()]
    # A figure is no sentence: it stays with its unit.
    whole = [str(cell) for cell in column.cells] if column.justify == "right" else []
    return max(map(cell_len, [*words, *whole]), default=0), max(map(cell_len, lines), default=0)


def _part(
    made: Table, places: Sequence[int], widths: Sequence[tuple[int, int]], room: int
) -> Table:
    """Some columns of a table, the widest of them narrowed until they have room."""
    least, wanted = ([widths[place][which] for place in places] for which in (0, 1))
    over = sum(wanted) + _GAP * (len(places) - 1) - room
    for _ in range(max(0, over)):
        free = [at for at, width in enumerate(wanted) if width > least[at]]
        free = free or [at for at, width in enumerate(wanted) if width > 1]
        wanted[max(free, key=wanted.__getitem__)] -= 1
    part = text_table()
    for width, place in zip(wanted, places, strict=True):
        column = made.columns[place]
        part.add_column(column.header, justify=column.justify, overflow="fold", width=width)
    cells = zip(*(made.columns[place].cells for place in places), strict=True)
    for row, line in zip(made.rows, cells, strict=True):
        part.add_row(*line, style=row.style, end_section=row.end_section)
    return part


def _pieces(block: Block, room: int) -> Block:
    return [
        piece
        for each in block
        for piece in (fitted(each, room) if isinstance(each, Table) else [each])
    ]


def more(page: ReportPage, left: int, one: str) -> Block:
    """Says that a table does not show everything."""
    if left <= 0:
        return []
    return [dim(f"{page.signs.ellipsis} and {some(left, one)} more (--all)")]


def bold(text: str) -> Text:
    """The head of a block."""
    return Text(text, "bold")


def dim(text: str) -> Text:
    """Something that is worth less than the rest."""
    return Text(text, "dim")


# -- numbers --------------------------------------------------------------------------------------


def clock(us: float | None) -> str:
    """A moment or a long time: minutes and seconds, with hours where there are any."""
    if us is None:
        return NONE
    seconds = round(us / 1e6)
    hours, minutes = seconds // 3600, seconds // 60 % 60
    return f"{hours}:{minutes:02d}:{seconds % 60:02d}" if hours else f"{minutes}:{seconds % 60:02d}"


def in_unit(value: float | None, unit: str) -> str:
    """A figure with three digits that count, in its unit, without the unit's name."""
    if value is None:
        return NONE
    match unit:
        case "share":
            return f"{value:.1%}".replace("%", " %")
        case "" if float(value).is_integer():
            return f"{value:.0f}"
    return digits(value)


def digits(value: float) -> str:
    """A number with three digits that count."""
    size = abs(value)
    return f"{value:.0f}" if size >= 100 else f"{value:.1f}" if size >= 10 else f"{value:.2f}"


def s(us: float | None) -> str:
    """Microseconds, in seconds."""
    return NONE if us is None else digits(us / 1e6)


def ms(us: float | None) -> str:
    """Microseconds, in milliseconds."""
    return NONE if us is None else digits(us / 1e3)


def some(count: int, one: str, many: str = "") -> str:
    """`1 stop`, `2 stops`."""
    return f"{count} {one if count == 1 else many or one + 's'}"
