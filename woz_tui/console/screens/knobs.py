"""The MIDI panel as it lies on the table: where each control stands, what it does, what waits."""

from __future__ import annotations

from dataclasses import replace

from woz_tui.config.screen_language import say, word
from woz_tui.console.bodies.midi_panel import PanelState, panel_rows
from woz_tui.console.drawing.cells import Row, clean
from woz_tui.console.drawing.glyphs import PaintFrame
from woz_tui.console.drawing.number_text import age
from woz_tui.console.screens.drawing import DrawingDialog
from woz_tui.console.state.driver_outlines import panel_outlines
from woz_tui.protocol.messages import ControlsMoved
from woz_tui.protocol.sentence import Sentence


class KnobsDialog(DrawingDialog):
    """One panel."""

    heading = Sentence("knobs.heading", "MIDI panel")
    hint = Sentence("knobs.hint", "keys play · tab: the next panel · ctrl+q closes")

    def count(self) -> int:
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
        driver, old = self.state.drivers.get(outline.driver), ""
        if self.state.lost:
            old = word(self.state.lost.part.sentence)
        elif driver is not None and driver.health == "lost":
            old = say("knobs.lost", "lost {age} ago", age=age(frame.now - driver.t))
        inner = replace(frame, height=frame.height - 1)
        return [title, *panel_rows(PanelState(outline, knobs, old), inner)]

    def nothing(self) -> str:
        """What stands there in a session without a panel."""
        none = say("knobs.none", "No MIDI panel belongs to this session.")
        how = say("knobs.how", "A robot gets one by a line among the drivers of its file:")
        return f"{none}\n{how}\n  panel: {{type: midi}}"
