"""A questionnaire on the wizard's screen: read aloud, or turned to the participant."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial

from textual.app import ComposeResult
from textual.widget import Widget

from woz_tui.console.questionnaire.widget import QuestionnaireSheet, thanks
from woz_tui.console.screens.dialog import Dialog
from woz_tui.console.screens.trial import offer_due


class QuestionnaireDialog(Dialog):
    """Takes the whole screen, and shows nothing of a wizard: a participant may read it. So it
    stays when all is answered, with thanks. ctrl+q closes it, as every dialog; opened in the middle
    it goes on where it was.
    """

    heading = "Questionnaire"

    def __init__(self) -> None:
        super().__init__()
        self._shown = self._over = False

    def compose(self) -> ComposeResult:
        """Nothing but the questionnaire."""
        yield from self.body()

    def body(self) -> Iterable[Widget]:
        """The sheet."""
        app = self.console_app
        yield QuestionnaireSheet(self.requests.ask, app.clock.now_us, self.glyphs)

    def on_mount(self) -> None:
        """Begin where the questionnaire stands."""
        self.refreshed()

    def refreshed(self) -> None:
        """Follow what is asked."""
        asked, lost = self.state.study.open_questionnaire, bool(self.state.lost)
        for sheet in self.query(QuestionnaireSheet):
            words = self.state.settings.study.words
            self._over = asked is None and not lost and self.state.welcomed
            if asked is not None:
                self._shown = True
                sheet.follow(asked, words=words)
            elif self._over and self._shown:
                sheet.follow(None, thanks(words), words=words)
            elif self._over:
                self.call_later(self.leave)

    def takes_late(self, chord: str) -> bool:
        """Answers move nothing."""
        return True

    def closing(self) -> None:
        """Keep what was typed; unless a stop closed it, offer what is to be asked behind it."""
        for sheet in self.query(QuestionnaireSheet):
            sheet.keep_draft()
        leaving, self.requests.leaving = self.requests.leaving, False
        if self._over and not self.console_app.stop_pending:
            goes_on = partial(self.console_app.do, "leave") if leaving else None
            self.app.call_later(goes_on or partial(offer_due, self.console_app))
