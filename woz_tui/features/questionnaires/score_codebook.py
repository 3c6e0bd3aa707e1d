"""How each score is made, as the experiment file in a log says."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from woz_tui.analysis.tables import Cell, Column, TableDefinition, rounded
from woz_tui.features.questionnaires.scoring import SUS, score_range
from woz_tui.protocol.welcome import Questionnaire, QuestionnaireScore


@dataclass(frozen=True, slots=True)
class DefinedScore:
    """A score of a questionnaire. `low` and `high`: between which it is, if that can be said."""

    questionnaire: str
    score: QuestionnaireScore
    low: float | None
    high: float | None

    @property
    def name(self) -> str:
        """`questionnaire.score`, as in the wide table."""
        return f"{self.questionnaire}.{self.score.name}"

    @property
    def reversed(self) -> tuple[str, ...]:
        """Items that count from the other end."""
        return self.score.items[1::2] if self.score.how == SUS else self.score.reverse

    @property
    def in_words(self) -> str:
        """How it is made."""
        turned = f" (reversed: {', '.join(self.reversed)})" if self.reversed else ""
        return f"{self.score.how} of {', '.join(self.score.items)}{turned}"


def defined_scores(asked: Questionnaire) -> Iterator[DefinedScore]:
    """All scores of a questionnaire, in the order of the file."""
    items = {item.name: item for item in asked.items}
    for score in asked.scores:
        scales = [(items[name].low, items[name].high) for name in score.items if name in items]
        low, high = score.onto or score_range(score.how, scales)
        yield DefinedScore(asked.name, score, low, high)


_Definition = tuple[int, DefinedScore]


def _code(name: str, kind: str, meaning: str, of: Any) -> Column[_Definition]:
    return Column(name, kind, meaning, lambda _, row: of(row[1]))


def _weights(defined: DefinedScore) -> Cell:
    score = defined.score
    if score.pairs:
        return f"how often it was chosen in {', '.join(score.pairs)}"
    named = zip(score.items, score.weights, strict=False)
    return ", ".join(f"{item}: {weight:g}" for item, weight in named) or None


SCORE_CODEBOOK: TableDefinition[_Definition] = TableDefinition(
    "codebook_scores",
    "How each score in `questionnaires_wide.csv` is made, as the experiment files say: one row a "
    "score, and one more for each other way.",
    (
        _code("variable", "string", "name of the column", lambda it: it.name),
        Column(
            *("version", "integer", "1; a higher number: the experiment file was changed"),
            lambda _, row: row[0],
        ),
        _code("questionnaire", "string", "name of the questionnaire", lambda it: it.questionnaire),
        _code("score", "string", "name of the score", lambda it: it.score.name),
        _code("how", "string", "mean, sum, sus or weighted", lambda it: it.score.how),
        _code("items", "string", "names of its items", lambda it: ", ".join(it.score.items)),
        _code(
            *("reversed", "string", "those that count from the other end"),
            lambda it: ", ".join(it.reversed) or None,
        ),
        _code("weights", "string", "of a weighted one: what each item weighs", _weights),
        _code(
            *("may_be_missing", "integer", "with more items without an answer there is no score"),
            lambda it: it.score.missing,
        ),
        _code("low", "number", "the lowest score that there can be", lambda it: rounded(it.low)),
        _code("high", "number", "the highest score that there can be", lambda it: rounded(it.high)),
    ),
    lambda figures: (),
    key=("variable", "version"),
)
