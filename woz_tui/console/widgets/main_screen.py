"""Main screen: gives its parts their places and paints them.

Size and experiment file decide the places. Narrow: panels above, meters and events side by side
below. Wide: panels at the left, meters and events at the right. Roomy: the same with the events
under the panels, where their lines have room, and the order of actions with its words under the
meters.
Bodies stand with the meters: beside them where it is narrow, under them elsewhere.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

from textual.app import ComposeResult
from textual.containers import Container
from textual.geometry import Size
from textual.screen import Screen

from woz_tui.config.screen_language import say
from woz_tui.console.bodies.pane import BodyPane
from woz_tui.console.drawing.cells import Cells, Row, fit
from woz_tui.console.drawing.glyphs import Glyphs, PaintFrame
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.state.driver_outlines import body_outlines
from woz_tui.console.widgets.action_panels import ActionPanels
from woz_tui.console.widgets.bottom_rows import ActionRow, BarInfo, OrderPane, StopBar, has_order
from woz_tui.console.widgets.event_list import EventList
from woz_tui.console.widgets.feature_console import Board, FeatureConsole
from woz_tui.console.widgets.meters import Meters
from woz_tui.console.widgets.status_rows import StatusInfo, StatusLines
from woz_tui.feature import answer_of, pieces

#: From this width on meters and events stand beside the panels, in cells.
WIDE = 120
#: From this height on a wide screen is roomy, in lines.
ROOMY = 40
#: Lines of meters and events below the panels, on a low screen and on one of 32 lines or more.
SIDE, TALL_SIDE, TALL = 7, 12, 32
#: Lines of status, actions beside the panels and stop bar: without an order of actions, and with
#: what its next one says.
STATUS, ACTIONS, BAR, ORDER_BAR = 2, 1, 2, 4
#: Below this height the sentence gives way to panels, in lines.
SENTENCE_FROM = 18
#: Lines of bodies under the meters on a wide screen and on a roomy one; columns of each body, and
#: bodies at the most, beside the meters.
LOW_BODIES, BODIES, BODY_WIDTH, NARROW_BODIES = 6, 20, 14, 2
#: Columns that meters and events keep beside them, each.
SIDE_WIDTH = 32
#: Lines the events keep at least.
EVENTS = 10
#: The smallest screen with all parts, and the smallest with panels.
FULL_SIZE, LEAST_SIZE = Size(80, 24), Size(50, 12)


class Needs(NamedTuple):
    """Lines that panels and meters would like to have, headings included; how many bodies; lines
    of the stop bar.
    """

    panels: int
    meters: int
    bodies: int = 0
    bar: int = BAR


def shape(screen: Size) -> str:
    """`narrow`, `wide` or `roomy`."""
    if screen.width < WIDE or screen.height < FULL_SIZE.height:
        return "narrow"
    return "roomy" if screen.height >= ROOMY else "wide"


def bar_lines(screen: Size, order: bool) -> int:
    """Lines of the stop bar."""
    return ORDER_BAR if order and screen.height >= SENTENCE_FROM else BAR


def upper_lines(screen: Size, needs: Needs) -> int:
    """Lines of the upper row of parts; the lower row has the rest."""
    body = screen.height - STATUS - ACTIONS - needs.bar
    match shape(screen):
        case "narrow":
            return max(3, body - (TALL_SIDE if screen.height >= TALL else SIDE))
        case "wide":
            return max(3, min(needs.meters + body_lines(screen, needs) + 1, body * 3 // 5))
        case _:
            side = needs.meters + body_lines(screen, needs)
            return max(3, min(max(needs.panels, side) + 1, body - EVENTS))


def body_lines(screen: Size, needs: Needs) -> int:
    """Lines of bodies under the meters."""
    if not needs.bodies:
        return 0
    return {"narrow": 0, "wide": LOW_BODIES, "roomy": BODIES}[shape(screen)]


def body_columns(screen: Size, needs: Needs) -> int:
    """Columns of bodies beside the meters."""
    if shape(screen) != "narrow":
        return 0
    spare = max(0, screen.width - 1 - 2 * SIDE_WIDTH)
    return BODY_WIDTH * min(needs.bodies, NARROW_BODIES, spare // BODY_WIDTH)


class SidePane(Container):
    """Meters and bodies."""

    def lay_out(self, lines: int, columns: int) -> None:
        """Give the bodies their place: lines under the meters, or columns beside them."""
        bodies = self.query_one("BodyPane")
        bodies.display = bool(lines or columns)
        self.set_class(bool(columns), "-beside")
        bodies.styles.height = lines or "100%"
        bodies.styles.width = columns or "100%"


class MainArea(Container):
    """All between the status line and the stop bar."""

    _laid_out: tuple[object, ...] | None = None

    def lay_out(self, screen: Size, needs: Needs) -> None:
        """Give every part its place."""
        below, beside = body_lines(screen, needs), body_columns(screen, needs)
        wanted = (shape(screen), upper_lines(screen, needs), below, beside and screen.width)
        if wanted == self._laid_out:
            return
        self._laid_out = wanted
        for name in ("narrow", "wide", "roomy"):
            self.set_class(name == wanted[0], f"-{name}")
        self.styles.grid_rows = f"{wanted[1]} 1fr"
        columns = f"{(screen.width + beside) // 2} 1fr" if beside else "1fr 1fr"
        self.styles.grid_columns = columns if wanted[0] == "narrow" else "1fr 50"
        self.query_one(SidePane).lay_out(below, beside)


class FeatureBoard(Cells):
    """What a feature shows above the panels, while it shows anything there."""

    def __init__(self, feature: str, board: Board) -> None:
        super().__init__()
        self._feature, self._board = feature, board

    def measure(self, lines: int, state: ConsoleState) -> int:
        """Take the lines that it needs on a screen of so many; how many these are."""
        needed = answer_of(self._feature, 0, self._board.lines, state, lines)
        self.display = needed > 0
        self.styles.height = needed or 1
        return needed

    def paint(self, state: ConsoleState, frame: PaintFrame) -> None:
        """Show it, in the middle."""
        nothing: Sequence[Row] = ()
        rows = answer_of(self._feature, nothing, self._board.rows, state, frame)
        above: list[Row] = [()] * max(0, (frame.height - len(rows)) // 2)
        self.show([*above, *rows])


class MainScreen:
    """Status on top, panels, meters and bodies, events, order, actions, stop bar."""

    def __init__(self, bar: StopBar | None = None) -> None:
        self.status = StatusLines()
        self.boards = [
            FeatureBoard(name, each.board)
            for name, each in pieces("console", FeatureConsole).items()
            if each.board is not None
        ]
        self.panels = ActionPanels()
        self.meters = Meters()
        self.bodies = BodyPane()
        self.events = EventList()
        self.order = OrderPane()
        self.actions = ActionRow()
        self.bar = bar or StopBar()
        self.small = Cells(id="small")
        self.body = MainArea()
        self.side = SidePane()

    def compose(self) -> ComposeResult:
        """All widgets in their order."""
        yield from (self.status, *self.boards)
        with self.body:
            yield self.panels
            with self.side:
                yield from (self.meters, self.bodies)
            yield from (self.events, self.order)
        yield self.small
        yield self.actions
        yield self.bar

    def measure(
        self, size: Size, base: Screen[object], state: ConsoleState, glyphs: Glyphs
    ) -> None:
        """Choose what fits: everything, no side, or a sentence and the stop."""
        width, height = size
        base.set_class(width < FULL_SIZE.width or height < FULL_SIZE.height, "-small")
        base.set_class(width < LEAST_SIZE.width or height < LEAST_SIZE.height, "-tiny")
        lines = bar_lines(size, has_order(state))
        if self.bar.styles.height is None or self.bar.styles.height.value != lines:
            self.bar.styles.height = lines
        above = sum(board.measure(height, state) for board in self.boards)
        self.body.lay_out(
            Size(width, height - above),
            Needs(
                self.panels.needs(state, glyphs),
                self.meters.needs,
                len(body_outlines(state.outlines)),
                lines,
            ),
        )

    def paint(
        self, state: ConsoleState, screen: PaintFrame, line: StatusInfo, bar: BarInfo
    ) -> None:
        now, glyphs = screen.now, screen.glyphs
        self.status.paint(state, self.status.frame(now, glyphs), line)
        for board in self.boards:
            if board.display:
                board.paint(state, board.frame(now, glyphs))
        parts = (self.panels, self.meters, self.bodies, self.events, self.order, self.actions)
        for part in parts:
            part.paint(state, part.frame(now, glyphs))
        bar = replace(bar, page=self.panels.page)
        self.bar.paint(state, self.bar.frame(now, glyphs), bar)
        small = say(
            "rows.small",
            "{width} x {height} is small: meters need 80 x 24, keys and stop do not",
            width=screen.width,
            height=screen.height,
        )
        self.small.show([((fit(f" {small}", screen.width, glyphs.ellipsis), "warn"),)])
