"""The main screen's parts: put together, given their places, painted from the picture."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

from textual.app import ComposeResult
from textual.geometry import Size
from textual.screen import Screen

from woz_tui.console.action_panels import ActionPanels
from woz_tui.console.bodies.bodies_pane import BodyPane
from woz_tui.console.bodies.driver_outlines import body_outlines
from woz_tui.console.bottom_rows import BarInfo, StopBar
from woz_tui.console.cells import Cells, fit
from woz_tui.console.console_state import ConsoleState
from woz_tui.console.event_list import EventList
from woz_tui.console.glyphs import Glyphs, PaintFrame
from woz_tui.console.meters import Meters
from woz_tui.console.repair_row import RepairRow
from woz_tui.console.screen_layout import (
    FULL_SIZE,
    LEAST_SIZE,
    MainArea,
    Needs,
    SidePane,
    bar_lines,
)
from woz_tui.console.script_row import ScriptPane
from woz_tui.console.status_rows import StatusInfo, StatusLines
from woz_tui.console.training_row import CueBoard, cue_lines

SMALL = "{0} x {1} is small: meters need 80 x 24, keys and stop do not"


@dataclass(slots=True)
class MainScreen:
    """Status on top, panels, meters and bodies, events, script, repairs, stop bar."""

    status: StatusLines = field(default_factory=StatusLines)
    cue: CueBoard = field(default_factory=CueBoard)
    panels: ActionPanels = field(default_factory=ActionPanels)
    meters: Meters = field(default_factory=Meters)
    bodies: BodyPane = field(default_factory=BodyPane)
    events: EventList = field(default_factory=EventList)
    script: ScriptPane = field(default_factory=ScriptPane)
    repairs: RepairRow = field(default_factory=RepairRow)
    bar: StopBar = field(default_factory=StopBar)
    small: Cells = field(default_factory=lambda: Cells(id="small"))
    body: MainArea = field(default_factory=MainArea)
    side: SidePane = field(default_factory=SidePane)

    def compose(self) -> ComposeResult:
        """All widgets in their order."""
        yield from (self.status, self.cue)
        with self.body:
            yield self.panels
            with self.side:
                yield from (self.meters, self.bodies)
            yield from (self.events, self.script)
        yield self.small
        yield self.repairs
        yield self.bar

    def measure(
        self, size: Size, base: Screen[object], picture: ConsoleState, glyphs: Glyphs
    ) -> None:
        """Choose what fits: everything, no side, or a sentence and the stop."""
        width, height = size
        base.set_class(width < FULL_SIZE.width or height < FULL_SIZE.height, "-small")
        base.set_class(width < LEAST_SIZE.width or height < LEAST_SIZE.height, "-tiny")
        lines = bar_lines(size, any(picture.scripts.values()))
        if self.bar.styles.height is None or self.bar.styles.height.value != lines:
            self.bar.styles.height = lines
        cue = cue_lines(size, picture)
        self.cue.display = cue > 0
        self.cue.styles.height = cue or 1
        self.body.lay_out(
            Size(width, height - cue),
            Needs(
                self.panels.needs(picture, glyphs),
                self.meters.needs,
                len(body_outlines(picture.outlines)),
                lines,
            ),
        )

    def paint(
        self,
        picture: ConsoleState,
        frame: Callable[[Cells], PaintFrame],
        line: StatusInfo,
        bar: BarInfo,
        size: Size,
    ) -> None:
        """Show what has changed; `frame` tells each part's room and the moment."""
        self.status.paint(picture, frame(self.status), line)
        if self.cue.display:
            self.cue.paint(picture, frame(self.cue))
        parts = (self.panels, self.meters, self.bodies, self.events, self.script, self.repairs)
        for part in parts:
            part.paint(picture, frame(part))
        self.bar.paint(picture, frame(self.bar), replace(bar, page=self.panels.page))
        ellipsis = frame(self.small).glyphs.ellipsis
        self.small.show([((fit(f" {SMALL.format(*size)}", size.width, ellipsis), "warn"),)])
