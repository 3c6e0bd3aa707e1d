"""Questionnaires of the robot process with the answers so far."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass, field

import msgspec

from woz_tui.features.questionnaires.kinds import QuestionnaireAnswered
from woz_tui.protocol.welcome import Questionnaire, QuestionnaireItem


@dataclass(frozen=True, slots=True)
class ItemAnswer:
    """A number on the scale, a text, or left out on purpose (`skipped`)."""

    value: int | None = None
    text: str = ""
    skipped: bool = False

    def shown(self, left_out: str) -> str:
        """It in a few words; `left_out` stands for none."""
        if self.skipped:
            return left_out
        return self.text if self.value is None else str(self.value)


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
    def answered(self) -> int:
        """Items with an answer, those left out included."""
        return sum(item.name in self.answers for item in self.items)

    def apply(self, told: QuestionnaireAnswered) -> None:
        """Somebody answered, here or at another terminal."""
        value = None if told.value is None else round(told.value)
        self.answers[told.item] = ItemAnswer(value, told.text, told.skipped)

    def keep_draft(self, item: str, text: str, before: ItemAnswer | None) -> None:
        """Keep a text that was left. `before`: the answer when it was begun; a newer one holds."""
        confirmed = before.text if before is not None else ""
        if self.answers.get(item) == before and text != confirmed:
            self.drafts[item] = text
        else:
            self.drafts.pop(item, None)

    def first_open(self) -> int:
        """The first item without an answer; behind the last one if there is none."""
        open_items = (n for n, item in enumerate(self.items) if item.name not in self.answers)
        return next(open_items, len(self.items))


def items_of(told: object) -> tuple[QuestionnaireItem, ...]:
    """The items of one, as a message has them; those that cannot be read are left out."""
    found: list[QuestionnaireItem] = []
    for one in told if isinstance(told, list | tuple) else ():
        with contextlib.suppress(msgspec.ValidationError):
            found.append(msgspec.convert(one, QuestionnaireItem))
    return tuple(found)
