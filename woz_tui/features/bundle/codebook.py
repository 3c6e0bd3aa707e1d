"""What each variable means, by names that R, Python and SPSS take: one row for each item that the
experiment file asks, and for each score and column of the tables.

What an item means, questionnaires say (`questionnaires.codebook`): it comes from the file, not from
what was answered.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from woz_tui.features.questionnaires.codebook import Variable as AskedVariable
from woz_tui.features.questionnaires.codebook import variables
from woz_tui.features.questionnaires.items import NUMBERS
from woz_tui.features.questionnaires.score_codebook import defined_scores
from woz_tui.protocol.welcome import Questionnaire
from woz_tui.system.text_cleaning import cell

#: The table in which items are columns.
ANSWERS = "answers"
#: SPSS takes longer names, but shows no more.
_LONGEST = 32
HEADS = (
    *("table", "variable", "label", "question", "instrument", "item", "number", "type", "values"),
    *("missing", "reversed", "unit", "asked", "version"),
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
    `shift` is added to them where they are shown. `withheld`: why it is in no table. `of`: the item
    of which it is. `version`: from 1, if the experiment file gave it several meanings, each of
    which is a variable; `meaning` tells them apart.
    """

    table: str
    name: str
    label: str
    type: str
    question: str = ""
    questionnaire: str = ""
    item: str = ""
    number: int = 0
    low: float | None = None
    high: float | None = None
    labels: Mapping[int, str] = field(default_factory=dict)
    unit: str = ""
    asked: str = ""
    missing: str = ""
    reversed: bool = False
    shift: int = 0
    withheld: str = ""
    is_score: bool = False
    of: AskedVariable | None = None
    version: int = 0
    meaning: Hashable = None

    @property
    def values(self) -> str:
        """`1 = not at all; 7 = very much`."""
        named = [f"{value} = {label}" for value, label in self.labels.items()]
        if self.low is not None and not named:
            named = [f"{self.low:g} to {self.high:g}"]
        if self.shift and self.low is not None and self.high is not None:
            named.append(f"shown as {self.low + self.shift:g} to {self.high + self.shift:g}")
        return "; ".join(named)


def items_of(questionnaires: Iterable[Questionnaire]) -> list[Variable]:
    """A variable for each item, each choice of several, and each score. Of a questionnaire that was
    changed there are several versions, in the order in which they were played: what means the same
    in them is one variable.
    """
    versions: dict[tuple[str, str], list[Variable]] = {}
    for asked in questionnaires:
        for each in defined_in(asked):
            known = versions.setdefault((each.questionnaire, each.name), [])
            if each.meaning not in [one.meaning for one in known]:
                known.append(each)
    names: set[str] = set()
    found: list[Variable] = []
    for known in versions.values():
        for number, each in enumerate(known, start=1):
            named = replace(each, name=_unique(each.name, names))
            if len(known) > 1:
                label = f"{each.label} (version {number} of {len(known)})"
                named = replace(named, label=label, version=number)
            found.append(named)
    return found


def defined_in(asked: Questionnaire) -> Iterator[Variable]:
    """The variables of one version of a questionnaire, by the names that the tables of exports
    give them.
    """
    meanings: dict[str, Hashable] = {}
    for each in variables(asked):
        variable = _item(each)
        meanings[each.item.name] = variable.meaning
        yield variable
    for score in defined_scores(asked):
        yield Variable(
            *(ANSWERS, score.name, score.in_words, "number"),
            questionnaire=asked.name,
            item=score.score.name,
            low=score.low,
            high=score.high,
            asked=_WHENS.get(asked.when, asked.when),
            is_score=True,
            meaning=(score, *(meanings.get(name) for name in score.score.items)),
        )


def _item(of: AskedVariable) -> Variable:
    asked, item = of.questionnaire, of.item
    ranged = of.is_number and item.asks in NUMBERS
    low, high = (item.low, item.high) if ranged else (None, None)
    return Variable(
        table=ANSWERS,
        name=of.name,
        label=of.question or item.name,
        type="integer" if of.is_number else "string",
        question=of.question,
        questionnaire=asked.name,
        item=item.name,
        number=[each.name for each in asked.items].index(item.name) + 1,
        low=low,
        high=high,
        labels=dict(of.labels),
        unit=item.unit,
        asked=_WHENS.get(asked.when, asked.when),
        missing="; ".join(filter(None, (item.does_not_apply, item.prefer_not))),
        reversed=item.reverse,
        shift=item.shift if ranged else 0,
        withheld=_why_withheld(of),
        of=of,
        meaning=(of.question, item.asks, low, high, tuple(of.labels.items()), item.unit),
    )


def _why_withheld(of: AskedVariable) -> str:
    if of.item.private:
        return "withheld: private"
    return "" if of.is_number else "withheld: people's own words"


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
        *(each.number or None, each.type, each.values, _missing(each)),
        *("yes" if each.reversed else "", each.unit, each.asked, each.version or None),
    )


def _missing(each: Variable) -> str:
    return each.withheld or "; ".join(
        filter(None, ("empty = no answer or no such value", each.missing))
    )


def _markdown(variables: Sequence[Variable]) -> Iterator[str]:
    yield "# Codebook"
    items = [each for each in variables if each.questionnaire]
    for name in dict.fromkeys(each.questionnaire for each in items):
        of_it = [each for each in items if each.questionnaire == name]
        yield from ("", f"## {name} (asked {of_it[0].asked})", "")
        yield from ("| variable | question | values |", "|---|---|---|")
        for each in of_it:
            values = each.withheld or each.values
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
