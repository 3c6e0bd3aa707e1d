"""Questionnaires of the robot process with the answers so far."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass, field

import msgspec

from woz_tui.features.questionnaires.items import ItemAnswer, asked_items
from woz_tui.features.questionnaires.kinds import AskAnswer, QuestionnaireAnswered
from woz_tui.protocol.welcome import Questionnaire, QuestionnaireItem, QuestionnaireWords


@dataclass(slots=True)
class OpenQuestionnaire:
    """A questionnaire that is put to somebody; answers by item.

    `began`: when, on the axis of `t`; None: not known. `drafts`: texts that were typed here and not
    confirmed, by item.
    """

    questionnaire: Questionnaire
    answers: dict[str, ItemAnswer] = field(default_factory=dict)
    began: int | None = None
    drafts: dict[str, str] = field(default_factory=dict)

    @property
    def round(self) -> tuple[str, int | None]:
        """It is another one each time it is put to somebody."""
        return self.name, self.began

    @property
    def name(self) -> str:
        """The questionnaire's name."""
        return self.questionnaire.name

    @property
    def items(self) -> tuple[QuestionnaireItem, ...]:
        """What is asked."""
        return self.questionnaire.items

    @property
    def shown(self) -> list[QuestionnaireItem]:
        """What the answers so far do not rule out, instructions included."""
        return asked_items(self.items, self.answers)

    @property
    def questions(self) -> list[QuestionnaireItem]:
        """Those of them that want an answer."""
        return [item for item in self.shown if item.asks != "page"]

    def count_told(self, words: QuestionnaireWords) -> str:
        """How many questions there will be: `3-5 questions.`, where answers decide on some."""
        least = len(self.questions)
        open_still = [item for item in self.items if item.asks != "page"]
        if least == len(open_still):
            return words.questions_one if least == 1 else words.questions.format(count=least)
        return words.questions.format(count=f"{least}-{len(open_still)}")

    @property
    def answered(self) -> int:
        """Questions with an answer, those left out included."""
        return sum(item.name in self.answers for item in self.questions)

    def apply(self, told: QuestionnaireAnswered) -> None:
        """Somebody answered, here or at another terminal."""
        self.answers[told.item] = answer_told(told)

    def keep_draft(self, item: str, text: str, before: ItemAnswer | None) -> None:
        """Keep a text that was left. `before`: the answer when it was begun; a newer one holds."""
        confirmed = before.text if before is not None else ""
        if self.answers.get(item) == before and text != confirmed:
            self.drafts[item] = text
        else:
            self.drafts.pop(item, None)

    def first_open(self) -> int:
        """The first question without an answer; behind the last item if there is none."""
        open_items = (item for item in self.questions if item.name not in self.answers)
        first = next(open_items, None)
        return len(self.items) if first is None else self.items.index(first)


def answer_told(told: QuestionnaireAnswered | AskAnswer) -> ItemAnswer:
    """An answer as a message has it."""
    value = None if told.value is None else round(told.value)
    return ItemAnswer(value, told.text, told.skipped, tuple(told.ticked), told.reason)


def items_of(told: object) -> tuple[QuestionnaireItem, ...]:
    """The items of one, as a message has them; those that cannot be read are left out."""
    found: list[QuestionnaireItem] = []
    for one in told if isinstance(told, list | tuple) else ():
        with contextlib.suppress(msgspec.ValidationError):
            found.append(msgspec.convert(one, QuestionnaireItem))
    return tuple(found)
