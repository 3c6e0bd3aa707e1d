"""The page of `woz report`: how wide it is, which signs it may use, tables that fit into it."""

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

from woz_tui.analysis.report_table import ReportTable
from woz_tui.analysis.text_format import counted
from woz_tui.cli.safe_streams import raw_stream
from woz_tui.console.drawing.text_console import TextConsole

#: Columns of a page that goes into a file or a pipe.
_PAGE = 80
#: Cells between two columns of a table, and between two blocks.
_GAP, _BETWEEN = 2, 4


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
    """Where the report is printed, and with which signs."""

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
        """Print text; what is too long for a line goes on in the next one."""
        self.console.print(text, style=style)

    def head(self, text: str) -> None:
        self.say()
        self.say(text, style="bold")

    @property
    def half(self) -> int:
        """Cells of each of two things beside each other; of a whole line where there is no room."""
        return (self.width - _BETWEEN) // 2 if self.wide else self.width

    def table(self, found: ReportTable, most_rows: int = sys.maxsize) -> Table:
        """The columns and rows for which a terminal has room."""
        shown = slice(found.on_terminal)
        made = text_table(*found.heads[shown], left=found.words)
        for place, row in enumerate(found.rows[:most_rows], 1):
            last = found.total and place == len(found.rows)
            made.add_row(*row[shown], style="bold" if last else None)
        return made

    def block(self, found: ReportTable, most_rows: int = sys.maxsize) -> Block:
        """A table with its title; nothing if it has no rows."""
        left = len(found.rows) - most_rows
        more = Text(f"{self.signs.ellipsis} and {counted(left, 'row')} more (--all)", "dim")
        block: Block = [Text(found.title, "bold"), self.table(found, most_rows)]
        return [*block, *([more] * (left > 0))] if found.rows else []

    def print(self, *blocks: Block) -> None:
        """Print blocks one after the other; two beside each other where there is room."""
        blocks = tuple(filter(None, blocks))
        if self.wide and len(blocks) == 2:
            grid = Table.grid(padding=(0, _BETWEEN, 0, 0), pad_edge=False)
            for _ in blocks:
                grid.add_column(width=self.half)
            grid.add_row(*(Group(*_pieces(block, self.half)) for block in blocks))
            self.console.print("", grid, sep="\n")
            return
        for block in blocks:
            self.console.print("", *_pieces(block, self.width), sep="\n")

    def trouble(self, text: str) -> None:
        """Print a warning about the data."""
        self.say(f"{self.signs.warning} {text}", style="yellow")


def report_page(stream: TextIO | None = None, width: int | None = None) -> ReportPage:
    """Opens a page on `stream`, by default standard output; signs that it cannot show become
    others.
    """
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
    """The widths of a column's longest word and of its longest line."""
    lines = [line for cell in (column.header, *column.cells) for line in str(cell).split("\n")]
    words = [word for line in lines for word in line.split()]
    # A figure is no sentence: it stays with its unit.
    figures = [str(cell) for cell in column.cells] if column.justify == "right" else []
    return max(map(cell_len, [*words, *figures]), default=0), max(map(cell_len, lines), default=0)


def _part(
    made: Table, places: Sequence[int], widths: Sequence[tuple[int, int]], room: int
) -> Table:
    """Some columns of a table, the widest of them narrowed until they have room."""
    least, widest = ([widths[place][which] for place in places] for which in (0, 1))
    over = sum(widest) + _GAP * (len(places) - 1) - room
    for _ in range(max(0, over)):
        free = [at for at, width in enumerate(widest) if width > least[at]]
        free = free or [at for at, width in enumerate(widest) if width > 1]
        widest[max(free, key=widest.__getitem__)] -= 1
    part = text_table()
    for width, place in zip(widest, places, strict=True):
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
