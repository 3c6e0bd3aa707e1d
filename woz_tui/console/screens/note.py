"""A note for the log."""

from __future__ import annotations

from typing import ClassVar

from woz_tui.console.screens.dialog import EntryDialog
from woz_tui.protocol.requests import AskNote, Reply
from woz_tui.protocol.sentence import Sentence


class NoteDialog(EntryDialog):
    """Type a sentence; it goes into the log with the moment at which it is sent. One that was not
    taken is in the field the next time.
    """

    heading: str = Sentence("note.heading", "Note")
    hint: ClassVar[str] = Sentence("note.hint", "enter writes it · ctrl+q closes")
    placeholder: ClassVar[str] = Sentence("note.what", "what you saw (codes, no names)")

    def submit(self, text: str) -> None:
        def answered(reply: Reply) -> None:
            if not reply.ok:
                self.requests.drafts[self.draft] = self.requests.drafts.get(self.draft) or text
            self.requests.refused(reply)

        self.requests.ask(AskNote(text=text), answered)
