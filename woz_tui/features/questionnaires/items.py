"""What items of questionnaires mean: how they are shown, which are asked, what an answer says."""

from __future__ import annotations

import random
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from msgspec.structs import replace

from woz_tui.protocol.welcome import ItemLabel, Questionnaire, QuestionnaireItem

#: Why an item has no answer although it was shown.
DOES_NOT_APPLY, PREFER_NOT, SKIPPED = "does_not_apply", "prefer_not", "skipped"
#: Why it has none although others were asked it: an earlier answer has ruled it out.
NOT_SHOWN = "not_shown"
#: Who gave the answers: at the wizard's screen which was turned round, read aloud by the wizard,
#: or by themselves.
GIVEN = ("self", "read_aloud", "own_terminal", "browser")
#: Kinds whose answer is one of some points, and those whose answer is a number.
POINTS, NUMBERS = frozenset({"scale", "slider"}), frozenset({"scale", "slider", "number"})
#: Characters of the longest answer in words.
LONGEST = 10_000
#: How a month is written.
MONTH = re.compile(r"[12]\d{3}-(0[1-9]|1[0-2])")


@dataclass(frozen=True, slots=True)
class ItemAnswer:
    """A number (of a scale or a choice), several choices, a text, or left out on purpose
    (`skipped`), in which case `reason` may say why.
    """

    value: int | None = None
    text: str = ""
    skipped: bool = False
    values: tuple[int, ...] = ()
    reason: str = ""

    def shown(self, left_out: str) -> str:
        """It in a few words; `left_out` stands for none."""
        if self.skipped:
            return left_out
        return self.text if self.value is None else str(self.value)


Answers = Mapping[str, ItemAnswer]


# -- what is asked ---------------------------------------------------------------------------------


def asked_items(
    items: Iterable[QuestionnaireItem], answers: Answers, unknown: Collection[str] = ()
) -> list[QuestionnaireItem]:
    """Those that these answers do not rule out, instructions included. `unknown`: items whose
    answers are kept back; what depends on one of them was asked if it has an answer.
    """
    found: dict[str, QuestionnaireItem] = {}
    for item in items:
        rule = item.only_if
        if rule is None or (
            rule.item in found
            and (_holds(item, answers) or (rule.item in unknown and item.name in answers))
        ):
            found[item.name] = item
    return [*found.values()]


def _holds(item: QuestionnaireItem, answers: Answers) -> bool:
    rule = item.only_if
    answer = answers.get(rule.item) if rule is not None else None
    if rule is None or answer is None or answer.skipped:
        return rule is None
    low = float("-inf") if rule.at_least is None else rule.at_least
    high = float("inf") if rule.at_most is None else rule.at_most
    values = answer.values if answer.value is None else (answer.value,)
    return any((not rule.values or v in rule.values) and low <= v <= high for v in values)


def arranged(questionnaire: Questionnaire, seed: str) -> tuple[QuestionnaireItem, ...]:
    """Its items as they are asked in one round. Where chance decides the order, instructions stay
    where they are, and items between two of them change places; those of one group stay together.
    """
    order, sides = random.Random(f"{seed}/order"), random.Random(f"{seed}/sides")
    items = [
        replace(item, flipped=sides.random() < 0.5) if item.flip else item
        for item in questionnaire.items
    ]
    if not questionnaire.shuffled:
        return tuple(items)
    found: list[QuestionnaireItem] = []
    blocks: dict[str, list[QuestionnaireItem]] = {}
    for item in [*items, None]:
        if item is None or (item.asks == "page" and not item.group):
            mixed = [*blocks.values()]
            order.shuffle(mixed)
            found += [each for block in mixed for each in block]
            found += [item] if item is not None else []
            blocks = {}
        else:
            blocks.setdefault(f"group {item.group}" if item.group else item.name, []).append(item)
    return tuple(found)


def in_language(questionnaire: Questionnaire, language: str) -> Questionnaire:
    """It in this language; as it is, where it is not in it."""
    for one in questionnaire.versions:
        if one.language == language:
            return replace(
                questionnaire,
                language=language,
                title=one.title,
                introduction=one.introduction,
                items=one.items,
            )
    return questionnaire


# -- how it is shown -------------------------------------------------------------------------------


def as_shown(item: QuestionnaireItem) -> QuestionnaireItem:
    """With the numbers and sides that somebody sees: from left to right they go up."""
    if not item.shift and not item.flipped:
        return item
    low, high = item.ends
    labels = (replace(each, value=shown_value(item, each.value)) for each in item.labels)
    return replace(
        item,
        low=item.low + item.shift,
        high=item.high + item.shift,
        ends=(high, low) if item.flipped else (low, high),
        labels=tuple(sorted(labels, key=_value)),
    )


def _value(label: ItemLabel) -> int:
    return label.value


def shown_value(item: QuestionnaireItem, value: int) -> int:
    """The number that stands for what is stored."""
    return (item.low + item.high - value if item.flipped else value) + item.shift


def stored_value(item: QuestionnaireItem, shown: int) -> int:
    """What is stored for a number that was chosen."""
    value = shown - item.shift
    return item.low + item.high - value if item.flipped else value


def ways_out(item: QuestionnaireItem) -> list[str]:
    """How an item can go without an answer, by the reason that is stored."""
    ways = [DOES_NOT_APPLY] if item.does_not_apply else []
    ways += [PREFER_NOT] if item.prefer_not else []
    return [*ways, SKIPPED] if item.optional or item.soft else ways


def way_text(item: QuestionnaireItem, way: str, left_out: str) -> str:
    """What it is called."""
    return {DOES_NOT_APPLY: item.does_not_apply, PREFER_NOT: item.prefer_not}.get(way) or left_out


# -- in words --------------------------------------------------------------------------------------


def wording(item: QuestionnaireItem) -> str:
    """What is asked, in one sentence: with the stem, or the two ends that are the question."""
    asked = item.question or " - ".join(filter(None, item.ends))
    return f"{item.stem} {asked}".strip()


def value_labels(item: QuestionnaireItem) -> dict[int, str]:
    """What values are called, as far as they have names."""
    if item.asks in ("choice", "choices"):
        return {each.value: each.text for each in item.choices}
    if item.asks not in POINTS:
        return {}
    ends = zip((item.low, item.high), item.ends, strict=True)
    named = {value: text for value, text in ends if text}
    named.update((each.value, each.text) for each in item.labels if each.text)
    return dict(sorted(named.items()))


def said(item: QuestionnaireItem, answer: ItemAnswer, left_out: str) -> str:
    """An answer in a few words, as who gave it saw it."""
    if answer.skipped:
        return way_text(item, answer.reason, left_out)
    if item.asks in ("choice", "choices"):
        return ", ".join(_chosen(item, answer))
    if answer.value is None:
        return answer.text
    shown = str(shown_value(item, answer.value))
    if item.asks not in POINTS:
        return f"{shown} {item.unit}".strip()
    return shown if item.numbers else value_labels(item).get(answer.value, shown)


def _chosen(item: QuestionnaireItem, answer: ItemAnswer) -> Iterator[str]:
    texts = {each.value: each.text for each in item.choices}
    for value in answer.values if answer.value is None else (answer.value,):
        more = f": {answer.text}" if value == item.other and answer.text else ""
        yield f"{texts.get(value, value)}{more}"


def problem_of(item: QuestionnaireItem, answer: ItemAnswer) -> str:
    """Why this is no answer to the item; empty: it is one."""
    value, codes = answer.value, [each.value for each in item.choices]
    match item.asks:
        case "text":
            return ""
        case "choice" | "choices":
            chosen: Sequence[int | None] = answer.values if item.asks == "choices" else [value]
            if (
                (value is not None and answer.values)
                or not chosen
                or any(each not in codes for each in chosen)
            ):
                return f"expected {'some' if item.asks == 'choices' else 'one'} of {codes}"
            if len(set(chosen)) < len(chosen):
                return "a choice stands twice"
            return "" if item.other in chosen or not answer.text else "no text is wanted here"
        case "month":
            return "" if MONTH.fullmatch(answer.text) else "expected a month, such as 2026-11"
        case "page":
            return "an instruction has no answer"
    if value is None or not item.low <= value <= item.high:
        return f"expected a whole number from {item.low} to {item.high}, not {value}"
    stepped = (value - item.low) % item.step == 0
    return "" if stepped else f"expected steps of {item.step} from {item.low}, not {value}"
