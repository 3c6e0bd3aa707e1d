"""The state of a questionnaire that somebody fills in: what keys do, what is sent.

Nothing here draws. Each answer is handed on at once, so that nothing is lost when the line drops;
what has not been accepted yet is handed on again when it is back.
"""

from __future__ import annotations

import enum
from collections.abc import Callable
from dataclasses import replace

from woz_tui.console.input.keyboard import HELD_US
from woz_tui.features.questionnaires.answers import OpenQuestionnaire, answer_told
from woz_tui.features.questionnaires.items import (
    LONGEST,
    MONTH,
    NUMBERS,
    SKIPPED,
    ItemAnswer,
    as_shown,
    shown_value,
    stored_value,
    ways_out,
)
from woz_tui.features.questionnaires.kinds import AskAnswer, AskQuestionnaire
from woz_tui.protocol.welcome import ENGLISH, QuestionnaireItem, QuestionnaireWords

#: Steps of the page keys on a wide scale.
_LEAP = 10
#: Keys that answer or go on wherever they are taken; digits do on some items.
_ANSWERING = frozenset({"enter", "tab"})
#: The keys of choices, in their order.
CHOICE_KEYS = "123456789abcdefghijklmnopqrstuvwxyz"
#: Signs of the longest number that is typed, and of a month; its dash comes by itself.
_LONGEST_NUMBER, _LONGEST_MONTH, _YEAR = 8, 7, 4
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
    NO_ANSWER = "no answer"


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
        #: The mark on the scale as it is shown, or on a choice (from 0); what was typed so far.
        self.mark: int | None = None
        self.typed = ""
        #: Codes of the choices that are ticked, and a choice that wants a text as well.
        self.ticked: frozenset[int] = frozenset()
        self.pending: ItemAnswer | None = None
        #: The chosen line of the summary.
        self.chosen = 0
        #: Why a key was not taken.
        self.complaint = ""
        #: Answers that nobody has confirmed, by item.
        self.unconfirmed: dict[str, AskAnswer] = {}
        self._to_summary = False
        #: Items whose answer may be missing, and that were asked for once more.
        self._asked_again: set[str] = set()
        self._shown_us = now_us()
        self._settled_us = self._shown_us
        #: The key that may be held, and when it came last.
        self._last, self._came_us = "", self._shown_us
        if asked.answers:
            self._show(asked.first_open())

    # -- reading ------------------------------------------------------------------------------

    @property
    def item(self) -> QuestionnaireItem | None:
        """The item shown, with the numbers and sides that are shown."""
        return as_shown(self._stored) if self._stored is not None else None

    @property
    def _stored(self) -> QuestionnaireItem | None:
        items = self.asked.items
        return items[self.position] if self.position < len(items) else None

    @property
    def number(self) -> int:
        """Which question it is, from 1; 0: an instruction."""
        questions = self.asked.questions
        return questions.index(self._stored) + 1 if self._stored in questions else 0

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
        item = self.item if self.page is QuestionnairePage.ITEM else None
        return item is not None and (item.text or self.pending is not None)

    @property
    def ways(self) -> list[str]:
        """How the item can go without an answer."""
        return ways_out(self._stored) if self._stored is not None else []

    # -- moving -------------------------------------------------------------------------------

    def _show(self, position: int, step: int = 1) -> None:
        """The item there, or the next one that is asked."""
        items, shown = self.asked.items, self.asked.shown
        while 0 <= position < len(items) and items[position] not in shown:
            position += step
        if position < 0:
            self.page, self.complaint = QuestionnairePage.INTRODUCTION, ""
            return
        self.chosen = len(self.asked.questions)
        self.position = min(position, len(items))
        self.page = QuestionnairePage.ITEM if self.item else QuestionnairePage.SUMMARY
        self.typed = self.complaint = ""
        self.pending = None
        self._set_mark()
        self._shown_us = self._now_us()

    def _set_mark(self) -> None:
        """Where the answer of before stands; nowhere without one."""
        item, answer = self._stored, self.answer or ItemAnswer()
        self.mark, self.ticked = None, frozenset(answer.values)
        if item is None:
            return
        codes = [each.value for each in item.choices]
        if item.asks == "choices":
            self.mark = 0
        elif item.asks == "choice":
            self.mark = codes.index(answer.value) if answer.value in codes else None
        elif answer.value is not None:
            self.mark = shown_value(item, answer.value)
        if item.asks == "month":
            self.typed = answer.text
        elif item.asks == "number" and self.mark is not None:
            self.typed = str(self.mark)

    def back(self) -> None:
        """The item before."""
        self._show(self.position - 1, -1)

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
            QuestionnairePage.NO_ANSWER: self._no_answer,
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

    def _no_answer(self, key: str) -> bool:
        number = CHOICE_KEYS.find(key) if len(key) == 1 else -1
        if 0 <= number < len(self.ways):
            self._leave_out(self.ways[number])
            self._settle(key)
        elif key in ("backspace", "up", "left"):
            self._show(self.position)
        else:
            return False
        return True

    def _summary(self, key: str) -> bool:
        questions = self.asked.questions
        last = len(questions)
        if key == "enter" and self.chosen >= last:
            self._finish()
        elif key == "enter":
            self._show(self.asked.items.index(questions[self.chosen]))
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
        if key == "tab" and item.asks != "page":
            self._skip(item)
        elif self.pending is not None:
            return self._pending(key)
        elif item.asks in ("choice", "choices"):
            return self._choice(item, key)
        elif key == "up":
            self.back()
        elif key == "down":
            self._forward(item)
        elif item.asks == "page":
            return self._instruction(key)
        elif not item.text:
            return self._scale(item, key)
        elif key == "backspace":
            self.back()
        else:
            return False
        return True

    def _instruction(self, key: str) -> bool:
        if key in ("enter", "space", "right"):
            self._next()
        elif key in ("backspace", "left"):
            self.back()
        else:
            return False
        return True

    def _pending(self, key: str) -> bool:
        """While the text of a choice is typed."""
        if key not in ("up", "backspace"):
            return False
        self.pending, self.complaint = None, ""
        return True

    def _forward(self, item: QuestionnaireItem) -> None:
        if item.name in self.asked.answers or item.asks == "page":
            self._next()
        else:
            words = self.words
            self.complaint = words.answer_or_skip if item.optional else words.answer_first

    def _choice(self, item: QuestionnaireItem, key: str) -> bool:
        count, several = len(item.choices), item.asks == "choices"
        number = CHOICE_KEYS.find(key) if len(key) == 1 else -1
        if key == "space" and several and self.mark is not None:
            number = self.mark
        if 0 <= number < count:
            self.mark, self.complaint = number, ""
            code = item.choices[number].value
            if several:
                self.ticked ^= {code}
            else:
                self._choose(item, code)
                self._settle(key)
        elif key == "enter":
            self._confirm_choice(item)
        elif key in ("down", "right"):
            self.mark = 0 if self.mark is None else min(self.mark + 1, count - 1)
        elif key in ("up", "left") and self.mark:
            self.mark -= 1
        elif key in ("up", "backspace"):
            self.back()
        else:
            return False
        return True

    def _confirm_choice(self, item: QuestionnaireItem) -> None:
        codes = tuple(each.value for each in item.choices if each.value in self.ticked)
        if item.asks == "choice" and self.mark is not None:
            self._choose(item, item.choices[self.mark].value)
        elif item.asks == "choice":
            self.complaint = self.words.choose
        elif not codes:
            self.complaint = self.words.choose_some
        elif item.other in codes:
            self.pending, self.complaint = ItemAnswer(values=codes), ""
        else:
            self._set_answer(item, ItemAnswer(values=codes))

    def _choose(self, item: QuestionnaireItem, code: int) -> None:
        if code == item.other:
            self.pending, self.complaint = ItemAnswer(code), ""
        else:
            self._set_answer(item, ItemAnswer(code))

    def _scale(self, item: QuestionnaireItem, key: str) -> bool:
        """A scale, a slider, a number or a month: moved to, or typed."""
        step = {"left": -1, "right": 1, "pagedown": -_LEAP, "pageup": _LEAP}.get(key)
        moves = item.asks not in ("number", "month")
        if _is_digit(key) or (key == "-" and (item.low < 0 or item.asks == "month")):
            self._type(item, key)
        elif step is not None and moves:
            self._move(item, step)
        elif key in ("home", "end") and moves:
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
        self._move_to(item, start if self.mark is None else self.mark + step * item.step)

    def _move_to(self, item: QuestionnaireItem, value: int) -> None:
        self.mark, self.typed, self.complaint = min(item.high, max(item.low, value)), "", ""

    def _type(self, item: QuestionnaireItem, digit: str) -> None:
        """A digit answers at once where each point is one; else enter follows the number."""
        typed = self.typed + digit
        if item.asks == "month":
            dash = "-" if len(self.typed) == _YEAR and digit != "-" else ""
            self._set_typed(item, f"{self.typed}{dash}{digit}"[:_LONGEST_MONTH])
        elif item.asks == "number":
            self._set_typed(item, typed[:_LONGEST_NUMBER])
        elif not any(str(each).startswith(typed) for each in range(item.low, item.high + 1)):
            self._set_typed(item, "")
            self.complaint = self._wanted(item)
        elif item.digits and item.asks == "scale":
            self._set_answer(item, ItemAnswer(int(typed)))
            self._settle(digit)
        else:
            self._set_typed(item, typed)

    def _settle(self, key: str) -> None:
        """A key has answered at once: what comes right behind it is part of the same press."""
        self._last, self._settled_us = key, self._now_us() + SETTLING_US

    def _set_typed(self, item: QuestionnaireItem, typed: str) -> None:
        self.typed, self.complaint, self.mark = typed, "", None
        number = typed.removeprefix("-").isdecimal() and item.asks != "month"
        if number and item.low <= int(typed) <= item.high:
            on_step = (int(typed) - item.low) % item.step == 0
            self.mark = int(typed) if on_step else None

    def _confirm(self, item: QuestionnaireItem) -> None:
        """Not with nothing chosen: an enter too many must leave nothing out."""
        words = self.words
        if item.asks == "month":
            if MONTH.fullmatch(self.typed):
                self._set_answer(item, ItemAnswer(text=self.typed))
            else:
                self.complaint = words.month
        elif self.mark is not None:
            self._set_answer(item, ItemAnswer(self.mark))
        elif (near := self._between_steps(item)) is not None:
            above = near + item.step
            self.complaint = words.step.format(step=item.step, below=near, above=above)
        else:
            self.complaint = self._wanted(item)

    def _wanted(self, item: QuestionnaireItem) -> str:
        """What is to be answered; where no numbers are shown, none is told."""
        if item.asks == "scale" and not item.numbers:
            return self.words.choose
        wanted = self.words.number_or_skip if item.optional else self.words.number
        return wanted.format(low=item.low, high=item.high)

    def _between_steps(self, item: QuestionnaireItem) -> int | None:
        """The step below a number that was typed between two of them."""
        if not self.typed.removeprefix("-").isdecimal():
            return None
        typed = int(self.typed)
        return typed - (typed - item.low) % item.step if item.low <= typed <= item.high else None

    def _skip(self, item: QuestionnaireItem) -> None:
        ways = self.ways
        if not ways:
            self.complaint = self.words.wants_answer
        elif len(ways) > 1:
            self.page, self.complaint = QuestionnairePage.NO_ANSWER, ""
        elif item.soft and item.name not in self._asked_again:
            self._asked_again.add(item.name)
            self.complaint = self.words.soft
        else:
            self._leave_out(ways[0])

    def _leave_out(self, way: str) -> None:
        if self.item is not None:
            reason = "" if way == SKIPPED else way
            self._set_answer(self.item, ItemAnswer(skipped=True, reason=reason))

    def write(self, text: str) -> None:
        """The text field was confirmed with enter."""
        item, pending, text = self.item, self.pending, text.strip()
        if item is None or not (item.text or pending is not None):
            return
        if len(text) > LONGEST:
            self.complaint = self.words.too_long.format(most=LONGEST)
        elif text:
            self._set_answer(item, replace(pending or ItemAnswer(), text=text))
        elif pending is not None:
            self.complaint = self.words.other
        else:
            self._skip(item)

    # -- answers ------------------------------------------------------------------------------

    def _set_answer(self, item: QuestionnaireItem, answer: ItemAnswer) -> None:
        """Keep an answer in the numbers that are shown, and send it in those that are stored."""
        stored = self._stored
        if stored is not None and answer.value is not None and item.asks in NUMBERS:
            answer = replace(answer, value=stored_value(stored, answer.value))
        request = AskAnswer(
            questionnaire=self.asked.name,
            item=item.name,
            value=None if answer.value is None else float(answer.value),
            text=answer.text,
            answered_us=max(0, self._now_us() - self._shown_us),
            skipped=answer.skipped,
            ticked=[*answer.values],
            reason=answer.reason,
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
            asked.answers[request.item] = answer_told(request)
            self._send(request)


def _is_digit(key: str) -> bool:
    return len(key) == 1 and key.isdecimal()
