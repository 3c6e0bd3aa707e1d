"""One body in full size, with everything that it tells of itself."""

from __future__ import annotations

from woz_tui.config.screen_language import say
from woz_tui.console.bodies.pane import full_rows
from woz_tui.console.bodies.view import body_views
from woz_tui.console.drawing.cells import Row
from woz_tui.console.drawing.glyphs import PaintFrame
from woz_tui.console.screens.drawing import DrawingDialog
from woz_tui.console.state.driver_outlines import body_outlines
from woz_tui.protocol.sentence import Sentence


class BodyDialog(DrawingDialog):
    """Face, both views, table of values."""

    heading = Sentence("bodies.heading", "Body")
    hint = Sentence("bodies.hint", "keys play · tab: the next one · ctrl+q closes")

    def count(self) -> int:
        return len(body_outlines(self.state.outlines))

    def rows(self, chosen: int, frame: PaintFrame) -> list[Row]:
        return full_rows(body_views(self.state, frame.now, frame.glyphs)[chosen], frame)

    def nothing(self) -> str:
        """What stands there in a session without a body."""
        return say("bodies.none", "No robot of this session has a body that could be drawn.")
