"""How each kind of item is asked on a page, and what a sent form says as its answer.

A new kind of item is one more row of `ITEM_FORMS`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from woz_tui.analysis.html.markup import Markup, joined, tag
from woz_tui.features.questionnaires.items import ItemAnswer
from woz_tui.features.questionnaires.kinds import AskAnswer
from woz_tui.protocol.welcome import LONGEST, QuestionnaireItem, QuestionnaireWords

#: Points of a scale that are buttons each, at the most; a wider one takes a number.
MOST_POINTS = 21
#: Lines of the field for a text.
_LINES = 5

Form = Mapping[str, Any]


class UnreadAnswerError(Exception):
    """A form holds no answer; the text says what is needed."""


@dataclass(frozen=True, slots=True)
class ItemForm:
    """A kind of item.

    `fields`: what its form holds, with the answer so far. `read`: fields of `AskAnswer`, from a
    form that was sent; raises `UnreadAnswerError`.
    """

    fields: Callable[[QuestionnaireItem, ItemAnswer, QuestionnaireWords], Markup]
    read: Callable[[QuestionnaireItem, Form, QuestionnaireWords], Mapping[str, Any]]


def kind_of(item: QuestionnaireItem) -> str:
    """Which row of `ITEM_FORMS` asks it."""
    if item.text:
        return "text"
    return "scale" if item.high - item.low < MOST_POINTS else "number"


def answer_of(item: QuestionnaireItem, form: Form, words: QuestionnaireWords) -> AskAnswer:
    """The answer that a form holds, without whose it is. Raises `UnreadAnswerError`."""
    read = ITEM_FORMS[kind_of(item)].read(item, form, words)
    return AskAnswer(questionnaire="", item=item.name, **read)


# -- scales ----------------------------------------------------------------------------------------


def _points(item: QuestionnaireItem, answer: ItemAnswer, words: QuestionnaireWords) -> Markup:
    """A large button for each point; the first and the last one say what they are called."""
    ends = dict(zip((item.low, item.high), item.ends, strict=True))
    points = (
        tag(
            "label",
            tag(
                "input",
                type="radio",
                name="value",
                value=str(value),
                required=not item.optional,
                checked=value == answer.value,
            ),
            tag("span", str(value)),
            tag("span", ends[value], class_="unseen") if ends.get(value) else None,
        )
        for value in range(item.low, item.high + 1)
    )
    return joined(tag("div", points, class_="points"), _ends(item))


def _number(item: QuestionnaireItem, answer: ItemAnswer, words: QuestionnaireWords) -> Markup:
    field = tag(
        "input",
        type="number",
        inputmode="numeric",
        name="value",
        min=str(item.low),
        max=str(item.high),
        step="1",
        required=not item.optional,
        autocomplete="off",
        value="" if answer.value is None else str(answer.value),
    )
    wanted = words.number.format(low=item.low, high=item.high)
    return joined(tag("label", tag("span", wanted), field), _ends(item))


def _ends(item: QuestionnaireItem) -> Markup | None:
    """What the ends are called, each under its own."""
    if not any(item.ends):
        return None
    names = (
        tag("span", f"{at}: {end}")
        for at, end in zip((item.low, item.high), item.ends, strict=True)
    )
    return tag("div", names, class_="ends", aria_hidden="true")


def _read_number(
    item: QuestionnaireItem, form: Form, words: QuestionnaireWords
) -> Mapping[str, Any]:
    try:
        value = int(str(form.get("value", "")).strip())
    except ValueError:
        value = item.low - 1
    if not item.low <= value <= item.high:
        raise UnreadAnswerError(words.number.format(low=item.low, high=item.high))
    return {"value": float(value)}


# -- words ----------------------------------------------------------------------------------------


def _text(item: QuestionnaireItem, answer: ItemAnswer, words: QuestionnaireWords) -> Markup:
    return tag(
        "textarea",
        "\n" if answer.text.startswith("\n") else None,  # the first one is no part of the text
        answer.text,
        name="text",
        rows=_LINES,
        maxlength=LONGEST,
        required=not item.optional,
        aria_label=item.question,
        autocomplete="off",
    )


def _read_text(item: QuestionnaireItem, form: Form, words: QuestionnaireWords) -> Mapping[str, Any]:
    text = str(form.get("text", "")).replace("\r\n", "\n")
    if not text.strip():
        raise UnreadAnswerError(words.answer_first)
    if len(text) > LONGEST:
        raise UnreadAnswerError(words.too_long.format(most=LONGEST))
    return {"text": text}


#: How items are asked, by kind.
ITEM_FORMS: Mapping[str, ItemForm] = {
    "scale": ItemForm(_points, _read_number),
    "number": ItemForm(_number, _read_number),
    "text": ItemForm(_text, _read_text),
}
