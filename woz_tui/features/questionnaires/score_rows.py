"""Scores of the questionnaires that were answered in a session."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, fields
from typing import Any, Protocol

from woz_tui.analysis.event_rows import ContextRow
from woz_tui.features.questionnaires import scoring
from woz_tui.protocol.welcome import Questionnaire, QuestionnaireItem, QuestionnaireScore


class Answered(Protocol):
    """What a score needs of an answer (`figures.AnswerRow`)."""

    @property
    def questionnaire(self) -> str:
        """Name."""

    @property
    def round(self) -> int:
        """How often it had been given, from 1."""

    @property
    def item(self) -> str:
        """Name."""

    @property
    def value(self) -> float | None:
        """As it is in the log."""


@dataclass(frozen=True, slots=True)
class ScoredItem:
    """An item of a score. `raw` is the answer as it is in the log (None: there is none), `scored`
    what counts, `weight` how much in a weighted score (None: the same, or nobody knows).
    """

    item: str
    raw: float | None
    scored: float | None
    reversed: bool
    low: float
    high: float
    weight: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class ScoreItemRow(ContextRow):
    """An item of a score in one round of a questionnaire."""

    questionnaire: str
    round: int
    score: str
    item: ScoredItem


@dataclass(frozen=True, slots=True, kw_only=True)
class ScoreRow(ContextRow):
    """A score of one round of a questionnaire; `value` is None where too much is missing. `low` and
    `high` are the ends of what it can be, None where items have several scales.
    """

    questionnaire: str
    round: int
    score: str
    how: str
    value: float | None
    low: float | None
    high: float | None
    items: tuple[ScoredItem, ...]

    @property
    def missing(self) -> int:
        """Items without an answer."""
        return sum(item.raw is None for item in self.items)


def item_rows(rows: Iterable[ScoreRow]) -> Iterator[ScoreItemRow]:
    """The items of these scores."""
    for row in rows:
        context: dict[str, Any] = {each.name: getattr(row, each.name) for each in _CONTEXT}
        for item in row.items:
            yield ScoreItemRow(
                **context,
                questionnaire=row.questionnaire,
                round=row.round,
                score=row.score,
                item=item,
            )


_CONTEXT = fields(ContextRow)


def score_rows(asked: Iterable[Questionnaire], answers: Iterable[Answered]) -> Iterator[ScoreRow]:
    """All scores of all rounds that have an answer, with the context of their first one."""
    known = {each.name: each for each in asked}
    rounds: dict[tuple[str, int], dict[str, Answered]] = {}
    for answer in answers:
        rounds.setdefault((answer.questionnaire, answer.round), {})[answer.item] = answer
    for (name, number), given in rounds.items():
        first = next(iter(given.values()))
        context = {each.name: getattr(first, each.name) for each in _CONTEXT}
        values = {item: answer.value for item, answer in given.items()}
        if (questionnaire := known.get(name)) is None:
            continue
        items = {item.name: item for item in questionnaire.items}
        place = {**context, "questionnaire": name, "round": number}
        yield from (_row(score, items, values, place) for score in questionnaire.scores)


def _row(
    score: QuestionnaireScore,
    known: Mapping[str, QuestionnaireItem],
    values: Mapping[str, float | None],
    place: Mapping[str, Any],
) -> ScoreRow:
    weights = _weights(score, values)
    items = [
        _item(score, known[name], values.get(name), None if weights is None else weights[at])
        for at, name in enumerate(score.items)
        if name in known
    ]
    found = [item.scored for item in items]
    told = None if weights is None else [item.weight or 0.0 for item in items]
    value = scoring.scored(
        score.how,
        found if score.how != scoring.SUS else [item.raw for item in items],
        missing=score.missing,
        weights=told,
    )
    low, high = scoring.score_range(score.how, [(item.low, item.high) for item in items])
    if score.onto is not None and low is not None and high is not None:
        value = None if value is None else scoring.laid_onto(value, (low, high), score.onto)
        low, high = score.onto
    return ScoreRow(
        **place,
        score=score.name,
        how=score.how,
        value=value,
        low=low,
        high=high,
        items=tuple(items),
    )


def _weights(
    score: QuestionnaireScore, values: Mapping[str, float | None]
) -> list[float | None] | None:
    """What each item weighs; None: nobody knows. None for an item: as much as the others."""
    if score.how != scoring.WEIGHTED:
        return [None] * len(score.items)
    if not score.pairs:
        return [*score.weights]
    found = scoring.pair_weights(len(score.items), [values.get(pair) for pair in score.pairs])
    return None if found is None else [*found]


def _item(
    score: QuestionnaireScore, item: QuestionnaireItem, raw: float | None, weight: float | None
) -> ScoredItem:
    low, high = float(item.low), float(item.high)
    turned = item.name in score.reverse
    if score.how == scoring.SUS:
        turned = score.items.index(item.name) % 2 == 1
    value = raw
    if turned and raw is not None:
        value = scoring.reversed_value(raw, low, high)
    return ScoredItem(item.name, raw, value, turned, low, high, weight)
