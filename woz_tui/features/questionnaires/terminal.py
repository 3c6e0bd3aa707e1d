"""The participant's own terminal: a questionnaire when one is asked, and nothing else, ever.

No panel, no log, no sensor is drawn, and no key plays the robot; the stop works as everywhere.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from textual import events
from textual.app import ComposeResult

from woz_tui.config.keys.terminals import STOPS
from woz_tui.config.keys.textual_names import from_textual
from woz_tui.console.input.keyboard import Keyboard
from woz_tui.console.link.message_feed import GONE, Incoming, Loss, MessageFeed
from woz_tui.console.screen_app import ScreenApp
from woz_tui.features.questionnaires.answers import OpenQuestionnaire
from woz_tui.features.questionnaires.console import questionnaires_of
from woz_tui.features.questionnaires.history import DueQuestionnaire
from woz_tui.features.questionnaires.kinds import (
    AskQuestionnaire,
    QuestionnaireEnded,
    QuestionnaireStarted,
)
from woz_tui.features.questionnaires.widget import QuestionnaireSheet, Words, thanks
from woz_tui.protocol.requests import Reply, Request
from woz_tui.protocol.welcome import QuestionnaireWords

#: Leaves this screen; for whoever has set it up, so it stands nowhere on it.
LEAVE = "ctrl+q"


class ParticipantApp(ScreenApp):
    """Returns how it was left: `detached`, or `ended` with the session.

    Args:
        feed: Where messages come from and requests go.
        keyboard: Knows the stop; no other key goes past the questionnaire.
        only: Name of the one questionnaire that is shown here; empty: all.
        options: As for `ScreenApp`.
    """

    def __init__(
        self, feed: MessageFeed, keyboard: Keyboard, *, only: str = "", **options: Any
    ) -> None:
        super().__init__(feed, keyboard, **options)
        keyboard.free = False
        self._only = only
        self._waiting: dict[int, Callable[[Reply], None]] = {}
        self._thanks = False
        self._begun: DueQuestionnaire | None = None

    def compose(self) -> ComposeResult:
        """The sheet."""
        yield QuestionnaireSheet(self._ask, self.clock.now_us, self.look.glyphs)

    # -- what comes ---------------------------------------------------------------------------

    def wake(self) -> None:
        """Work in what has come and show what is asked; nothing while its parts go."""
        if not self.inbox or not self.screen_stack or not self.is_running:
            return
        for came in self.inbox.taken():
            if isinstance(came, Loss):
                self._connection_lost(came)
            else:
                self._work_in(came)
        if self.state.ended and self.state.lost:
            self.exit("ended")
        self._begin()
        lost, halted = bool(self.state.lost), self.state.session.stop is not None
        for sheet in self.query(QuestionnaireSheet):
            notice = self._words.stopped if halted else ""
            sheet.follow(
                self._open_questionnaire(),
                self._lines(),
                words=self._words,
                away=lost,
                notice=notice,
            )

    def _work_in(self, batch: list[Incoming]) -> None:
        self.state.apply(batch, self.clock.now_us())
        for message in batch:
            if isinstance(message, Reply):
                self._waiting.pop(message.ref, _nobody)(message)
            elif isinstance(message, QuestionnaireEnded):
                self._thanks = message.reason != "left"
            elif isinstance(message, QuestionnaireStarted):
                self._thanks = False

    def _begin(self) -> None:
        """Whoever waits for one questionnaire alone asks for it as soon as it is due, and once: one
        that the wizard left is still due, and it is the wizard who begins it again.
        """
        due = questionnaires_of(self.state).history.due(self.state.session)
        wanted = next((each for each in due if each.questionnaire == self._only), None)
        away = questionnaires_of(self.state).open is not None or self.state.lost
        if wanted is not None and wanted != self._begun and not away:
            request = AskQuestionnaire(questionnaire=self._only, source="participant")
            self._ask(request, self._on_begin_reply)
            self._begun = wanted
        elif wanted is None:
            self._begun = None

    def _on_begin_reply(self, reply: Reply) -> None:
        if not reply.ok and reply.reason == GONE:  # nobody knows whether it came
            self._begun = None

    def _connection_lost(self, loss: Loss) -> None:
        """No reply will come any more; what was not confirmed goes out again later."""
        self.state.lose(loss)
        waiting, self._waiting = self._waiting, {}
        for ref, on_reply in waiting.items():
            on_reply(Reply(ref=ref, ok=False, reason=GONE))

    def _open_questionnaire(self) -> OpenQuestionnaire | None:
        asked = questionnaires_of(self.state).open
        wanted = asked is not None and self._only in ("", asked.name)
        return asked if wanted else None

    @property
    def _words(self) -> QuestionnaireWords:
        return self.state.settings.study.words

    def _lines(self) -> Words:
        """What is shown while nothing is asked."""
        words = self._words
        wait: Words = [(words.wait, "strong")]
        if self.state.lost:
            lost: Words = [(words.moment, "strong"), ("", "plain"), (words.kept, "muted")]
            return thanks(words) if self._thanks else lost
        if self.state.session.stop is not None:
            return [(words.stopped, "strong"), ("", "plain"), *wait]
        return thanks(words) if self._thanks else wait

    def _ask(self, request: Request, on_reply: Callable[[Reply], None]) -> None:
        self._waiting[self.feed.ask(request)] = on_reply

    # -- keys ---------------------------------------------------------------------------------

    async def on_event(self, event: events.Event) -> None:
        """The stop and the way out pass before the questionnaire sees a key."""
        if isinstance(event, events.Key) and not event.is_forwarded:
            chord = from_textual(event.key, event.character)
            if chord in STOPS:
                self.keyboard.stop(chord)
                event.stop()
                return
            if chord == LEAVE:
                event.stop()
                self.exit("detached")
                return
        await super().on_event(event)


def _nobody(reply: Reply) -> None:
    """Nobody waits for it."""
