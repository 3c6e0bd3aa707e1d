"""Scores of questionnaires as files of reports and exports."""

from __future__ import annotations

from typing import Any

from woz_tui.analysis.tables import SETTINGS, Column, TableDefinition, rounded
from woz_tui.features.questionnaires.figures import asked_in
from woz_tui.features.questionnaires.score_rows import ScoreItemRow, ScoreRow, item_rows

#: What the table of settings says of where something was.
_PLACES: dict[str, Column[Any]] = {column.name: column for column in SETTINGS.columns}


def _of(name: str, kind: str, meaning: str) -> Column[Any]:
    return Column(name, kind, meaning, lambda _, row: getattr(row, name))


def _number(name: str, meaning: str) -> Column[Any]:
    return Column(name, "number", meaning, lambda _, row: rounded(getattr(row, name)))


def _of_item(name: str, kind: str, meaning: str) -> Column[Any]:
    return Column(name, kind, meaning, lambda _, row: getattr(row.item, name))


def _number_of_item(name: str, meaning: str) -> Column[Any]:
    return Column(name, "number", meaning, lambda _, row: rounded(getattr(row.item, name)))


_ROUND: tuple[Column[Any], ...] = (
    *(_PLACES[each] for each in ("log", "session", "participant", "condition", "trial", "phase")),
    _of("questionnaire", "string", "name of the questionnaire"),
    _of("round", "integer", "how often it was given so far in this session, from 1"),
    _of("score", "string", "name of the score"),
)
_COUNTED = _of(
    *("counted", "boolean"),
    "means include it: it has a participant, and it was not asked in a trial that does not count",
)

SCORES: TableDefinition[ScoreRow] = TableDefinition(
    "questionnaire_scores",
    "What several items of a questionnaire amount to, in each round of it that has an answer.",
    (
        *_ROUND,
        _of("how", "string", "how it is made: mean, sum, sus or weighted"),
        _number("value", "the score; empty if too many items have no answer"),
        _number("low", "the lowest score that there can be"),
        _number("high", "the highest score that there can be"),
        Column("items", "integer", "items that it is made of", lambda _, row: len(row.items)),
        _of("missing", "integer", "how many of them have no answer"),
        _COUNTED,
    ),
    lambda figures: asked_in(figures).scores,
    key=("log", "questionnaire", "round", "score"),
)

SCORE_ITEMS: TableDefinition[ScoreItemRow] = TableDefinition(
    "questionnaire_score_items",
    "The items of each score, as they were answered and as they count.",
    (
        *_ROUND,
        Column("item", "string", "name of the item", lambda _, row: row.item.item),
        _number_of_item("raw", "the answer, as in `questionnaires`"),
        _number_of_item("scored", "what counts: the answer, turned round if `reversed`"),
        _of_item("reversed", "boolean", "it counts from the other end of its scale"),
        _number_of_item("low", "lower end of the item's scale"),
        _number_of_item("high", "upper end of the item's scale"),
        _number_of_item("weight", "what it weighs in a weighted score; empty in any other"),
        _COUNTED,
    ),
    lambda figures: item_rows(asked_in(figures).scores),
    key=("log", "questionnaire", "round", "score", "item"),
)
