"""What each variable of the answers means: one definition for the wide table and the codebook.

It comes from the experiment file that a log holds, not from the answers: a redacted log has it, and
an item that nobody has answered stands in it.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from woz_tui.analysis.feature_report import GatheredTables
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.tables import Cell, Column, TableDefinition, rounded
from woz_tui.export.redaction import PLACEHOLDER
from woz_tui.features.questionnaires.figures import AnswerRow, asked_in
from woz_tui.features.questionnaires.items import (
    MONTH,
    NUMBERS,
    in_language,
    value_labels,
    ways_out,
    wording,
)
from woz_tui.features.questionnaires.score_codebook import (
    SCORE_CODEBOOK,
    DefinedScore,
    defined_scores,
)
from woz_tui.protocol.welcome import ItemCondition, Questionnaire, QuestionnaireItem

_TICKED = {0: "not chosen", 1: "chosen"}


@dataclass(frozen=True, slots=True)
class Variable:
    """A column of the wide table: an item, one of several choices of it (`choice`), or the words
    for *other* (`words`).
    """

    questionnaire: Questionnaire
    item: QuestionnaireItem
    choice: int | None = None
    words: bool = False

    @property
    def name(self) -> str:
        """`questionnaire.item`, with the code of a choice."""
        parts = [self.questionnaire.name, self.item.name]
        parts += ["other"] if self.words else [] if self.choice is None else [str(self.choice)]
        return ".".join(parts)

    @property
    def is_number(self) -> bool:
        """Whether its values are whole numbers."""
        coded = self.item.asks in (*NUMBERS, "choice") or self.choice is not None
        return coded and not self.words

    @property
    def question(self) -> str:
        """What was asked, with the choice that this column is about."""
        choices = value_labels(self.item)
        about = "" if self.choice is None else f": {choices.get(self.choice, '')}"
        return f"{wording(self.item)}{about}{' (other, in words)' if self.words else ''}"

    @property
    def labels(self) -> Mapping[int, str]:
        """What its values are called."""
        if self.words or not self.is_number:
            return {}
        return _TICKED if self.choice is not None else value_labels(self.item)

    @property
    def more(self) -> Mapping[str, Any]:
        """What a data package says of the field besides."""
        found: dict[str, Any] = {"title": self.question}
        if self.item.asks in NUMBERS:
            found["constraints"] = {"minimum": self.item.low, "maximum": self.item.high}
        elif self.is_number:
            found["constraints"] = {"enum": [*self.labels]}
        elif self.item.asks == "month":
            found["constraints"] = {"pattern": rf"{MONTH.pattern}|{re.escape(PLACEHOLDER)}"}
        if self.labels:
            found["categories"] = [
                {"value": value, "label": text} for value, text in self.labels.items()
            ]
            found["categoriesOrdered"] = self.item.asks in NUMBERS
        return found

    def cell(self, answer: AnswerRow) -> Cell:
        """What stands there for an answer; nothing without one."""
        if answer.reason:
            return None
        if self.choice is not None:
            return int(self.choice in answer.values)
        if answer.value is None or self.words:
            return answer.text or None
        return rounded(answer.value)


def variables(questionnaire: Questionnaire) -> Iterator[Variable]:
    """All of a questionnaire, in the order of the file."""
    for item in questionnaire.items:
        if item.asks == "page":
            continue
        if item.asks == "choices":
            for choice in item.choices:
                yield Variable(questionnaire, item, choice.value)
        else:
            yield Variable(questionnaire, item)
        if item.other is not None:
            yield Variable(questionnaire, item, words=True)


# -- the wide table --------------------------------------------------------------------------------


def wide_table(
    before: Sequence[Column[Any]], columns: Iterable[Column[Mapping[str, Cell]]]
) -> TableDefinition[Mapping[str, Cell]]:
    """A row for each round of a questionnaire, with `columns` behind those that tell which."""
    return TableDefinition(
        "questionnaires_wide",
        "The answers once more: one row for each round of a questionnaire, and a column for each "
        "item; of several choices, one for each of them; and one for each score.",
        (*(_column(each.name, each.type, each.meaning) for each in before), *columns),
        lambda figures: (),
    )


def _column(
    name: str, kind: str, meaning: str, more: Mapping[str, Any] | None = None
) -> Column[Mapping[str, Cell]]:
    return Column(name, kind, meaning, lambda _, row: row.get(name), more=more or {})


def answer_column(found: Sequence[Variable]) -> Column[Mapping[str, Cell]]:
    """The column of a variable; `found`: its definitions, several if the file was changed."""
    first = found[0]
    same = all(each.more == first.more for each in found)
    kind = "integer" if all(each.is_number for each in found) else "string"
    called = "; ".join(f"{value}: {text}" for value, text in first.labels.items())
    meaning = " / ".join(dict.fromkeys(each.question for each in found))
    meaning = f"{meaning} ({called})" if called and same else meaning
    return _column(first.name, kind, meaning, first.more if same else {})


# -- the codebook ----------------------------------------------------------------------------------

_Definition = tuple[int, Variable]


def _code(name: str, kind: str, meaning: str, of: Any) -> Column[_Definition]:
    return Column(name, kind, meaning, lambda _, row: of(row[1]))


def _item(name: str, kind: str, meaning: str, field: str = "") -> Column[_Definition]:
    return _code(name, kind, meaning, lambda it: getattr(it.item, field or name) or None)


def _values(variable: Variable) -> Cell:
    return "; ".join(f"{text} = {value}" for value, text in variable.labels.items()) or None


def _end(variable: Variable, *, high: bool) -> Cell:
    item = variable.item
    return (item.high if high else item.low) if item.asks in NUMBERS else None


def _missing(variable: Variable) -> Cell:
    item = variable.item
    said = {"does_not_apply": item.does_not_apply, "prefer_not": item.prefer_not}
    ways = [f"{way} = {said[way]}" if said.get(way) else way for way in ways_out(item)]
    ways += ["not_shown"] if item.only_if is not None else []
    ways += ["private"] if item.private else []
    return "; ".join([*ways, "declined", "left"])


def _only_if(variable: Variable) -> Cell:
    rule = variable.item.only_if
    return None if rule is None else rule_text(rule)


def rule_text(rule: ItemCondition) -> str:
    """`known = 1 or 3`."""
    parts = [f"= {' or '.join(map(str, rule.values))}"] if rule.values else []
    parts += [f">= {rule.at_least:g}"] if rule.at_least is not None else []
    parts += [f"<= {rule.at_most:g}"] if rule.at_most is not None else []
    return f"{rule.item} {' and '.join(parts)}"


def _others(variable: Variable) -> Cell:
    asked, found = variable.questionnaire, []
    for language in (each.language for each in asked.versions):
        items = {each.name: each for each in in_language(asked, language).items}
        if (item := items.get(variable.item.name)) is not None:
            found.append(f"{language}: {wording(item)}")
    return "; ".join(found) or None


CODEBOOK: TableDefinition[_Definition] = TableDefinition(
    "codebook",
    "What each column of answers in `questionnaires_wide.csv` means, as the experiment files say: "
    "one row a variable, and one more for each other wording of it.",
    (
        _code("variable", "string", "name of the column", lambda it: it.name),
        Column(
            *("version", "integer", "1; a higher number: the experiment file was changed"),
            lambda _, row: row[0],
        ),
        _code(
            "questionnaire", "string", "name of the questionnaire", lambda it: it.questionnaire.name
        ),
        _code("title", "string", "title of the questionnaire", lambda it: it.questionnaire.title),
        _code("when", "string", "when it is due", lambda it: it.questionnaire.when),
        _code("item", "string", "name of the item", lambda it: it.item.name),
        _code(
            *("item_type", "string", "scale, slider, number, choice, choices, month or text"),
            lambda it: it.item.asks,
        ),
        _code("question", "string", "what was asked", lambda it: it.question),
        _code("other_languages", "string", "the same in other languages", _others),
        _code("low", "integer", "the lowest value", lambda it: _end(it, high=False)),
        _code("high", "integer", "the highest value", lambda it: _end(it, high=True)),
        _code("labels", "string", "what values are called", _values),
        _item("unit", "string", "unit of a number"),
        _code("missing", "string", "why there can be no value", _missing),
        _code("reverse", "boolean", "scores count it reversed", lambda it: it.item.reverse),
        _code(
            *("shown_offset", "integer", "what the number on the screen had more than the value"),
            lambda it: it.item.shift if it.item.asks in NUMBERS else None,
        ),
        _code(
            *("numbers_shown", "boolean", "the numbers of the points were shown"),
            lambda it: it.item.numbers if it.item.asks in NUMBERS else None,
        ),
        _code("flip", "boolean", "chance decided which end was left", lambda it: it.item.flip),
        _code("shuffled", "boolean", "in an order by chance", lambda it: it.questionnaire.shuffled),
        _item("group", "string", "items of one group stay together in such an order"),
        _code("only_if", "string", "the earlier answer without which it is not asked", _only_if),
        _code("private", "boolean", "left out unless asked for", lambda it: it.item.private),
    ),
    lambda figures: (),
    key=("variable", "version"),
)


class AnswerTables(GatheredTables):
    """The wide table and the codebook of many sessions.

    Args:
        before: Columns of a round.
    """

    def __init__(self, before: Sequence[Column[Any]]) -> None:
        self._before = before
        self._rows: list[Mapping[str, Cell]] = []
        #: By name of the column.
        self._variables: dict[str, list[Variable]] = {}
        self._scores: dict[str, list[DefinedScore]] = {}

    def add(self, figures: SessionFigures) -> None:
        found = asked_in(figures)
        given = {each.questionnaire for each in found.rounds}
        here: dict[tuple[str, str], list[Variable]] = {}
        for asked in found.questionnaires:
            for variable in variables(asked) if asked.name in given else ():
                here.setdefault((asked.name, variable.item.name), []).append(variable)
                known = self._variables.setdefault(variable.name, [])
                if variable not in known:
                    known.append(variable)
            for score in defined_scores(asked) if asked.name in given else ():
                those = self._scores.setdefault(score.name, [])
                if score not in those:
                    those.append(score)
        rounds: dict[tuple[str, int], dict[str, Cell]] = {}
        for answer in (*found.answers, *found.missing):
            key = (answer.questionnaire, answer.round)
            if key not in rounds:
                rounds[key] = {column.name: column.cell(figures, answer) for column in self._before}
            for variable in here.get((answer.questionnaire, answer.item), ()):
                rounds[key][variable.name] = variable.cell(answer)
        for row in found.scores:
            if (there := rounds.get((row.questionnaire, row.round))) is not None:
                there[f"{row.questionnaire}.{row.score}"] = rounded(row.value)
        self._rows += rounds.values()

    def tables(self) -> Iterator[tuple[TableDefinition[Any], Sequence[Any]]]:
        columns = [answer_column(found) for found in self._variables.values()]
        columns += [
            _column(name, "number", found[0].in_words) for name, found in self._scores.items()
        ]
        yield wide_table(self._before, columns), self._rows
        every = self._variables.values()
        yield CODEBOOK, [row for found in every for row in enumerate(found, start=1)]
        scores = self._scores.values()
        yield SCORE_CODEBOOK, [row for found in scores for row in enumerate(found, start=1)]
