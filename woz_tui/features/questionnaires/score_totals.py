"""What scores of questionnaires amount to over the participants of many sessions."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from operator import attrgetter

from woz_tui.analysis.outcomes import Outcome, OutcomeName
from woz_tui.analysis.participant_groups import Total, total_of
from woz_tui.analysis.report_table import LogText, ReportTable
from woz_tui.analysis.report_tables import OVER, total_text
from woz_tui.analysis.text_format import NONE
from woz_tui.features.questionnaires.figures import scale_text
from woz_tui.features.questionnaires.score_rows import ScoreRow
from woz_tui.features.questionnaires.scoring import MEAN, SUM, Reliability, reliability


@dataclass(frozen=True, slots=True)
class ScoreTotal:
    """A score of a questionnaire in one condition: over participants, as in `Total`.
    `reliability`: of its items, by the first round of each participant in any condition.
    """

    questionnaire: str
    score: str
    how: str
    condition: str
    low: float | None
    high: float | None
    total: Total
    reliability: Reliability | None


#: A score: its questionnaire, its name, how it is made, its ends, its items.
_Score = tuple[str, str, str, float | None, float | None, tuple[str, ...]]


@dataclass(slots=True)
class _Gathered:
    outcome: Outcome
    #: Of each participant, what counted of the items in the first round.
    first: dict[str, list[float | None]] = field(default_factory=dict)
    one_scale: bool = True


class ScoreTotals:
    """The scores of one experiment."""

    def __init__(self) -> None:
        self._scores: dict[_Score, _Gathered] = {}

    def add(self, row: ScoreRow, who: str) -> None:
        """Adds a score of a round that counts."""
        items = tuple(item.item for item in row.items)
        key = (row.questionnaire, row.score, row.how, row.low, row.high, items)
        if key not in self._scores:
            title = f"{row.score}: {row.how} of {len(items)} items"
            name = OutcomeName(
                name=f"{row.questionnaire}.{row.score}", title=title, low=row.low, high=row.high
            )
            scales = {(item.low, item.high) for item in row.items}
            self._scores[key] = _Gathered(Outcome(name), one_scale=len(scales) == 1)
        found = self._scores[key]
        there = found.outcome.at(row.condition)
        there.asked.add(who)
        if row.value is None:
            there.missing["items missing"] += 1
        else:
            there.answers.setdefault(who, []).append(row.value)
        found.first.setdefault(who, [item.scored for item in row.items])

    def outcomes(self, first: Mapping[str, str]) -> list[Outcome]:
        """To be compared between conditions; those about no condition come last."""
        found = [each.outcome for each in self._scores.values()]
        for outcome in found:
            outcome.first = first
        return sorted(found, key=attrgetter("is_once"))

    def totals(self) -> list[ScoreTotal]:
        """By questionnaire, score and condition."""
        return [
            ScoreTotal(
                *(questionnaire, score, how, condition, low, high),
                total=total_of(there.answers),
                reliability=_reliability(how, found),
            )
            for (questionnaire, score, how, low, high, _), found in self._scores.items()
            for condition, there in sorted(found.outcome.conditions.items())
        ]


def _reliability(how: str, found: _Gathered) -> Reliability | None:
    """None where it would mean nothing: of items with weights, or with several scales."""
    if how not in (MEAN, SUM) or not found.one_scale:
        return None
    return reliability([*found.first.values()])


def score_total_tables(totals: Iterable[ScoreTotal], conditions: bool) -> Iterator[ReportTable]:
    """Means of scores: by condition, and of those about none of them. `conditions`: there are
    some.
    """
    found = [*totals]
    title = f"Scores: {OVER}"
    if not conditions:
        yield _table(title, found)
        return
    yield _table(title, [each for each in found if each.condition])
    once = [each for each in found if not each.condition]
    yield _table("Scores about no condition", once, "all")


def _table(title: str, totals: Collection[ScoreTotal], without: str = "none") -> ReportTable:
    """A row for each score, a column for each condition; `without`: the head of what has none."""
    conditions = sorted({each.condition for each in totals})
    rows: dict[tuple[str, ...], dict[str, Total]] = {}
    for each in totals:
        words = NONE
        if (known := each.reliability) is not None:
            words = f"{known.value:.2f} ({known.name}, n = {known.n})"
        key = (each.questionnaire, each.score, scale_text(each.low, each.high), each.how, words)
        rows.setdefault(key, {})[each.condition] = each.total
    heads = ["Questionnaire", "Score", "Range", *(LogText(each or without) for each in conditions)]
    cells = [
        [
            *(LogText(questionnaire), LogText(score), scale),
            *(total_text(row.get(each)) for each in conditions),
            *(how, words),
        ]
        for (questionnaire, score, scale, how, words), row in rows.items()
    ]
    on_terminal = len(heads)
    return ReportTable(title, [*heads, "How", "Items together"], cells, 2, on_terminal)
