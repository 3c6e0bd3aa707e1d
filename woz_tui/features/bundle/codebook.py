"""What each variable means: one row for each item that the experiment file asks, and one for each
column of the tables.

Items come from the file, not from what was answered: what nobody answered is there, too.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from woz_tui.protocol.welcome import Questionnaire, QuestionnaireItem
from woz_tui.system.text_cleaning import cell

#: The table in which items are columns.
ANSWERS = "answers"
#: SPSS takes longer names, but shows no more.
_LONGEST = 32
HEADS = (
    *("table", "variable", "label", "question", "instrument", "item", "number", "type", "values"),
    *("missing", "unit", "asked"),
)
_WHENS = {
    "start": "at the beginning",
    "trial": "after each trial",
    "condition": "after each condition",
    "end": "at the end",
    "hand": "when the wizard chose",
}


@dataclass(frozen=True, slots=True)
class Variable:
    """One variable. `low` and `high` are the ends of its scale, `labels` what its numbers mean;
    `withheld`: it is in no table, since people answered in their own words.
    """

    table: str
    name: str
    label: str
    type: str
    question: str = ""
    questionnaire: str = ""
    item: str = ""
    number: int = 0
    low: int | None = None
    high: int | None = None
    labels: Mapping[int, str] = field(default_factory=dict)
    unit: str = ""
    asked: str = ""
    withheld: bool = False

    @property
    def values(self) -> str:
        """`1 = not at all; 7 = very much`."""
        named = [f"{value} = {label}" for value, label in self.labels.items()]
        if self.low is not None and not named:
            return f"{self.low} to {self.high}"
        return "; ".join(named)


def items_of(questionnaires: Iterable[Questionnaire]) -> list[Variable]:
    """A variable for each item. This is all that the bundle knows of items."""
    found: list[Variable] = []
    names: set[str] = set()
    for each in questionnaires:
        for number, item in enumerate(each.items, 1):
            found.append(_variable(each, item, number, _unique(f"{each.name}_{item.name}", names)))
    return found


def _variable(
    questionnaire: Questionnaire, item: QuestionnaireItem, number: int, name: str
) -> Variable:
    low, high = (None, None) if item.text else (item.low, item.high)
    ends = {} if item.text else dict(zip((item.low, item.high), item.ends, strict=True))
    return Variable(
        table=ANSWERS,
        name=name,
        label=item.question or item.name,
        type="string" if item.text else "integer",
        question=item.question,
        questionnaire=questionnaire.name,
        item=item.name,
        number=number,
        low=low,
        high=high,
        labels={value: label for value, label in ends.items() if label},
        asked=_WHENS.get(questionnaire.when, questionnaire.when),
        withheld=item.text,
    )


def _unique(text: str, taken: set[str]) -> str:
    """A name that R, Python and SPSS take: small letters, digits and `_`."""
    plain = re.sub(r"[^a-z0-9]+", "_", text.lower()).strip("_")
    plain = plain if plain[:1].isalpha() else f"v_{plain}"
    name, number = plain[:_LONGEST], 1
    while name in taken:
        number += 1
        name = f"{plain[: _LONGEST - 1 - len(str(number))]}_{number}"
    taken.add(name)
    return name


def as_csv(variables: Iterable[Variable]) -> str:
    """The codebook as a table."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\r\n")
    writer.writerow(HEADS)
    writer.writerows([cell(value) for value in _row(each)] for each in variables)
    return stream.getvalue()


def as_markdown(variables: Sequence[Variable]) -> str:
    """The codebook to read: items by questionnaire, then columns by table."""
    return "\n".join(_markdown(variables)) + "\n"


def _row(each: Variable) -> Sequence[str | int | None]:
    return (
        *(each.table, each.name, each.label, each.question, each.questionnaire, each.item),
        *(each.number or None, each.type, each.values, _missing(each), each.unit, each.asked),
    )


def _missing(each: Variable) -> str:
    return "withheld: people's own words" if each.withheld else "empty = no answer or no such value"


def _markdown(variables: Sequence[Variable]) -> Iterator[str]:
    yield "# Codebook"
    items = [each for each in variables if each.questionnaire]
    for name in dict.fromkeys(each.questionnaire for each in items):
        of_it = [each for each in items if each.questionnaire == name]
        yield from ("", f"## {name} (asked {of_it[0].asked})", "")
        yield from ("| variable | question | values |", "|---|---|---|")
        for each in of_it:
            values = "withheld" if each.withheld else each.values
            yield f"| {each.name} | {_plain(each.label)} | {_plain(values)} |"
    columns = [each for each in variables if not each.questionnaire]
    for table in dict.fromkeys(each.table for each in columns):
        yield from ("", f"## Table {table}", "", "| column | type | meaning |", "|---|---|---|")
        for each in columns:
            if each.table == table:
                unit = f" ({each.unit})" if each.unit else ""
                yield f"| {each.name} | {each.type} | {_plain(each.label)}{unit} |"


def _plain(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")
