"""What is compared between conditions: one number of each participant in each of them.

An outcome is a main figure or a scale of a questionnaire. Whoever was asked and gave no answer is
counted, by the reason.
"""

from __future__ import annotations

import statistics
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from woz_tui.analysis.intervals import (
    FEWEST,
    Difference,
    Estimate,
    differences,
    mean_interval,
    within_intervals,
)

#: More points than this are no scale whose answers are counted one by one.
_POINTS = 11


@dataclass(frozen=True, slots=True)
class OutcomeName:
    """What an outcome is called.

    Attributes:
        name: For files: of its letters, digits, `.`, `-` and `_` is made the file's name.
        title: For people.
        unit: Of its numbers, as in `measures.Measure`; empty: none.
        low: The lowest point of a scale, and `high` the highest; None: it is none.
        ends: What stands at both; empty: nobody said.
    """

    name: str
    title: str
    unit: str = ""
    low: float | None = None
    high: float | None = None
    ends: tuple[str, str] = ("", "")


@dataclass(slots=True)
class ConditionValues:
    """What was found in one condition: answers by participant, and why others have none.

    `asked`: who was asked at all. `missing`: reason -> how many times.
    """

    answers: dict[str, list[float]] = field(default_factory=dict)
    asked: set[str] = field(default_factory=set)
    missing: Counter[str] = field(default_factory=Counter)

    @property
    def means(self) -> dict[str, float]:
        """Of each participant with an answer, the mean of them."""
        return {who: statistics.fmean(found) for who, found in self.answers.items()}


@dataclass(frozen=True, slots=True)
class ConditionSummary:
    """What may be said of one condition.

    Attributes:
        asked: How many were asked; `n` of them have a value.
        missing: Why others have none: reason -> how many times.
        values: Of each participant, in the order of their codes; told instead of figures where
            there are fewer than `intervals.FEWEST`.
        mean: Of all values; None without any.
        estimate: What is drawn: a mean with its interval, within a design of those alone who have
            a value in every condition.
        counts: Of a scale with points: how often each was chosen, from the lowest to the highest.
    """

    condition: str
    asked: int
    missing: Mapping[str, int]
    values: Sequence[float]
    mean: float | None
    estimate: Estimate | None
    sd: float | None
    median: float | None
    counts: Sequence[int]

    @property
    def n(self) -> int:
        """How many participants have a value."""
        return len(self.values)

    @property
    def is_few(self) -> bool:
        """Whether the values say more than their mean."""
        return self.n < FEWEST


@dataclass(slots=True)
class Outcome:
    """An outcome in all conditions, in the order of their names."""

    name: OutcomeName
    conditions: dict[str, ConditionValues] = field(default_factory=dict)
    #: Participant -> the condition that came first; shared by all outcomes of a study.
    first: Mapping[str, str] = field(default_factory=dict)

    def at(self, condition: str) -> ConditionValues:
        """Where a condition's values are."""
        return self.conditions.setdefault(condition, ConditionValues())

    @property
    def names(self) -> list[str]:
        """The conditions in which somebody was asked."""
        return sorted(self.conditions)

    @property
    def is_once(self) -> bool:
        """Whether it is about no condition."""
        return not any(self.conditions)

    def label(self, condition: str) -> str:
        """What a condition is called on pictures and in tables."""
        return condition or ("all" if self.is_once else "none")

    @property
    def people(self) -> list[str]:
        """Everybody with a value in any condition."""
        return sorted({who for each in self.conditions.values() for who in each.answers})

    @property
    def within(self) -> bool:
        """Whether people are compared with themselves: most have values in several conditions."""
        several = sum(len(self._of(who)) > 1 for who in self.people)
        return 2 * several > len(self.people)

    @property
    def complete(self) -> list[str]:
        """Who has a value in every condition."""
        return [who for who in self.people if len(self._of(who)) == len(self.conditions)]

    def is_cut(self, each: ConditionSummary) -> bool:
        """Whether an interval goes beyond the scale, at whose end it is drawn to end."""
        if each.estimate is None or each.estimate.half is None or self.name.low is None:
            return False
        mean, half = each.estimate.mean, each.estimate.half
        return mean - half < self.name.low or mean + half > (self.name.high or 0)

    def lines(self) -> list[tuple[str, list[float | None]]]:
        """Each participant's values, in the order of the conditions; None where there is none."""
        return [(who, [self._of(who).get(name) for name in self.names]) for who in self.people]

    def _of(self, who: str) -> dict[str, float]:
        return {
            name: statistics.fmean(each.answers[who])
            for name, each in self.conditions.items()
            if who in each.answers
        }

    def summaries(self) -> list[ConditionSummary]:
        """By condition. Within a design the intervals are those of Cousineau and Morey, of those
        who are `complete`; between groups each has its t interval.
        """
        intervals: dict[str, Estimate] = {}
        if self.within:
            rows = [[self._of(who)[name] for name in self.names] for who in self.complete]
            intervals = dict(zip(self.names, within_intervals(rows), strict=False))
        found = []
        for name in self.names:
            means = self.conditions[name].means
            values = [means[who] for who in sorted(means)]
            drawn = intervals.get(name) if self.within else mean_interval(values)
            found.append(self._summary(name, values, drawn))
        return found

    def _summary(
        self, name: str, values: Sequence[float], estimate: Estimate | None
    ) -> ConditionSummary:
        there = self.conditions[name]
        answers = [value for found in there.answers.values() for value in found]
        return ConditionSummary(
            condition=name,
            asked=len(there.asked),
            missing=dict(sorted(there.missing.items())),
            values=values,
            mean=statistics.fmean(values) if values else None,
            estimate=estimate,
            sd=statistics.stdev(values) if len(values) >= FEWEST else None,
            median=statistics.median(values) if len(values) >= FEWEST else None,
            counts=self._counts(answers),
        )

    def _counts(self, answers: Iterable[float]) -> list[int]:
        low, high = self.name.low, self.name.high
        if low is None or high is None or not (low.is_integer() and high.is_integer()):
            return []
        found = Counter(answers)
        if high - low >= _POINTS or not all(answer.is_integer() for answer in found):
            return []  # too many points, or a mean of several answers
        return [found[float(point)] for point in range(int(low), int(high) + 1)]

    def differences(self) -> list[Difference]:
        """Of every two conditions: of the same people where they have both, else of groups."""
        means = {name: self.conditions[name].means for name in self.names}
        return differences(means, paired=self.within)

    def first_differences(self) -> list[Difference]:
        """The same of what came first alone, where nothing before can have had an effect: between
        those who began with one condition and those who began with another. Only within a design
        in which at least two conditions came first for somebody.
        """
        means = {
            name: {
                who: value
                for who, value in self.conditions[name].means.items()
                if self.first.get(who) == name
            }
            for name in self.names
        }
        began = {name: found for name, found in means.items() if found}
        return differences(began, paired=False) if self.within else []
