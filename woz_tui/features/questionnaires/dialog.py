"""A questionnaire on the wizard's screen: read aloud, or turned to the participant."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial

from textual.app import ComposeResult
from textual.content import Content
from textual.widget import Widget

from woz_tui.config.languages import NAMES
from woz_tui.config.screen_language import say
from woz_tui.console.drawing.cells import Row, clean
from woz_tui.console.screens.choice import ChoiceDialog, ListChoice
from woz_tui.console.screens.dialog import ConsoleApp, Dialog
from woz_tui.features.questionnaires.console import offered, questionnaires_of
from woz_tui.features.questionnaires.kinds import AskQuestionnaire
from woz_tui.features.questionnaires.widget import QuestionnaireSheet, thanks
from woz_tui.protocol.requests import Reply
from woz_tui.protocol.sentence import Sentence


class QuestionnaireDialog(Dialog):
    """Takes the whole screen, and shows nothing of a wizard: a participant may read it. So it
    stays when all is answered, with thanks. ctrl+q closes it, as every dialog; opened in the middle
    it goes on where it was.
    """

    heading = Sentence("questionnaires.heading", "Questionnaire")

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
        asked, lost = questionnaires_of(self.state).open, bool(self.state.lost)
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
            self.app.call_later(goes_on or partial(_offer_next, self.console_app))


class OfferDialog(ChoiceDialog):
    """A questionnaire is due: ask it now, or later."""

    heading = Sentence("questionnaires.heading", "Questionnaire")
    hint = Sentence("questionnaires.keys", "arrows choose · enter · ctrl+q: later")

    def __init__(self, name: str) -> None:
        super().__init__()
        self._asked = name

    def lines(self) -> list[Row]:
        """Which one."""
        notes = questionnaires_of(self.state)
        one, title = notes.called(self._asked), notes.title(self._asked)
        items = sum(item.asks != "page" for item in one.items) if one is not None else 0
        count = say("questionnaires.items", "{count} items", one="1 item", count=items)
        back = say(
            "questionnaires.covers", "It covers this screen; ctrl+q brings the console back."
        )
        behind = f"  {count}" if items else ""
        return [((clean(title), "strong"), (behind, "muted")), ((back, "plain"),)]

    def choices(self) -> list[ListChoice]:
        """Where to ask it, and who answers: that is in the tables."""
        ask = partial(_ask, self.console_app, self._asked)
        there = say("questionnaires.ask_there", "At the participant's terminal")
        aloud = say("questionnaires.read_aloud", "Ask it here: I read it aloud")
        turned = say("questionnaires.turn_screen", "Ask it here: I turn the screen round")
        terminal = ListChoice(Content(there), partial(ask, here=False))
        return [
            ListChoice(Content(aloud), partial(ask, given="read_aloud")),
            ListChoice(Content(turned), partial(ask, given="self")),
            *([terminal] if self.state.study.participants else []),
            ListChoice(Content(say("questionnaires.later", "Later"))),
        ]


class LanguageDialog(ChoiceDialog):
    """A questionnaire is in several languages: which one the participant reads."""

    heading = Sentence("questionnaires.heading", "Questionnaire")
    hint = Sentence("questionnaires.keys", "arrows choose · enter · ctrl+q: later")

    def __init__(self, name: str, put: Callable[[str], None]) -> None:
        super().__init__()
        self._asked, self._put = name, put

    def lines(self) -> list[Row]:
        """Which one."""
        title = questionnaires_of(self.state).title(self._asked)
        which = say("questionnaires.which_language", "In which language?")
        return [((clean(title), "strong"),), ((which, "plain"),)]

    def choices(self) -> list[ListChoice]:
        """The languages of the file, that of the experiment first."""
        one = questionnaires_of(self.state).called(self._asked)
        codes = [one.language, *(each.language for each in one.versions)] if one else []
        return [
            ListChoice(Content(NAMES.get(code, code)), partial(self._put, code)) for code in codes
        ]


def _ask(app: ConsoleApp, name: str, *, here: bool = True, given: str = "") -> None:
    """Put a questionnaire to the participant, at this terminal or at theirs."""

    def answered(reply: Reply) -> None:
        app.requests.refused(reply)
        if reply.ok and here:
            app.open_dialog(QuestionnaireDialog())

    def put(language: str) -> None:
        request = AskQuestionnaire(questionnaire=name, language=language, given=given)
        app.requests.ask(request, answered)

    one = questionnaires_of(app.state).called(name)
    if one is not None and one.versions:
        app.open_dialog(LanguageDialog(name, put))
    else:
        put("")


def _offer_next(app: ConsoleApp) -> None:
    if (step := offered(app.state)) is not None:
        app.open_dialog(OfferDialog(step.about))
