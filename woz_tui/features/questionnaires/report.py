"""Answers to questionnaires as tables of reports and exports."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from woz_tui.analysis.feature_report import BehaviourTable, FeatureReport
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.tables import SETTINGS, Cell, Column, TableDefinition, rounded
from woz_tui.features.questionnaires.figures import AnswerRow, asked_in
from woz_tui.system.text_cleaning import seconds as exact

#: What the table of settings says of where something was.
_PLACES: dict[str, Column[Any]] = {column.name: column for column in SETTINGS.columns}


def _of(name: str, kind: str, meaning: str) -> Column[Any]:
    return Column(name, kind, meaning, lambda _, answer: getattr(answer, name))


_ROUND: tuple[Column[Any], ...] = (
    *(_PLACES[each] for each in ("log", "session", "participant", "condition", "trial", "phase")),
    _of("questionnaire", "string", "name of the questionnaire"),
    _of("round", "integer", "how often it was given so far in this session, from 1"),
)
_COUNTED = _of(
    *("counted", "boolean"),
    "means include it: it has a participant, and it was not asked in a trial that does not count",
)
#: Of a round in the wide table.
_WIDE = (*_ROUND, _COUNTED)

ANSWERS: TableDefinition[AnswerRow] = TableDefinition(
    "questionnaires",
    "The last answer to each item in each round of a questionnaire; `condition` is empty where "
    "somebody who had several was asked once about all of them.",
    (
        *_ROUND,
        _of("item", "string", "name of the item"),
        Column(
            *("value", "number", "the answer on the item's scale"),
            lambda _, answer: rounded(answer.value),
        ),
        Column("low", "number", "lower end of the scale", lambda _, it: rounded(it.low)),
        Column("high", "number", "upper end of the scale", lambda _, it: rounded(it.high)),
        Column(
            *("text", "string", "the answer to an item without a scale"),
            lambda _, answer: None if answer.skipped else answer.text or None,
        ),
        _of("skipped", "boolean", "skipped on purpose"),
        Column(
            *("response_time", "number", "from its display to the answer"),
            lambda _, it: None if it.answered_us is None else exact(it.answered_us),
            "s",
        ),
        Column(
            *("onset", "number", "when it was answered, from the session's start"),
            lambda _, answer: exact(answer.t),
            "s",
        ),
        _of("question", "string", "the item's words"),
        _COUNTED,
    ),
    lambda figures: asked_in(figures).answers,
    key=("log", "questionnaire", "round", "item"),
)


class QuestionnaireReport(FeatureReport):
    """Answers by item, and by round."""

    tables = (ANSWERS,)
    about = ("`questionnaires.csv`, `questionnaires_wide.csv`: answers",)
    behaviour = BehaviourTable(
        ANSWERS,
        (
            *("questionnaire", "round", "item", "value", "low", "high", "text", "skipped"),
            *("response_time", "onset", "condition", "trial", "phase", "counted", "question"),
        ),
    )

    def wide_rows(self, figures: SessionFigures) -> Sequence[Mapping[str, Cell]]:
        rounds: dict[tuple[str, int], dict[str, Cell]] = {}
        for answer in asked_in(figures).answers:
            key = (answer.questionnaire, answer.round)
            if key not in rounds:
                rounds[key] = {column.name: column.cell(figures, answer) for column in _WIDE}
            value = answer.text if answer.value is None else rounded(answer.value)
            rounds[key][f"{answer.questionnaire}.{answer.item}"] = None if answer.skipped else value
        return list(rounds.values())

    def wide_table(self, rows: Iterable[Mapping[str, Cell]]) -> TableDefinition[Mapping[str, Cell]]:
        """A column for each item, which is called `<questionnaire>.<item>`."""
        items = dict.fromkeys(name for row in rows for name in row if "." in name)
        return answers_wide(items)


def answers_wide(items: Iterable[str]) -> TableDefinition[Mapping[str, Cell]]:
    """A row for each round of a questionnaire, with a column for each of `items`."""

    def column(name: str, kind: str, meaning: str) -> Column[Mapping[str, Cell]]:
        return Column(name, kind, meaning, lambda _, row: row.get(name))

    meaning = "the number that was chosen, or the text that was typed"
    return TableDefinition(
        "questionnaires_wide",
        "The answers once more: one row for each round of a questionnaire, and a column for each "
        "item.",
        (
            *(column(each.name, each.type, each.meaning) for each in _WIDE),
            *(column(item, "string", meaning) for item in items),
        ),
        lambda figures: (),
    )


REPORT = QuestionnaireReport()
