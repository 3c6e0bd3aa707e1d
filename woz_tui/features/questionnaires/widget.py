"""The questionnaire as a widget, for the wizard's dialog and for the participant's own terminal."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from textual import events
from textual.app import ComposeResult
from textual.containers import Vertical
from textual.message import Message
from textual.widgets import TextArea

from woz_tui.console.drawing.cells import Cells
from woz_tui.console.drawing.glyphs import Glyphs
from woz_tui.console.link.message_feed import GONE
from woz_tui.features.questionnaires.answers import OpenQuestionnaire
from woz_tui.features.questionnaires.items import ItemAnswer
from woz_tui.features.questionnaires.kinds import AskAnswer, AskQuestionnaire
from woz_tui.features.questionnaires.pages import (
    column_of,
    foot_rows,
    page_rows,
    question_height,
    words_rows,
)
from woz_tui.features.questionnaires.run import QuestionnaireRun
from woz_tui.protocol.requests import Reply
from woz_tui.protocol.welcome import ENGLISH, QuestionnaireWords

#: Sends a request; the reply comes later, in the screen's thread.
Ask = Callable[[AskAnswer | AskQuestionnaire, Callable[[Reply], None]], None]
#: What is shown while nothing is asked: sentences with their looks.
Words = list[tuple[str, str]]


#: Lines of the field with its border, where there is room, and where there is little.
_FIELD, _FIELD_LEAST = 8, 3
#: Lines of the keys at the bottom.
_FOOT = 3


def thanks(words: QuestionnaireWords) -> Words:
    """What stands there once it has been answered."""
    return [(words.thanks, "strong"), ("", "plain"), (words.wait, "muted")]


class AnswerField(TextArea):
    """A field for a sentence or some. Enter goes on; the way back is over its first line.

    `idle` is asked once for each key, whether it is to do nothing at this moment.
    """

    class Submitted(Message):
        """Enter was pressed."""

    class KeyPassed(Message):
        """A key for the questionnaire, not for the field."""

        def __init__(self, key: str) -> None:
            super().__init__()
            self.key = key

    def __init__(self, idle: Callable[[str], bool], **options: Any) -> None:
        super().__init__(soft_wrap=True, show_line_numbers=False, **options)
        self._idle = idle

    async def _on_key(self, event: events.Key) -> None:
        if self._idle(event.key):
            event.stop()
            event.prevent_default()
        elif event.key == "enter":
            self._post(event, self.Submitted())
        elif event.key in ("tab", "ctrl+d") or self._goes_back(event.key):
            self._post(event, self.KeyPassed(event.key))
        else:
            await super()._on_key(event)

    def _goes_back(self, key: str) -> bool:
        """Up on the first line, backspace where nothing is written."""
        if key == "backspace":
            return not self.text
        return key == "up" and self.wrapped_document.location_to_offset(self.cursor_location).y == 0

    def _post(self, event: events.Key, message: Message) -> None:
        event.stop()
        event.prevent_default()
        self.post_message(message)


class QuestionnaireSheet(Vertical):
    """Pages above, a field for texts, keys at the bottom.

    Args:
        ask: Sends a request.
        now_us: A clock that goes on evenly, in microseconds.
        glyphs: The terminal's signs.
    """

    can_focus = True

    def __init__(self, ask: Ask, now_us: Callable[[], int], glyphs: Glyphs) -> None:
        super().__init__(id="sheet")
        self._ask = ask
        self._now_us = now_us
        self._glyphs = glyphs
        #: The way through the questionnaire, while one is asked.
        self.run: QuestionnaireRun | None = None
        self._lines: Words = []
        self._words = ENGLISH
        #: The item for whose text the field is shown, of which run, and its answer by then.
        self._field_item = ""
        self._field_run: QuestionnaireRun | None = None
        self._field_answer: ItemAnswer | None = None
        self._field_height = _FIELD
        self._kept: QuestionnaireRun | None = None
        self._away = False
        self._notice = ""

    def compose(self) -> ComposeResult:
        """Page, field, keys."""
        yield Cells(id="page")
        field = AnswerField(self._idle, id="written")
        field.display = False
        yield field
        yield Cells(id="foot")

    def on_mount(self) -> None:
        """Take the keys; it is drawn as soon as its parts have their sizes."""
        self.focus()

    def on_cells_resized(self) -> None:
        """Draw in the new size."""
        self.draw()

    # -- what is asked ------------------------------------------------------------------------

    def follow(
        self,
        asked: OpenQuestionnaire | None,
        lines: Words | None = None,
        *,
        words: QuestionnaireWords = ENGLISH,
        away: bool = False,
        notice: str = "",
    ) -> None:
        """Show what is asked at this moment, with a `notice` at the bottom, or else some lines.

        `words` are the console's own.
        `away`: nobody knows what is asked, as the line is lost. What has not been confirmed is
        kept until it is back.
        """
        run = self._kept if self._away else self.run
        if away and not self._away:
            self._kept = run
        self._lines, self._words, self._away, self._notice = lines or [], words, away, notice
        if asked is None or away:
            self.run = None
        elif run is None or run.asked.round != asked.round:
            self.run = QuestionnaireRun(asked, self._send, self._now_us, words)
        elif run.asked is not asked:
            self.run = run
            run.resume(asked)
        if self.run is not None:
            self.run.words = words
        self.draw()

    def _send(self, request: AskAnswer | AskQuestionnaire) -> None:
        self._ask(request, partial(self._replied, request))

    def _replied(self, request: AskAnswer | AskQuestionnaire, reply: Reply) -> None:
        run = self.run
        if run is None:
            return
        if isinstance(request, AskAnswer) and reply.ok:
            run.confirmed(request)
        elif isinstance(request, AskAnswer) and reply.reason != GONE:
            run.refused(request, self._words.refused)
        elif not reply.ok:
            run.complaint = self._words.refused
        self.draw()

    # -- keys -----------------------------------------------------------------------------------

    def on_key(self, event: events.Key) -> None:
        """A key for the page."""
        run = self.run
        if run is None or run.wants_text:
            return
        if run.key(event.key) or (event.character and run.key(event.character)):
            event.stop()
            event.prevent_default()
            self.draw()

    def _idle(self, key: str) -> bool:
        idle = self.run is not None and self.run.ignores(key)
        if idle:
            self.draw()  # it may say why
        return idle

    def on_answer_field_submitted(self, event: AnswerField.Submitted) -> None:
        """A text was confirmed."""
        event.stop()
        run = self.run
        if run is not None and run.wants_text:
            run.write(self._field.text)
            self.draw()

    def on_answer_field_key_passed(self, event: AnswerField.KeyPassed) -> None:
        """A key that goes past the field."""
        event.stop()
        if self.run is not None:
            self.run.go(event.key)
            self.draw()

    # -- drawing ------------------------------------------------------------------------------

    @property
    def _field(self) -> AnswerField:
        return self.query_one("#written", AnswerField)

    def draw(self) -> None:
        """Show the page as it is now."""
        if not self.query("#foot"):
            return  # not put together yet, or gone already
        run, page, foot = self.run, *self.query(Cells)
        self._show_field(run)
        frame = page.frame(0, self._glyphs)
        if run is None:
            page.show(words_rows(self._lines, frame))
            foot.show([])
        else:
            page.show(page_rows(run, frame))
            foot.show(foot_rows(run, foot.frame(0, self._glyphs), self._notice))

    def keep_draft(self) -> None:
        """Keep the text that stands in the field and is not confirmed."""
        if self._field_run is not None and self._field_item:
            asked = self._field_run.asked
            asked.keep_draft(self._field_item, self._field.text, self._field_answer)

    def _show_field(self, run: QuestionnaireRun | None) -> None:
        """The field with what was written before, while its item is shown."""
        field = self._field
        column = column_of(self.size.width)
        field.styles.width = column
        question = question_height(run, column, self._glyphs) if run is not None else 0
        room = self.size.height - _FOOT - question
        field.styles.margin = (0, 0, int(room > _FIELD_LEAST), (self.size.width - column) // 2)
        lines = run.item.lines + 2 if run is not None and run.item and run.item.lines else _FIELD
        height = max(_FIELD_LEAST, min(lines, room - 1))
        if height != self._field_height:
            self._field_height = field.styles.height = height
        item = run.item if run is not None and run.wants_text else None
        name = item.name if item is not None else ""
        if name == self._field_item:
            return
        self.keep_draft()
        self._field_item, self._field_run = name, run
        field.display = bool(name)
        if run is not None and name:
            self._field_answer = run.answer
            field.text = run.text
            field.move_cursor(field.document.end)
            field.focus()
        else:
            self.focus()
