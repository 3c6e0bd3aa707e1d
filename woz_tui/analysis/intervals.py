"""What may be said of a mean and of a difference: intervals, by Student's t.

Of fewer than `FEWEST` values there is no interval: the values themselves say more.
"""

from __future__ import annotations

import math
import statistics
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

#: Of so many values there is an interval.
FEWEST = 3
#: How often an interval made like these contains the true value.
LEVEL = 0.95


@dataclass(frozen=True, slots=True)
class Estimate:
    """A mean, or a difference of means, of `n` values (of a difference of two groups: of both).

    `half` is half of its interval's width; None: there are too few values.
    """

    mean: float
    half: float | None
    n: int


@dataclass(frozen=True, slots=True)
class Difference:
    """How much larger the mean of `other` is than that of `first`. `paired`: of the same people, of
    whom `Estimate.n` have both; else of two groups.
    """

    first: str
    other: str
    estimate: Estimate
    paired: bool


def mean_interval(values: Sequence[float], level: float = LEVEL) -> Estimate | None:
    """The mean of a sample and its t interval; None of no values."""
    if not values:
        return None
    n = len(values)
    mean = math.fsum(values) / n
    if n < FEWEST:
        return Estimate(mean, None, n)
    half = t_quantile((1 + level) / 2, n - 1) * statistics.stdev(values) / math.sqrt(n)
    return Estimate(mean, half, n)


def paired_difference(
    pairs: Sequence[tuple[float, float]], level: float = LEVEL
) -> Estimate | None:
    """The mean of second - first, and its t interval; None of no pairs."""
    return mean_interval([second - first for first, second in pairs], level)


def welch_difference(
    first: Sequence[float], second: Sequence[float], level: float = LEVEL
) -> Estimate | None:
    """The mean of `second` less that of `first`, two groups of different people, and the interval
    of Welch (Biometrika 34, 1947), who does not take both to vary alike; None if one is empty.
    """
    if not first or not second:
        return None
    n = len(first) + len(second)
    mean = math.fsum(second) / len(second) - math.fsum(first) / len(first)
    if min(len(first), len(second)) < FEWEST:
        return Estimate(mean, None, n)
    parts = [statistics.variance(each) / len(each) for each in (first, second)]
    if not sum(parts):
        return Estimate(mean, 0.0, n)
    weights = [part**2 / (len(each) - 1) for part, each in zip(parts, (first, second), strict=True)]
    df = sum(parts) ** 2 / sum(weights)
    return Estimate(mean, t_quantile((1 + level) / 2, df) * math.sqrt(sum(parts)), n)


def within_intervals(rows: Sequence[Sequence[float]], level: float = LEVEL) -> list[Estimate]:
    """The mean of each column with the interval of Cousineau and Morey: what a person has in all
    conditions together is taken out of each value (Cousineau, Tutorials in Quantitative Methods for
    Psychology 1, 2005), which makes it too small by the factor that is put back (Morey, the same 4,
    2008). `rows`: one person each, who has a value in every condition.
    """
    if not rows:
        return []
    grand = statistics.fmean(value for row in rows for value in row)
    normalized = [[value - statistics.fmean(row) + grand for value in row] for row in rows]
    conditions = len(rows[0])
    put_back = math.sqrt(conditions / (conditions - 1)) if conditions > 1 else 1.0
    found = [mean_interval(column, level) for column in zip(*normalized, strict=True)]
    means = [statistics.fmean(column) for column in zip(*rows, strict=True)]
    return [
        Estimate(mean, None if each.half is None else each.half * put_back, each.n)
        for mean, each in zip(means, found, strict=True)
        if each is not None
    ]


def differences(values: Mapping[str, Mapping[str, float]], *, paired: bool) -> list[Difference]:
    """Of every two conditions. `values`: by condition, then participant. With more than two
    conditions each interval is widened (Bonferroni), so that all of them together hold at `LEVEL`.
    """
    couples = list(combinations(values, 2))
    level = 1 - (1 - LEVEL) / max(len(couples), 1)
    found = []
    for first, other in couples:
        if paired:
            both = [who for who in values[first] if who in values[other]]
            pairs = [(values[first][who], values[other][who]) for who in both]
            estimate = paired_difference(pairs, level)
        else:
            here, there = (list(values[each].values()) for each in (first, other))
            estimate = welch_difference(here, there, level)
        if estimate is not None:
            found.append(Difference(first, other, estimate, paired))
    return found


# -- Student's t ----------------------------------------------------------------------------------


def t_quantile(share: float, df: float) -> float:
    """The value that a variable with Student's t distribution stays below in `share` (0..1) of all
    cases. `df`: degrees of freedom, more than 0; a fraction is one, too.
    """
    if not 0 < share < 1 or df <= 0:
        raise ValueError(f"there is no quantile {share} of t with {df} degrees of freedom")
    if share < 0.5:
        return -t_quantile(1 - share, df)
    low, high = 0.0, 1.0
    while t_share(high, df) < share:
        low, high = high, high * 2
    for _ in range(200):
        middle = (low + high) / 2
        if middle in (low, high):
            break
        if t_share(middle, df) < share:
            low = middle
        else:
            high = middle
    return high


def t_share(t: float, df: float) -> float:
    """The share of all cases in which a variable with Student's t distribution is below `t`."""
    tail = _beta_share(df / (df + t * t), df / 2, 0.5) / 2
    return 1 - tail if t > 0 else tail


#: Steps of the fraction, and what counts as no change and as nothing.
_STEPS, _SAME, _TINY = 10_000, 1e-16, 1e-300


def _beta_share(x: float, a: float, b: float) -> float:
    """The regularized incomplete beta function I_x(a, b), by its continued fraction (Abramowitz and
    Stegun, 26.5.8), with the method of Lentz.
    """
    if x <= 0 or x >= 1:
        return min(max(x, 0.0), 1.0)
    if x > (a + 1) / (a + b + 2):  # the fraction of the other side is shorter
        return 1 - _beta_share(1 - x, b, a)
    front = math.lgamma(a + b) - math.lgamma(a) - math.lgamma(b)
    front += a * math.log(x) + b * math.log1p(-x)
    above, below = 1.0, 1 / _not_nothing(1 - (a + b) * x / (a + 1))
    fraction = below
    for step in range(1, _STEPS):
        twice = a + 2 * step
        even = step * (b - step) * x / ((twice - 1) * twice)
        odd = -(a + step) * (a + b + step) * x / (twice * (twice + 1))
        for term in (even, odd):
            below = 1 / _not_nothing(1 + term * below)
            above = _not_nothing(1 + term / above)
            fraction *= above * below
        if abs(above * below - 1) < _SAME:
            break
    return math.exp(front) * fraction / a


def _not_nothing(number: float) -> float:
    return number if abs(number) > _TINY else _TINY
