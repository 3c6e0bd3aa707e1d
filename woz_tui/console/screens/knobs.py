"""The MIDI panel as it lies on the table: where each control stands, what it does, what waits."""

from __future__ import annotations

from woz_tui.console.bodies.midi_panel import PanelState, panel_rows
from woz_tui.console.drawing.cells import Row, clean
from woz_tui.console.drawing.glyphs import PaintFrame
from woz_tui.console.drawing.number_text import age
from woz_tui.console.screens.drawing import DrawingDialog
from woz_tui.console.state.driver_outlines import PanelOutline, panel_outlines
from woz_tui.protocol.messages import ControlsMoved


class KnobsDialog(DrawingDialog):
    """One panel."""

    heading = "MIDI panel"
    hint = "keys play · tab: the next panel · ctrl+q closes"

    def count(self) -> int:
        """Panels of the session."""
        return len(panel_outlines(self.state.outlines))

    def rows(self, chosen: int, frame: PaintFrame) -> list[Row]:
        """The chosen panel with its name."""
        outline = panel_outlines(self.state.outlines)[chosen]
        moved = self.state.session.controls.get(outline.driver)
        knobs = moved or ControlsMoved(driver=outline.driver, values={})
        title: Row = (
            (clean(outline.driver), "title"),
            (f"  {clean(outline.name)}", "muted"),
        )
        inner = PaintFrame(frame.width, frame.height - 1, frame.now, frame.glyphs)
        return [title, *panel_rows(PanelState(outline, knobs, self._old(outline, frame)), inner)]

    def _old(self, outline: PanelOutline, frame: PaintFrame) -> str:
        driver = self.state.drivers.get(outline.driver)
        if self.state.lost:
            return self.state.lost.part.sentence
        if driver is None or driver.health != "lost":
            return ""
        return f"lost {age(frame.now - driver.t)} ago"

    def nothing(self) -> str:
        """What stands there in a session without a panel."""
        return (
            "No MIDI panel belongs to this session.\n"
            "A robot gets one by a line among the drivers of its file:\n"
            "  panel: {type: midi}"
        )
