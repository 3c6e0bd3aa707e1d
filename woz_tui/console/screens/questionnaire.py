"""A questionnaire on the wizard's screen: read aloud, or turned to the participant."""

from __future__ import annotations

from collections.abc import Iterable

from textual.app import ComposeResult
from textual.widget import Widget

from woz_tui.console.screens.dialog import Dialog
from woz_tui.console.screens.trial import offer_due
from woz_tui.console.study.sheet import Sheet

#: The hint beneath the keys.
LEAVE = "wizard: ctrl+q closes this; it goes on where it was"


class QuestionnaireDialog(Dialog):
    """Takes the whole screen. Closed in the middle it goes on where it was when it is opened."""

    heading = "Questionnaire"

    def compose(self) -> ComposeResult:
        """Nothing but the questionnaire."""
        yield from self.body()

    def body(self) -> Iterable[Widget]:
        """The sheet."""
        app = self.console_app
        yield Sheet(self.desk.ask, app.clock.now_us, self.glyphs, LEAVE)

    def on_mount(self) -> None:
        """Begin where the questionnaire stands."""
        self.refreshed()

    def refreshed(self) -> None:
        """Follow what is asked; when it is over, so is this."""
        asked, lost = self.picture.study.asked, bool(self.picture.lost)
        for sheet in self.query(Sheet):
            if asked is None and not lost and self.picture.welcomed:
                self.call_later(self._over)
            elif asked is not None:
                sheet.follow(asked)

    def _over(self) -> None:
        """What is to be asked behind it is offered."""
        self.leave()
        offer_due(self.console_app)
