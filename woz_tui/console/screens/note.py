"""A note for the log."""

from __future__ import annotations

from textual.widgets import Input

from woz_tui.console.screens.dialog import EntryDialog
from woz_tui.protocol.requests import AskNote


class NoteDialog(EntryDialog):
    """Type a sentence; it goes into the log with the moment at which it is sent."""

    heading = "Note"
    hint = "enter writes it · ctrl+q closes"
    placeholder = "what you saw (codes, no names)"

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Send it; an empty one only closes."""
        event.stop()
        text = event.value.strip()
        if text:
            self.requests.ask(AskNote(text=text))
        self.sent()
