"""The row of moves that save a dialogue, above the script's line on every page."""

from __future__ import annotations

from woz_tui.console.cells import Cells
from woz_tui.console.glyphs import Frame
from woz_tui.console.state import ConsoleState


class Repairs(Cells):
    """One row."""

    def paint(self, picture: ConsoleState, frame: Frame) -> None:
        """Show it."""
        self.show([((" " * frame.width, "plain"),)])
