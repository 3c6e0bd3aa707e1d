"""The state of a questionnaire that somebody fills in: what keys do, what is sent.

Nothing here draws. Each answer is handed on at once, so that nothing is lost when the line drops;
what has not been accepted yet is handed on again when it is back.
"""

from __future__ import annotations

import enum
from collections.abc import Callable

from woz_tui.console.input.keyboard import HELD_US
from woz_tui.features.questionnaires.answers import ItemAnswer, OpenQuestionnaire
from woz_tui.features.questionnaires.kinds import AskAnswer, AskQuestionnaire
from woz_tui.protocol.welcome import ENGLISH, LONGEST, QuestionnaireItem, QuestionnaireWords

#: Steps of the page keys on a wide scale.
_LEAP = 10
#: Keys that answer or go on wherever they are taken; digits do on some items.
_ANSWERING = frozenset({"enter", "tab"})
#: Points from which a scale is drawn as a line instead of boxes.
WIDE = 12
#: Microseconds after an answer by digit in which digits and enter do nothing, and begin it anew:
#: longer than two fingers need that hit the keys at once, shorter than anybody takes to read the
#: next question.
SETTLING_US = 300_000


class QuestionnairePage(enum.Enum):
    """What is shown."""

    INTRODUCTION = "introduction"
    ITEM = "item"
    SUMMARY = "summary"
    DECLINE = "decline"


class QuestionnaireRun:
    """Goes through `asked`, from the first item without an answer on.

    Args:
        asked: The questionnaire and the answers so far; answers are put into it.
        send: Where answers go.
        now_us: A clock that goes on evenly, in microseconds: how long an answer took.
        words: The console's own words to the participant.
    """

    def __init__(
        self,
        asked: OpenQuestionnaire,
        send: Callable[[AskAnswer | AskQuestionnaire], None],
        now_us: Callable[[], int],
        words: QuestionnaireWords = ENGLISH,
    ) -> None:
        self.asked, self.words = asked, words
        self._send, self._now_us = send, now_us
        #: The item shown; behind the last one is the summary.
        self.position = 0
        self.page = QuestionnairePage.INTRODUCTION
        #: The mark on the scale, digits typed so far, the chosen line of the summary.
        self.mark: int | None = None
        self.typed = ""
        self.chosen = len(asked.items)
        #: Why a key was not taken.
        self.complaint = ""
        #: Answers that nobody has confirmed, by item.
        self.unconfirmed: dict[str, AskAnswer] = {}
        self._to_summary = False
        self._shown_us = now_us()
        self._settled_us = self._shown_us
        #: The key that may be held, and when it came last.
        self._last, self._came_us = "", self._shown_us
        if asked.answers:
            self._show(asked.first_open())

    # -- reading ------------------------------------------------------------------------------

    @property
    def item(self) -> QuestionnaireItem | None:
        """The item shown."""
        items = self.asked.items
        return items[self.position] if self.position < len(items) else None

    @property
    def answer(self) -> ItemAnswer | None:
        """What was answered to it before."""
        return self.asked.answers.get(self.item.name) if self.item is not None else None

    @property
    def text(self) -> str:
        """What stands in the text field at first: what was typed last, or answered before."""
        answered = self.answer.text if self.answer is not None else ""
        return self.asked.drafts.get(self.item.name, answered) if self.item is not None else ""

    @property
    def wants_text(self) -> bool:
        """Whether a text field is to be shown."""
        return self.page is QuestionnairePage.ITEM and self.item is not None and self.item.text

    # -- moving -------------------------------------------------------------------------------

    def _show(self, position: int) -> None:
        self.chosen = len(self.asked.items)
        self.position = max(0, min(position, self.chosen))
        self.page = QuestionnairePage.ITEM if self.item else QuestionnairePage.SUMMARY
        self.typed = self.complaint = ""
        self.mark = self.answer.value if self.answer is not None else None
        self._shown_us = self._now_us()

    def back(self) -> None:
        """The item before."""
        if self.position == 0:
            self.page, self.complaint = QuestionnairePage.INTRODUCTION, ""
        else:
            self._show(self.position - 1)

    def _next(self) -> None:
        """The next one, or back to the summary from where it was chosen."""
        to = len(self.asked.items) if self._to_summary else self.position + 1
        self._to_summary = False
        self._show(to)

    # -- keys -----------------------------------------------------------------------------------

    def key(self, key: str) -> bool:
        """A key in Textual's name, or a character; whether it was one of ours."""
        return self.ignores(key) or self.go(key)

    def go(self, key: str) -> bool:
        """What a key does that is not the rest of another press; whether it was one of ours."""
        if key == "ctrl+d" and self.page is not QuestionnairePage.DECLINE:
            self.page, self.complaint = QuestionnairePage.DECLINE, ""
            return True
        return {
            QuestionnairePage.INTRODUCTION: self._introduction,
            QuestionnairePage.ITEM: self._item,
            QuestionnairePage.SUMMARY: self._summary,
            QuestionnairePage.DECLINE: self._decline,
        }[self.page](key)

    def ignores(self, key: str) -> bool:
        """Whether this may be the rest of a held key, or of a fist on the keys: it does nothing.

        To be asked once for each key that comes, whoever it is for.
        """
        now = self._now_us()
        pause = now - self._came_us
        held = key == self._last and pause < HELD_US
        early = now < self._settled_us and (key == "enter" or _is_digit(key))
        if early:
            self._settled_us = now + SETTLING_US
        self._last, self._came_us = key if held or early or key in _ANSWERING else "", now
        if held:
            self._explain_pause(pause)
        return held or early

    def _explain_pause(self, pause: int) -> None:
        """Who presses a key again soon has to know why it does nothing; who holds it need not."""
        if pause < SETTLING_US and self.complaint == self.words.press_again:
            self.complaint = ""
        elif pause >= SETTLING_US and not self.complaint:
            self.complaint = self.words.press_again

    def _introduction(self, key: str) -> bool:
        if key not in ("enter", "down", "right", "space"):
            return False
        self._show(0)
        return True

    def _decline(self, key: str) -> bool:
        if key in (self.words.stop_key, "enter"):
            self._send(AskQuestionnaire(questionnaire=self.asked.name, what="declined"))
            return True
        if key in (self.words.go_on_key, "backspace", "up", "left"):
            self._show(self.position)
            return True
        return False

    def _summary(self, key: str) -> bool:
        last = len(self.asked.items)
        if key == "enter" and self.chosen >= last:
            self._finish()
        elif key == "enter":
            self._show(self.chosen)
            self._to_summary = True
        elif key in ("up", "down"):
            self.chosen = max(0, min(last, self.chosen + (1 if key == "down" else -1)))
        elif key in ("backspace", "left"):
            self.back()
        else:
            return False
        return True

    def _finish(self) -> None:
        open_item = self.asked.first_open()
        if open_item < len(self.asked.items):
            self._show(open_item)
            self.complaint = self.words.open_item
        else:
            self._send(AskQuestionnaire(questionnaire=self.asked.name, what="done"))

    def _item(self, key: str) -> bool:
        item = self.item
        if item is None:
            return False
        if key == "tab":
            self._skip(item)
        elif key == "up":
            self.back()
        elif key == "down":
            self._forward(item)
        elif not item.text:
            return self._scale(item, key)
        elif key == "backspace":
            self.back()
        else:
            return False
        return True

    def _forward(self, item: QuestionnaireItem) -> None:
        if item.name in self.asked.answers:
            self._next()
        else:
            words = self.words
            self.complaint = words.answer_or_skip if item.optional else words.answer_first

    def _scale(self, item: QuestionnaireItem, key: str) -> bool:
        step = {"left": -1, "right": 1, "pagedown": -_LEAP, "pageup": _LEAP}.get(key)
        if _is_digit(key) or (key == "-" and item.low < 0):
            self._type(item, key)
        elif step is not None:
            self._move(item, step)
        elif key in ("home", "end"):
            self._move_to(item, item.low if key == "home" else item.high)
        elif key == "enter":
            self._confirm(item)
        elif key == "backspace" and self.typed:
            self._set_typed(item, self.typed[:-1])
        elif key == "backspace":
            self.back()
        else:
            return False
        return True

    def _move(self, item: QuestionnaireItem, step: int) -> None:
        """The first press of an arrow sets the mark on the end it comes from."""
        start = item.low if step > 0 else item.high
        self._move_to(item, start if self.mark is None else self.mark + step)

    def _move_to(self, item: QuestionnaireItem, value: int) -> None:
        self.mark, self.typed, self.complaint = min(item.high, max(item.low, value)), "", ""

    def _type(self, item: QuestionnaireItem, digit: str) -> None:
        """A digit answers at once where each point is one; else enter follows the number."""
        typed = self.typed + digit
        values = map(str, range(item.low, item.high + 1))
        if not any(value.startswith(typed) for value in values):
            self._set_typed(item, "")
            self.complaint = self.words.number.format(low=item.low, high=item.high)
        elif item.digits:
            self._set_answer(item, ItemAnswer(int(typed)))
            self._last, self._settled_us = digit, self._now_us() + SETTLING_US
        else:
            self._set_typed(item, typed)

    def _set_typed(self, item: QuestionnaireItem, typed: str) -> None:
        self.typed, self.complaint, self.mark = typed, "", None
        if typed.removeprefix("-").isdecimal() and item.low <= int(typed) <= item.high:
            self.mark = int(typed)

    def _confirm(self, item: QuestionnaireItem) -> None:
        """Not with nothing chosen: an enter too many must leave nothing out."""
        if self.mark is not None:
            self._set_answer(item, ItemAnswer(self.mark))
        else:
            words = self.words.number_or_skip if item.optional else self.words.number
            self.complaint = words.format(low=item.low, high=item.high)

    def _skip(self, item: QuestionnaireItem) -> None:
        if item.optional:
            self._set_answer(item, ItemAnswer(skipped=True))
        else:
            self.complaint = self.words.wants_answer

    def write(self, text: str) -> None:
        """The text field was confirmed with enter."""
        item = self.item
        if item is None or not item.text:
            return
        if len(text.strip()) > LONGEST:
            self.complaint = self.words.too_long.format(most=LONGEST)
        elif text.strip():
            self._set_answer(item, ItemAnswer(text=text.strip()))
        else:
            self._skip(item)

    # -- answers ------------------------------------------------------------------------------

    def _set_answer(self, item: QuestionnaireItem, answer: ItemAnswer) -> None:
        request = AskAnswer(
            questionnaire=self.asked.name,
            item=item.name,
            value=None if answer.value is None else float(answer.value),
            text=answer.text,
            answered_us=max(0, self._now_us() - self._shown_us),
            skipped=answer.skipped,
        )
        self.asked.answers[item.name] = answer
        self.unconfirmed[item.name] = request
        self._next()
        self._send(request)

    def confirmed(self, request: AskAnswer) -> None:
        """The robot process has it."""
        if self.unconfirmed.get(request.item) == request:
            del self.unconfirmed[request.item]

    def refused(self, request: AskAnswer, why: str) -> None:
        """It was not taken: the item is open again."""
        self.confirmed(request)
        self.asked.answers.pop(request.item, None)
        names = [item.name for item in self.asked.items]
        if request.item in names:
            self._show(names.index(request.item))
        self.complaint = why

    def resume(self, asked: OpenQuestionnaire) -> None:
        """Take the state after a lost connection: send again what was not confirmed."""
        asked.drafts = self.asked.drafts
        self.asked = asked
        for request in list(self.unconfirmed.values()):
            value = None if request.value is None else round(request.value)
            asked.answers[request.item] = ItemAnswer(value, request.text, request.skipped)
            self._send(request)


def _is_digit(key: str) -> bool:
    return len(key) == 1 and key.isdecimal()
