"""A note for the log."""

from __future__ import annotations

from woz_tui.console.screens.dialog import EntryDialog
from woz_tui.protocol.requests import AskNote


class NoteDialog(EntryDialog):
    """Type a sentence; it goes into the log with the moment at which it is sent."""

    heading = "Note"
    hint = "enter writes it · ctrl+q closes"
    placeholder = "what you saw (codes, no names)"

    def submit(self, text: str) -> None:
        """Send it."""
        self.requests.ask(AskNote(text=text))
