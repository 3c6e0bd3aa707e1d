"""Answers to questionnaires as tables of reports and exports."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from woz_tui.analysis.feature_report import BehaviourTable, FeatureReport
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.report_table import ReportTable
from woz_tui.analysis.tables import SETTINGS, Column, TableDefinition, rounded
from woz_tui.features.questionnaires.codebook import AnswerTables, variables
from woz_tui.features.questionnaires.figures import (
    REASONS,
    AnswerRow,
    QuestionnaireFigures,
    answer_table,
    asked_in,
    score_table,
)
from woz_tui.features.questionnaires.score_tables import SCORE_ITEMS, SCORES
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
ROUND_COLUMNS = (*_ROUND, _COUNTED)


def _rows(figures: SessionFigures) -> Iterator[AnswerRow]:
    """Each round: what was answered, and behind it what was not."""
    found = asked_in(figures)
    for each in found.rounds:
        key = (each.questionnaire, each.round)
        for row in (*found.answers, *found.missing):
            if (row.questionnaire, row.round) == key:
                yield row


def _text(name: str, meaning: str, field: str = "") -> Column[Any]:
    return Column(name, "string", meaning, lambda _, row: getattr(row, field or name) or None)


ANSWERS: TableDefinition[AnswerRow] = TableDefinition(
    "questionnaires",
    "The last answer to each item in each round of a questionnaire, or why there is none; "
    "`condition` is empty where somebody who had several was asked once about all of them.",
    (
        *_ROUND,
        _of("item", "string", "name of the item"),
        _text("item_type", "scale, slider, number, choice, choices, month or text", "kind"),
        Column(
            *("value", "number", "the answer: a number of the scale, or the code of a choice"),
            lambda _, answer: None if answer.skipped else rounded(answer.value),
        ),
        _text("answer_label", "what the answer is called", "label"),
        Column(
            *("choices", "string", "codes of the choices, where several are possible"),
            lambda _, answer: ";".join(map(str, answer.values)) or None,
        ),
        Column("low", "number", "lower end of the scale", lambda _, it: rounded(it.low)),
        Column("high", "number", "upper end of the scale", lambda _, it: rounded(it.high)),
        _text("low_label", "what the lower end is called"),
        _text("high_label", "what the upper end is called"),
        Column(
            *("text", "string", "the answer to an item without a scale"),
            lambda _, answer: None if answer.skipped else answer.text or None,
        ),
        _of("skipped", "boolean", "skipped on purpose"),
        _text(
            "missing",
            "why there is no answer: skipped, does_not_apply, prefer_not, declined or left (the "
            "whole questionnaire), not_shown (after an earlier answer), private; empty: there is "
            "one",
            "reason",
        ),
        Column(
            *("position", "integer", "as which question it was shown, from 1"),
            lambda _, answer: answer.position or None,
        ),
        _of("flipped", "boolean", "the upper end stood on the left"),
        _text(
            "given",
            "who answered: self (at the wizard's screen), read_aloud (by the wizard), "
            "own_terminal, browser; empty: not known",
        ),
        _text("language", "the language of the questionnaire; empty: it has one only"),
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
    _rows,
    key=("log", "questionnaire", "round", "item"),
)


def _levels(figures: SessionFigures, rows: Sequence[AnswerRow]) -> Mapping[str, Mapping[str, str]]:
    """What each item asks and what its values are called."""
    known = {
        (each.questionnaire.name, each.item.name): each
        for asked in asked_in(figures).questionnaires
        for each in variables(asked)
    }
    items: dict[str, list[str]] = {}
    for row in rows:
        variable = known.get((row.questionnaire, row.item))
        labels = variable.labels if variable is not None and variable.choice is None else {}
        called = "; ".join(f"{value} = {text}" for value, text in labels.items())
        told = f"{row.question} ({called})" if called else row.question
        told = told or row.item
        if told not in items.setdefault(row.item, []):
            items[row.item].append(told)
    reasons = {row.reason for row in rows if row.reason}
    return {
        "item": {name: " / ".join(told) for name, told in items.items()},
        "missing": {each: REASONS.get(each, _WHY.get(each, each)) for each in sorted(reasons)},
    }


#: What other reasons mean.
_WHY = {
    "declined": "the participant did not want to answer the questionnaire any further",
    "left": "the questionnaire was left before its end",
    "not_shown": "an earlier answer has ruled it out",
}


class QuestionnaireReport(FeatureReport):
    """Answers by item, and by round."""

    tables = (ANSWERS, SCORES, SCORE_ITEMS)
    about = (
        "`questionnaires.csv`, `questionnaires_wide.csv`: answers; `codebook.csv`: what each of"
        " them means",
        "`questionnaire_scores.csv`, `questionnaire_score_items.csv`: what several items amount to;"
        " `codebook_scores.csv`: how",
    )
    behaviour = BehaviourTable(
        ANSWERS,
        (
            *("questionnaire", "round", "item", "item_type", "value", "answer_label", "choices"),
            *("low", "high", "low_label", "high_label", "text", "skipped", "missing", "position"),
            *("flipped", "given", "language", "response_time", "onset", "condition", "trial"),
            *("phase", "counted", "question"),
        ),
        _levels,
    )

    def gathered(self) -> AnswerTables:
        return AnswerTables(ROUND_COLUMNS)

    def session_tables(self, figures: QuestionnaireFigures) -> Iterator[ReportTable]:
        yield score_table(figures)
        yield answer_table(figures)


REPORT = QuestionnaireReport()
