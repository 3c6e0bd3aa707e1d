"""Widgets that draw a picture: half blocks, kitty's placeholders, sixels over blank cells."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import ClassVar

from rich.color import Color
from rich.console import RenderableType
from rich.segment import Segment
from rich.style import Style
from textual._compositor import ChopsUpdate
from textual.filter import LineFilter
from textual.geometry import Region
from textual.strip import Strip
from textual.widget import Widget

from woz_tui.config.screen_language import say
from woz_tui.console.camera import kitty
from woz_tui.console.camera.half_blocks import HalfBlockCanvas, style
from woz_tui.console.camera.picture_sizes import CellArea, resized, shrunk_size, unpacked
from woz_tui.console.camera.picture_terminal import PictureTerminal
from woz_tui.protocol.camera_pictures import PictureFormat, PictureShown

#: Upper half of a cell in its foreground's colour, lower half in that of its background.
_HALF = "▀"
#: Bytes that a pixel costs before the first picture has told.
_PIXEL_BYTES = 1.2


class PictureView(Widget):
    """A picture in `room`. Subclasses say in which format they want it."""

    can_focus = False
    format: ClassVar[PictureFormat] = "rgb"
    #: How it draws, for the wizard.
    word: str = ""

    def __init__(self) -> None:
        super().__init__()
        self.room = CellArea(1, 1)
        self._painted: Callable[[], None] | None = None

    def after_painting(self, call: Callable[[], None]) -> None:
        """Call back when Textual has written what `show` changed. Its own `call_after_refresh` may
        come before: a widget's changes take a detour through its screen.
        """
        self._painted = call

    def place(self, room: CellArea) -> None:
        """Take other cells; what was drawn is gone."""
        self.room = room
        self.styles.width, self.styles.height = room.columns, room.rows
        self.clear()

    def wanted_size(self, allowance: int) -> tuple[int, int]:
        """Pixels to ask for, if a picture may cost `allowance` bytes."""
        raise NotImplementedError

    def show(self, shown: PictureShown, allowance: int) -> bool:
        """Draw a picture, or as much of it as `allowance` bytes reach; whether there is anything
        for Textual to paint. Raises `PictureError`.
        """
        raise NotImplementedError

    def settled(self) -> None:
        """What `show` changed has been painted; called after each picture."""

    def displayed(self, update: RenderableType | None) -> None:
        """Textual has written `update` to the terminal."""

    def clear(self) -> None:
        """Draw nothing: no picture fits any more, something lies over it, or the screen closes."""
        raise NotImplementedError

    def get_line_filters(self) -> Sequence[LineFilter]:
        """None: colours are a terminal's own numbers here, and placeholders' names."""
        return ()

    def render_line(self, y: int) -> Strip:
        """One line; Textual writes it in the same breath."""
        painted, self._painted = self._painted, None
        if painted is not None:
            self.call_later(painted)
        return self.line(y)

    def line(self, y: int) -> Strip:
        raise NotImplementedError


class HalfBlockView(PictureView):
    """Two pixels a cell; without colours signs for how bright they are.

    Args:
        depth: Colours of the terminal: 1 << 24, 256, 16, or 0 for signs of ASCII.
    """

    def __init__(self, depth: int) -> None:
        super().__init__()
        self._canvas = HalfBlockCanvas(1, 1, depth)
        self._strips: dict[int, Strip] = {}
        self.word = (
            say("camera.half_blocks", "half blocks") if depth else say("camera.signs", "signs")
        )

    @property
    def canvas(self) -> HalfBlockCanvas:
        return self._canvas

    def wanted_size(self, allowance: int) -> tuple[int, int]:
        """Two pixels a cell: a slow line gets fewer of the cells at a time instead."""
        return self._canvas.size

    def show(self, shown: PictureShown, allowance: int) -> bool:
        """Paint the cells that have changed, the worst first."""
        canvas = self._canvas
        pixels = resized(unpacked(shown), shown.width, shown.height, *canvas.size)
        painted = canvas.paint(pixels, allowance)
        for region in painted:
            self._strips.pop(region.y, None)
        if painted:
            self.refresh(*painted)
        return bool(painted)

    def clear(self) -> None:
        """All black."""
        self._canvas = HalfBlockCanvas(self.room.columns, self.room.rows, self._canvas.colours)
        self._strips.clear()
        self.refresh()

    def line(self, y: int) -> Strip:
        """One line, cells of the same colours in one piece."""
        if y not in self._strips:
            self._strips[y] = self._strip(y)
        return self._strips[y]

    def _strip(self, y: int) -> Strip:
        canvas = self._canvas
        if y >= canvas.rows:
            return Strip.blank(self.size.width)
        if not canvas.colours:
            text = "".join(canvas.sign(x, y) for x in range(canvas.columns))
            return Strip([Segment(text)], len(text))
        segments: list[Segment] = []
        begin = 0
        for x in range(1, canvas.columns + 1):
            upper, lower = canvas.cell(begin, y)
            if x < canvas.columns and canvas.cell(x, y) == (upper, lower):
                continue
            sign = " " if upper == lower else _HALF
            painted = style(upper, lower, canvas.colours)
            segments.append(Segment(sign * (x - begin), painted))
            begin = x
        return Strip(segments, canvas.columns)


class SentView(PictureView):
    """A picture that the terminal draws itself, sent past Textual as a file.

    Args:
        terminal: The terminal.
    """

    def __init__(self, terminal: PictureTerminal) -> None:
        super().__init__()
        self._terminal = terminal
        self._bytes = _PIXEL_BYTES

    def wanted_size(self, allowance: int) -> tuple[int, int]:
        """All pixels of the cells; a slow line gets fewer."""
        return shrunk_size(*self.room.pixels, allowance / self._bytes)

    def learn_size(self, shown: PictureShown) -> None:
        """Take note what a pixel costs."""
        self._bytes = max(0.02, len(shown.data) / max(1, shown.width * shown.height))


class KittyView(SentView):
    """Placeholders, and beneath them the picture: two names take turns, so that nothing flickers.

    The terminal enlarges what has fewer pixels than its cells.

    Args:
        terminal: The terminal.
        tmux: Whether every sequence goes in tmux's envelope.
    """

    format: ClassVar[PictureFormat] = "png"
    word = "kitty"

    def __init__(self, terminal: PictureTerminal, tmux: bool = False) -> None:
        super().__init__(terminal)
        self._tmux = tmux
        self._turn = 0
        self._drawn = 0  # 0: nothing is shown

    def wanted_size(self, allowance: int) -> tuple[int, int]:
        """The placeholders cost something, too."""
        cells = 4 * self.room.columns * self.room.rows
        return super().wanted_size(max(1_000, allowance - cells))

    def show(self, shown: PictureShown, allowance: int) -> bool:
        """Send the picture under the name that is not shown, then change the names."""
        self._turn = 1 - self._turn
        name = kitty.NAMES[self._turn]
        if not self._write(kitty.transmission(name, self.room.columns, self.room.rows, shown.data)):
            return False
        self.learn_size(shown)
        self._drawn = name
        self.refresh()
        return True

    def settled(self) -> None:
        """The picture before is not shown any more: let go of it."""
        if self._drawn:
            self._write(kitty.deletion(*(name for name in kitty.NAMES if name != self._drawn)))

    def clear(self) -> None:
        """Blank cells, no pictures in the terminal's memory."""
        if self._drawn:
            self._drawn = 0
            self._write(kitty.deletion(*kitty.NAMES))
        self.refresh()

    def _write(self, text: str) -> bool:
        return self._terminal.write(kitty.tmux_passthrough(text) if self._tmux else text)

    def line(self, y: int) -> Strip:
        """A line of placeholders in the colour that is the picture's name."""
        width = self.size.width
        if not self._drawn or y >= min(self.room.rows, kitty.MOST_ROWS):
            return Strip.blank(width)
        text = kitty.placeholders(y, self.room.columns)
        named = Style.from_color(Color.from_ansi(self._drawn))
        return Strip([Segment(text, named)], self.room.columns)


class SixelView(SentView):
    """Blank cells to Textual, and the picture drawn over them when it has painted; a smaller one
    in their middle.
    """

    format: ClassVar[PictureFormat] = "sixel"
    word = "sixel"

    def __init__(self, terminal: PictureTerminal) -> None:
        super().__init__(terminal)
        self._data = ""
        self._due = False

    def show(self, shown: PictureShown, allowance: int) -> bool:
        """Draw over the last one, once Textual has painted."""
        wide, high = self.room.cell
        left = (self.room.columns - shown.width / wide) / 2
        top = (self.room.rows - shown.height / high) / 2
        region = self.content_region
        column, row = region.x + max(0, int(left)) + 1, region.y + max(0, int(top)) + 1
        self.learn_size(shown)
        # Saved and restored: Textual goes on where the cursor was.
        self._data = f"\x1b7\x1b[{row};{column}H{shown.data}\x1b8"
        self._due = True
        return False

    def settled(self) -> None:
        """Draw what is due."""
        if self._due and self._data:
            self._due = not self._terminal.write(self._data)

    def clear(self) -> None:
        """Have the cells painted again: blanks erase what is drawn over them."""
        self._data, self._due = "", False
        if self.is_attached:
            self.app.refresh()

    def line(self, y: int) -> Strip:
        return Strip.blank(self.size.width)

    def displayed(self, update: RenderableType | None) -> None:
        """Blanks that were painted have erased the picture: it is drawn again behind them."""
        if self._data and not self._due and _touches(update, self.content_region):
            self._due = True
            self.call_later(self.settled)


def _touches(update: RenderableType | None, region: Region) -> bool:
    """Whether an update has painted any of the cells of `region`."""
    if isinstance(update, ChopsUpdate):
        return any(
            region.y <= y < region.bottom and begin < region.right and end > region.x
            for y, begin, end in update.spans
        )
    return update is not None


#: Colours of Rich's colour systems.
_DEPTHS = {"truecolor": 1 << 24, "256": 256, "standard": 16, "windows": 16}


def depth_of(system: str | None, *, plain: bool) -> int:
    """Colours of Rich's colour system; none where only ASCII or no colour may be drawn."""
    return 0 if plain else _DEPTHS.get(system or "", 0)


def view_for(
    method: str, depth: int, terminal: PictureTerminal | None, multiplexer: str
) -> PictureView:
    """A widget that draws by `method`; `auto`: by what the terminal can do.

    `depth`: the terminal's colours (0: only signs of ASCII). `terminal`: None if there is none.
    `multiplexer`: `tmux`, `screen` or nothing in between. Half blocks are always right. tmux
    answers in its terminal's place without being one that draws, so behind it pictures come only
    to who asks for them.
    """
    if terminal is not None and depth >= 256:
        direct = method == "auto" and not multiplexer
        if method == "kitty" or (direct and terminal.kitty):
            return KittyView(terminal, tmux=multiplexer == "tmux")
        if method == "sixel" or (direct and terminal.sixel and terminal.cell is not None):
            return SixelView(terminal)
    return HalfBlockView(depth)
