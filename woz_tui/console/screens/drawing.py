"""A dialog that draws instead of writing: as large as the screen allows, alive while it is open.

The robot is played meanwhile: whoever looks at its face in full size wants to see what a key does.
"""

from __future__ import annotations

from collections.abc import Iterable

from textual import events
from textual.widget import Widget

from woz_tui.console.drawing.cells import Cells, Row
from woz_tui.console.drawing.glyphs import PaintFrame
from woz_tui.console.screens.dialog import Dialog

_NEXT, _BACK = "tab", "shift+tab"


class DrawingDialog(Dialog):
    """One of several drawings; tab shows the next."""

    size_class = "drawing"
    plays = True
    own_keys = frozenset((_NEXT, _BACK))

    def __init__(self) -> None:
        super().__init__()
        self._chosen = 0

    def body(self) -> Iterable[Widget]:
        """Cells as large as the frame."""
        yield Cells(id="drawing")

    def count(self) -> int:
        """How many there are to choose from."""
        raise NotImplementedError

    def rows(self, chosen: int, frame: PaintFrame) -> list[Row]:
        """Draw one of them; `chosen` counts from 0 and is below `count`."""
        raise NotImplementedError

    def nothing(self) -> str:
        """What stands there if there are none; short lines."""
        raise NotImplementedError

    def on_key(self, event: events.Key) -> None:
        by = (event.key == _NEXT) - (event.key == _BACK)
        if by:
            event.stop()
            self._chosen += by
            self.refreshed()

    def refreshed(self) -> None:
        for cells in self.query("#drawing").results(Cells):
            frame = cells.frame(self.now, self.glyphs)
            if count := self.count():
                cells.show(self.rows(self._chosen % count, frame))
            else:
                cells.show([((line, "muted"),) for line in self.nothing().splitlines()])
