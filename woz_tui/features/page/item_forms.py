"""How each kind of item is asked on a page, and what a sent form says as its answer.

A new kind of item is one more row of `ITEM_FORMS`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from woz_tui.analysis.html.markup import Markup, joined, tag
from woz_tui.features.questionnaires.items import (
    LONGEST,
    MONTH,
    NUMBERS,
    POINTS,
    ItemAnswer,
    as_shown,
    shown_value,
    stored_value,
    value_labels,
    wording,
)
from woz_tui.features.questionnaires.kinds import AskAnswer
from woz_tui.protocol.welcome import QuestionnaireItem, QuestionnaireWords

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
    """Which row of `ITEM_FORMS` asks it. A slider is steps without a mark, or a number to type:
    the browser's own slider has a mark from the beginning on.
    """
    if item.asks not in POINTS:
        return item.asks
    return "scale" if (item.high - item.low) // item.step < MOST_POINTS else "number"


def item_form(item: QuestionnaireItem, answer: ItemAnswer, words: QuestionnaireWords) -> Markup:
    """What the form of an item holds, with the answer so far."""
    if answer.value is not None and item.asks in NUMBERS:
        answer = replace(answer, value=shown_value(item, answer.value))
    return ITEM_FORMS[kind_of(item)].fields(as_shown(item), answer, words)


def answer_of(item: QuestionnaireItem, form: Form, words: QuestionnaireWords) -> AskAnswer:
    """The answer that a form holds, without whose it is. Raises `UnreadAnswerError`."""
    read = dict(ITEM_FORMS[kind_of(item)].read(as_shown(item), form, words))
    if item.asks in NUMBERS:
        read["value"] = float(stored_value(item, read["value"]))
    return AskAnswer(questionnaire="", item=item.name, given="browser", **read)


def _required(item: QuestionnaireItem) -> bool:
    """Whether the browser itself wants an answer before it sends the form."""
    return not item.optional and not item.soft


# -- scales and numbers ---------------------------------------------------------------------------


def _points(item: QuestionnaireItem, answer: ItemAnswer, words: QuestionnaireWords) -> Markup:
    """A large button for each point; those with a name say it: the first and the last one to who
    hears the page, as their names stand below, others to everybody.
    """
    names = value_labels(item)
    listed = bool(names.keys() - {item.low, item.high})
    points = (
        tag(
            "label",
            tag(
                "input",
                type="radio",
                name="value",
                value=str(value),
                required=_required(item),
                checked=value == answer.value,
            ),
            tag("span", _point(item, value, names.get(value, ""), listed=listed)),
            tag("span", names[value], class_="unseen") if names.get(value) and not listed else None,
        )
        for value in range(item.low, item.high + 1, item.step)
    )
    looks = "points listed" if listed else "points"
    return joined(tag("div", points, class_=looks), None if listed else _ends(item))


def _point(item: QuestionnaireItem, value: int, name: str, *, listed: bool) -> str:
    """What stands on a point: its number unless it has none, and its name where there is room."""
    number = str(value) if item.numbers else ""
    shown = " ".join(filter(None, [number, name if listed else ""]))
    return shown or "·"


def _number(item: QuestionnaireItem, answer: ItemAnswer, words: QuestionnaireWords) -> Markup:
    field = tag(
        "input",
        type="number",
        inputmode="numeric",
        name="value",
        min=str(item.low),
        max=str(item.high),
        step=str(item.step),
        required=_required(item),
        autocomplete="off",
        value="" if answer.value is None else str(answer.value),
    )
    wanted = words.number.format(low=item.low, high=item.high)
    return joined(tag("label", tag("span", wanted), field, " ", item.unit), _ends(item))


def _ends(item: QuestionnaireItem) -> Markup | None:
    """What the ends are called, each under its own."""
    if not any(item.ends):
        return None
    names = (
        tag("span", f"{at}: {end}" if item.numbers else end)
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
    if off := (value - item.low) % item.step:
        below, above = value - off, value - off + item.step
        raise UnreadAnswerError(words.step.format(step=item.step, below=below, above=above))
    return {"value": value}


# -- choices ---------------------------------------------------------------------------------------


def _choices(item: QuestionnaireItem, answer: ItemAnswer, words: QuestionnaireWords) -> Markup:
    """A large button for each; several can be ticked. *Other* has a field for its words."""
    several = item.asks == "choices"
    ticked = answer.values if several else (answer.value,)
    choices = (
        tag(
            "label",
            tag(
                "input",
                type="checkbox" if several else "radio",
                name=f"choice{each.value}" if several else "value",
                value=str(each.value),
                required=_required(item) and not several,
                checked=each.value in ticked,
            ),
            tag("span", each.text),
        )
        for each in item.choices
    )
    other = tag(
        "label",
        tag("span", words.other),
        tag("input", name="text", maxlength=LONGEST, autocomplete="off", value=answer.text),
    )
    listed = tag("div", choices, class_="points listed")
    return joined(listed, other if item.other is not None else None)


def _read_choices(
    item: QuestionnaireItem, form: Form, words: QuestionnaireWords
) -> Mapping[str, Any]:
    several = item.asks == "choices"
    codes = [each.value for each in item.choices]
    chosen = [
        code
        for code in codes
        if (f"choice{code}" in form if several else form.get("value") == str(code))
    ]
    if not chosen:
        raise UnreadAnswerError(words.choose_some if several else words.choose)
    text = str(form.get("text", "")).strip() if item.other in chosen else ""
    if item.other in chosen and not text:
        raise UnreadAnswerError(words.other)
    if len(text) > LONGEST:
        raise UnreadAnswerError(words.too_long.format(most=LONGEST))
    return {"ticked": chosen, "text": text} if several else {"value": chosen[0], "text": text}


# -- months and instructions ----------------------------------------------------------------------


def _month(item: QuestionnaireItem, answer: ItemAnswer, words: QuestionnaireWords) -> Markup:
    """A browser without a field for months has one for a text there."""
    field = tag(
        "input",
        type="month",
        name="text",
        placeholder="2026-11",
        pattern=MONTH.pattern,
        required=_required(item),
        autocomplete="off",
        value=answer.text,
    )
    return tag("label", tag("span", words.month), field)


def _read_month(
    item: QuestionnaireItem, form: Form, words: QuestionnaireWords
) -> Mapping[str, Any]:
    text = str(form.get("text", "")).strip()
    if not MONTH.fullmatch(text):
        raise UnreadAnswerError(words.month)
    return {"text": text}


def _nothing(item: QuestionnaireItem, answer: ItemAnswer, words: QuestionnaireWords) -> Markup:
    return joined()


def _read_nothing(
    item: QuestionnaireItem, form: Form, words: QuestionnaireWords
) -> Mapping[str, Any]:
    raise UnreadAnswerError(words.refused)


# -- words ----------------------------------------------------------------------------------------


def _text(item: QuestionnaireItem, answer: ItemAnswer, words: QuestionnaireWords) -> Markup:
    return tag(
        "textarea",
        "\n" if answer.text.startswith("\n") else None,  # the first one is no part of the text
        answer.text,
        name="text",
        rows=item.lines or _LINES,
        maxlength=LONGEST,
        required=_required(item),
        aria_label=wording(item),
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
    "choice": ItemForm(_choices, _read_choices),
    "choices": ItemForm(_choices, _read_choices),
    "month": ItemForm(_month, _read_month),
    "page": ItemForm(_nothing, _read_nothing),
}
