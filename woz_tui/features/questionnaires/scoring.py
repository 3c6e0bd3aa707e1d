"""Scores of questionnaires: what the answers to several items amount to together.

Values are those of the log; items that are to count from the other end have been turned round by
`reversed_value` before, but for `sus`, which does so itself. None: there is no answer.
"""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from dataclasses import dataclass

#: How a score is made.
MEAN, SUM, SUS, WEIGHTED = "mean", "sum", "sus", "weighted"
HOWS = (MEAN, SUM, SUS, WEIGHTED)
#: Items of the System Usability Scale, its lowest and its highest point.
SUS_ITEMS, SUS_LOW, SUS_HIGH = 10, 1, 5
#: Participants without whom nothing is said of how well items go together.
FEWEST_PEOPLE = 10
#: Items of which Cronbach's alpha is told; of two items it is the formula of Spearman and Brown.
FEWEST_ITEMS = 3

ALPHA, SPEARMAN_BROWN = "Cronbach's alpha", "Spearman-Brown"


def reversed_value(value: float, low: float, high: float) -> float:
    """An answer counted from the other end of its scale."""
    return low + high - value


def mean_score(values: Sequence[float | None], missing: int = 0) -> float | None:
    """The mean of the items that were answered; None if more than `missing` were not."""
    there = _there(values, missing)
    return statistics.fmean(there) if there else None


def sum_score(values: Sequence[float | None], missing: int = 0) -> float | None:
    """The sum of all items; for those without an answer stands the mean of the others, so that
    somebody who left one out does not have less for it.
    """
    mean = mean_score(values, missing)
    return None if mean is None else mean * len(values)


def sus_score(values: Sequence[float | None], missing: int = 0) -> float | None:
    """The System Usability Scale, 0 to 100: one less than the answer to the first item, the third
    and so on; what is lacking to 5 in the second, the fourth and so on; all times 2.5. For an item
    without an answer stands the middle of its scale.
    """
    if _there(values, missing) is None:
        return None
    middle = (SUS_LOW + SUS_HIGH) / 2
    answers = [middle if value is None else value for value in values]
    odd = sum(value - SUS_LOW for value in answers[::2])
    even = sum(SUS_HIGH - value for value in answers[1::2])
    return (odd + even) * 2.5


def weighted_score(
    values: Sequence[float | None], weights: Sequence[float], missing: int = 0
) -> float | None:
    """The mean of the items by their weights; those without an answer fall out with theirs."""
    if _there(values, missing) is None:
        return None
    found = [(v, weight) for v, weight in zip(values, weights, strict=True) if v is not None]
    total = sum(weight for _, weight in found)
    return sum(value * weight for value, weight in found) / total if total else None


def pair_weights(items: int, chosen: Sequence[float | None]) -> list[float] | None:
    """How often each of so many items was chosen in comparisons of two, each answered by an item's
    place from 1; None if a comparison has no answer, since then nobody knows the weights.
    """
    if any(place is None for place in chosen):
        return None
    return [float(sum(place == at for place in chosen)) for at in range(1, items + 1)]


def score_range(
    how: str, scales: Sequence[tuple[float, float]]
) -> tuple[float, float] | tuple[None, None]:
    """The lowest and the highest score that items with these scales can have. Items with several
    scales have no mean that could be compared with an end.
    """
    if how == SUS:
        return 0.0, 100.0
    if how == SUM:
        return sum(low for low, _ in scales), sum(high for _, high in scales)
    return scales[0] if len(set(scales)) == 1 else (None, None)


def _there(values: Sequence[float | None], missing: int) -> list[float] | None:
    """The answers; None where too many are missing."""
    there = [value for value in values if value is not None]
    return there if there and len(values) - len(there) <= missing else None


# -- how well items go together --------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Reliability:
    """How well items go together: `name` of the figure, its value, of how many participants."""

    name: str
    value: float
    n: int


def reliability(rows: Sequence[Sequence[float | None]]) -> Reliability | None:
    """Of the answers of each participant to the same items, those turned round that count from the
    other end. Participants who left one out are left out. None where a figure would mean nothing:
    fewer than `FEWEST_PEOPLE`, one item, or no differences between participants.
    """
    complete = [[v for v in row if v is not None] for row in rows if None not in row]
    if len(complete) < FEWEST_PEOPLE:
        return None
    if len(complete[0]) >= FEWEST_ITEMS:
        name, value = ALPHA, cronbach_alpha(complete)
    else:
        name, value = SPEARMAN_BROWN, spearman_brown(complete)
    return None if value is None else Reliability(name, value, len(complete))


def cronbach_alpha(rows: Sequence[Sequence[float]]) -> float | None:
    """Cronbach's alpha of a row for each participant; None where it is not defined."""
    items = len(rows[0])
    total = statistics.variance([sum(row) for row in rows])
    if items < 2 or not total:
        return None
    own: float = sum(statistics.variance(column) for column in zip(*rows, strict=True))
    return items / (items - 1) * (1 - own / total)


def spearman_brown(rows: Sequence[Sequence[float]]) -> float | None:
    """The reliability of two items together, from their correlation; None where there is none."""
    if len(rows[0]) != 2:
        return None
    first, second = zip(*rows, strict=True)
    try:
        r = statistics.correlation(first, second)
    except statistics.StatisticsError:  # all the same in one of them
        return None
    return 2 * r / (1 + r) if r > -1 else None


# -- one score -------------------------------------------------------------------------------------


def laid_onto(value: float, scale: tuple[float, float], onto: tuple[float, float]) -> float:
    """A score on another scale: the lowest one where that begins, the highest one where it ends."""
    (low, high), (first, last) = scale, onto
    return first + (value - low) / (high - low) * (last - first)


def scored(
    how: str,
    values: Sequence[float | None],
    *,
    missing: int = 0,
    weights: Sequence[float] | None = (),
) -> float | None:
    """A score of answers; `weights`: of a weighted one, None: nobody knows them."""
    if how == WEIGHTED:
        return None if weights is None else weighted_score(values, weights, missing)
    return _PLAIN[how](values, missing)


_PLAIN = {MEAN: mean_score, SUM: sum_score, SUS: sus_score}
