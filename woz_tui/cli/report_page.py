"""The page of `woz report`: how wide it is, which signs it may use, how numbers look."""

from __future__ import annotations

import io
import locale
import sys
from dataclasses import dataclass
from typing import TextIO

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from woz_tui.cli.streams import beneath
from woz_tui.console.text_console import TextConsole

#: Columns of a page that goes into a file or a pipe.
_PAGE = 80
#: What stands where there is no figure.
NONE = "-"


@dataclass(frozen=True, slots=True)
class Signs:
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


PLAIN = Signs(
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
class Page:
    """Where it is printed, and with which signs."""

    console: TextConsole
    signs: Signs

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

    def beside(self, left: Block, right: Block) -> None:
        """Two blocks beside each other where there is room, else one after the other."""
        if self.wide and left and right:
            grid = Table.grid(padding=(0, 4, 0, 0))
            grid.add_row(Group(*left), Group(*right))
            self.say()
            self.console.print(grid)
            return
        for block in filter(None, (left, right)):
            self.say()
            for each in block:
                self.console.print(each)

    def trouble(self, text: str) -> None:
        """Something that is wrong with the data."""
        self.say(f"{self.signs.warning} {text}", style="yellow")


def page(stream: TextIO | None = None, width: int | None = None) -> Page:
    """For `stream`, by default standard output; a sign that it cannot show becomes another one."""
    file = beneath(sys.stdout) if stream is None else stream
    if isinstance(file, io.TextIOWrapper):
        file.reconfigure(errors="replace")
    console = TextConsole(file=file, width=width, page=None if width else _PAGE)
    shown = all(_shows(name, Signs()) for name in (console.encoding, locale.getencoding()))
    return Page(console, Signs() if shown else PLAIN)


def _shows(encoding: str, signs: Signs) -> bool:
    try:
        "".join((signs.bars, signs.rows, signs.levels, signs.marker, signs.over)).encode(encoding)
    except (UnicodeEncodeError, LookupError):
        return False
    return True


def table(*heads: str, left: int = 1) -> Table:
    """A table without lines whose first `left` columns are words, the others figures."""
    made = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0), header_style="dim")
    for place, head in enumerate(heads):
        if place < left:
            made.add_column(head, overflow="fold")
        else:
            made.add_column(head, justify="right", no_wrap=True)
    return made


def more(page: Page, left: int, one: str) -> Block:
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
