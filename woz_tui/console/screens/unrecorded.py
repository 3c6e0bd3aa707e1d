"""Going on without a record while no folder takes the log."""

from __future__ import annotations

from typing import ClassVar

from textual.binding import Binding, BindingType

from woz_tui.config.screen_language import say
from woz_tui.console.drawing.cells import Row, clean
from woz_tui.console.screens.dialog import LiveReportDialog
from woz_tui.protocol.requests import AskUnrecorded
from woz_tui.protocol.sentence import Sentence


class UnrecordedDialog(LiveReportDialog):
    """Says why nothing is played and what would help; enter plays all the same, unrecorded."""

    heading = Sentence("unrecorded.heading", "Go on without a record?")
    hint = Sentence("unrecorded.hint", "enter goes on without a record · ctrl+q closes")
    indent = 2
    BINDINGS: ClassVar[list[BindingType]] = [Binding("enter", "go_on", priority=True)]

    def lines(self) -> list[Row]:
        """What is wrong with the log, and what it means to go on."""
        recorder = self.state.session.recorder
        if recorder is None or recorder.level != "failed":
            written = say(
                "unrecorded.written", "The log is written: nothing is refused because of it."
            )
            return [((written, "good"),)]
        if recorder.waived:
            already = say("unrecorded.already", "This session goes on without a record already.")
            return [((already, "warn"),)]
        refused = say("unrecorded.refused", "Until then actions are refused. The stop is not.")
        lost = say("unrecorded.lost", "If you go on, a crash loses all that is done from here.")
        again = say("unrecorded.again", "It is recorded again as soon as a folder takes the log.")
        return [
            ((f"{self.glyphs.error} {clean(recorder.detail)}", "bad"),),
            ((clean(recorder.remedy), "plain"),),
            ((refused, "plain"),),
            ((lost, "strong"),),
            ((again, "plain"),),
        ]

    def action_go_on(self) -> None:
        """Say so; a refusal is shown above the hints."""
        if self.state.unrecorded:
            self.requests.ask(AskUnrecorded())
        self.leave()
