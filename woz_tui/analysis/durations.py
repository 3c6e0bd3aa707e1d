"""Many durations, and what is told of them: how many, the middle, the tail, the worst."""

from __future__ import annotations

import math
import statistics
from array import array
from collections.abc import Iterable, Sequence

from woz_tui.timeline.session_state import LATEST_TIME


def quantile(ordered: Sequence[float], share: float) -> float:
    """The value below which `share` (0..1) of the values lie: definition 7 of Hyndman and Fan (The
    American Statistician 50, 1996), linear between neighbours, as R, NumPy and spreadsheets do.

    `ordered` rises and is not empty.
    """
    place = (len(ordered) - 1) * share
    below = math.floor(place)
    above = min(below + 1, len(ordered) - 1)
    return ordered[below] + (ordered[above] - ordered[below]) * (place - below)


def mean_and_sd(values: Sequence[float]) -> tuple[float | None, float | None]:
    """Mean, and standard deviation of a sample (n - 1); None where there are too few values."""
    if not values:
        return None, None
    mean = math.fsum(values) / len(values)
    return mean, statistics.stdev(values) if len(values) > 1 else None


class Durations:
    """A list of durations in whole microseconds, none below 0, sorted when it is read.

    Every figure of an empty one is None.
    """

    __slots__ = ("_ordered", "_values")

    def __init__(self, values: Iterable[int] = ()) -> None:
        self._values = array("q")
        self._ordered = True
        for value in values:
            self.add(value)

    def add(self, value: int) -> None:
        """Add one; what no clock can have measured is brought to the nearest possible value."""
        self._values.append(value if 0 <= value <= LATEST_TIME else 0 if value < 0 else LATEST_TIME)
        self._ordered = False

    def extend(self, other: Durations) -> None:
        """Add all of another list."""
        self._values.extend(other._values)
        self._ordered = False

    @property
    def values(self) -> Sequence[int]:
        if not self._ordered:
            self._values = array("q", sorted(self._values))
            self._ordered = True
        return self._values

    @property
    def n(self) -> int:
        return len(self._values)

    @property
    def median(self) -> float | None:
        """Half of them are at most this."""
        return self.quantile(0.5)

    @property
    def p95(self) -> float | None:
        """95 of 100 are at most this."""
        return self.quantile(0.95)

    @property
    def most(self) -> int | None:
        return self.values[-1] if self._values else None

    @property
    def total(self) -> int:
        """The sum; 0 if there are none."""
        return sum(self._values)

    @property
    def mean(self) -> float | None:
        return self.total / self.n if self.n else None

    @property
    def sd(self) -> float | None:
        """Standard deviation of a sample (n - 1); None below two values."""
        return mean_and_sd(self.values)[1]

    def quantile(self, share: float) -> float | None:
        """See the function `quantile`."""
        return quantile(self.values, share) if self._values else None

    def __len__(self) -> int:
        return len(self._values)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Durations) and list(self.values) == list(other.values)

    def __repr__(self) -> str:
        return f"Durations({list(self.values)!r})"

    __hash__ = None  # type: ignore[assignment]  # it grows
