"""Questionnaires as the robot process tells them, and the answers that have been given."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from woz_tui.core import messages as m
from woz_tui.core.messages import Json

#: A scale as the experiment file has it if nothing else is said.
_LOW, _HIGH = 1, 7
#: The highest number of one digit.
_DIGIT = 9


@dataclass(frozen=True, slots=True)
class Item:
    """One question: a scale of whole numbers from `low` to `high`, or a free text.

    `ends` is what the scale's ends are called; `optional`: may be left out.
    """

    name: str
    question: str
    low: int = _LOW
    high: int = _HIGH
    ends: tuple[str, str] = ("", "")
    text: bool = False
    optional: bool = False

    @property
    def digits(self) -> bool:
        """Whether each point of the scale is one digit."""
        return self.low >= 0 and self.high <= _DIGIT


@dataclass(frozen=True, slots=True)
class Questionnaire:
    """Items asked together; `when` is end, trial, condition or hand."""

    name: str
    title: str = ""
    introduction: str = ""
    when: str = "end"
    items: tuple[Item, ...] = ()

    @property
    def heading(self) -> str:
        """Its title, or its name."""
        return self.title or self.name


@dataclass(frozen=True, slots=True)
class Answer:
    """A number on the scale, a text, or left out on purpose (`skipped`)."""

    value: int | None = None
    text: str = ""
    skipped: bool = False

    def words(self) -> str:
        """It in a few words."""
        if self.skipped:
            return "left out"
        return self.text if self.value is None else str(self.value)


@dataclass(slots=True)
class Asked:
    """A questionnaire that is put to somebody; answers by item."""

    questionnaire: Questionnaire
    answers: dict[str, Answer] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """The questionnaire's name."""
        return self.questionnaire.name

    @property
    def items(self) -> tuple[Item, ...]:
        """What is asked."""
        return self.questionnaire.items

    @property
    def answered(self) -> int:
        """Items with an answer, those left out included."""
        return sum(item.name in self.answers for item in self.items)

    def take(self, told: m.QuestionnaireAnswered) -> None:
        """Somebody answered, here or at another terminal."""
        value = None if told.value is None else round(told.value)
        self.answers[told.item] = Answer(value, told.text, told.skipped)

    def first_open(self) -> int:
        """The first item without an answer; behind the last one if there is none."""
        open_items = (n for n, item in enumerate(self.items) if item.name not in self.answers)
        return next(open_items, len(self.items))


def questionnaires_of(told: Json) -> tuple[Questionnaire, ...]:
    """As a welcome's settings tell; what another version tells in another shape is left out."""
    if not isinstance(told, list):
        return ()
    return tuple(
        Questionnaire(
            name=str(one["name"]),
            title=_text(one, "title"),
            introduction=_text(one, "introduction"),
            when=_text(one, "when") or "end",
            items=items_of(one.get("items")),
        )
        for one in told
        if isinstance(one, Mapping) and one.get("name")
    )


def items_of(told: object) -> tuple[Item, ...]:
    """The items of one, as a message or a welcome tells them."""
    if not isinstance(told, list | tuple):
        return ()
    return tuple(_item(one) for one in told if isinstance(one, Mapping) and one.get("name"))


def _item(told: Mapping[str, Json]) -> Item:
    low, high = _whole(told, "low", _LOW), _whole(told, "high", _HIGH)
    return Item(
        name=str(told["name"]),
        question=_text(told, "question") or str(told["name"]),
        low=low,
        high=max(low, high),
        ends=_ends(told.get("ends")),
        text=told.get("text") is True,
        optional=told.get("optional") is True,
    )


def _ends(told: Json) -> tuple[str, str]:
    match told:
        case [str() as low, str() as high]:
            return low, high
    return "", ""


def _text(told: Mapping[str, Json], name: str) -> str:
    value = told.get(name)
    return value if isinstance(value, str) else ""


def _whole(told: Mapping[str, Json], name: str, instead: int) -> int:
    value = told.get(name)
    return value if isinstance(value, int) and not isinstance(value, bool) else instead
