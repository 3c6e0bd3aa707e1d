"""What was asked of the participant: questionnaires, round by round."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from woz_tui.analysis.course import Course, Handlers
from woz_tui.analysis.figures import Answer, Round
from woz_tui.core import messages as m


@dataclass(slots=True)
class _Round:
    questionnaire: str
    number: int
    title: str
    t: int
    participant: str
    condition: str
    trial: int
    items: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    answers: dict[str, m.QuestionnaireAnswered] = field(default_factory=dict)
    reason: str = ""


class Asked:
    """Keeps the last answer to each item of each round."""

    def __init__(self, course: Course) -> None:
        self._course = course
        self._rounds: list[_Round] = []
        self._open: dict[str, _Round] = {}

    def handlers(self) -> Handlers:
        """What it listens to."""
        return {
            m.QuestionnaireStarted: self._started,
            m.QuestionnaireAnswered: self._answered,
            m.QuestionnaireEnded: self._ended,
        }

    @property
    def rounds(self) -> tuple[Round, ...]:
        """Each time a questionnaire was put to somebody."""
        return tuple(
            Round(
                questionnaire=each.questionnaire,
                round=each.number,
                title=each.title,
                t=each.t,
                reason=each.reason,
                answered=sum(not answer.skipped for answer in each.answers.values()),
                items=len(each.items),
            )
            for each in self._rounds
        )

    @property
    def answers(self) -> tuple[Answer, ...]:
        """The last answers, in the order in which the items were answered first."""
        return tuple(
            _answer(each, answer) for each in self._rounds for answer in each.answers.values()
        )

    def _started(self, message: m.QuestionnaireStarted) -> None:
        self._begin(
            message.questionnaire,
            message.title,
            message.trial,
            {str(item.get("name", "")): item for item in message.items},
        )

    def _begin(
        self, name: str, title: str, trial: int, items: Mapping[str, Mapping[str, Any]]
    ) -> _Round:
        course = self._course
        number = 1 + sum(each.questionnaire == name for each in self._rounds)
        begun = _Round(
            questionnaire=name,
            number=number,
            title=title,
            t=course.t,
            participant=course.participant,
            condition=course.condition,
            trial=trial if trial >= 0 else course.trial,
            items=items,
        )
        self._rounds.append(begun)
        self._open[name] = begun
        return begun

    def _answered(self, message: m.QuestionnaireAnswered) -> None:
        name = message.questionnaire
        asked = self._open.get(name) or self._begin(name, "", -1, {})  # its beginning was lost
        asked.answers[message.item] = message

    def _ended(self, message: m.QuestionnaireEnded) -> None:
        asked = self._open.pop(message.questionnaire, None)
        if asked is not None:
            asked.reason = message.reason


def _answer(asked: _Round, answer: m.QuestionnaireAnswered) -> Answer:
    item = asked.items.get(answer.item, {})
    return Answer(
        questionnaire=asked.questionnaire,
        round=asked.number,
        item=answer.item,
        question=answer.question,
        value=None if answer.skipped else answer.value,
        text=answer.text,
        skipped=answer.skipped,
        answered_us=answer.answered_us if answer.answered_us >= 0 else None,
        low=_number(item.get("low")),
        high=_number(item.get("high")),
        participant=asked.participant,
        condition=asked.condition,
        trial=asked.trial,
    )


def _number(value: object) -> float | None:
    return float(value) if isinstance(value, int | float) else None
