"""Queues that make one steady verdict of many samples: formulas 1 to 4 of the paper.

U. Maniscalco, P. Storniolo, A. Messina, Int. J. of Social Robotics 14, 2022, doi
10.1007/s12369-021-00855-w. `docs/explanation/engagement.md` has the formulas as they are read here.
"""

from __future__ import annotations

import math
from bisect import bisect_left, insort
from collections import Counter, deque
from fractions import Fraction
from functools import lru_cache

from woz_tui.sensing.sample_values import UNKNOWN

# -- identity -------------------------------------------------------------------------------------
# Who it is, out of many recognitions: formula 3 of the paper.
#
# The formula does not say whether "Unknown" can win, nor what a tie means. Here it takes a place in
# the queue and never wins. Of IDs that tie, the one given out last keeps its place, else the one
# seen last gets it, so that A B A B does not flip.


class IdentityFifo:
    """The last `samples` identities: the ID that is there most often, if its share suffices.

    Start-up policies are those of `Fifo`. A threshold of 0 never makes up an ID.
    """

    kind = "fifo"

    def __init__(self, samples: int, threshold: float, start_up: str = "zero-fill") -> None:
        self.start_up = start_up
        self._last_name = ""
        self.name = UNKNOWN
        self._samples: deque[str] = deque(maxlen=samples)
        self.configure(samples, threshold)

    def configure(self, samples: int, threshold: float) -> None:
        """Other numbers from now on; the newest values that fit stay."""
        self.places = samples
        self.threshold = threshold
        self.resume(self.values)

    def resume(self, values: list[str]) -> None:
        """Hold what another filter held, oldest first."""
        self._samples = deque(values, maxlen=self.places)
        self._counts = Counter(name for name in self._samples if name != UNKNOWN)
        self._judge()

    @property
    def values(self) -> list[str]:
        """What the queue holds, oldest first."""
        return list(self._samples)

    def add(self, name: str, t: int) -> None:
        """One more recognition; "Unknown" fills a place."""
        if len(self._samples) == self.places:
            self._drop(self._samples[0])
        self._samples.append(name)
        if name != UNKNOWN:
            self._counts[name] += 1
        self._judge()

    def forget(self) -> None:
        """Empty: as before the first sample."""
        self._last_name = ""
        self.resume([])

    @property
    def verdict(self) -> int | None:
        """1 if there is a name, 0 if not, None under `hold` while the queue is not full."""
        if self.start_up == "hold" and len(self._samples) < self.places:
            return None
        return int(self.name != UNKNOWN)

    @property
    def needed(self) -> int:
        """How many samples of one ID suffice; one at least."""
        partial = self.start_up == "partial"
        return max(1, least(self.threshold, len(self._samples) if partial else self.places))

    @property
    def count(self) -> int:
        """How many samples name the ID given out, or the one that comes next to it."""
        if self.name != UNKNOWN:
            return self._counts[self.name]
        return max(self._counts.values(), default=0)

    def _drop(self, name: str) -> None:
        if name == UNKNOWN:
            return
        self._counts[name] -= 1
        if not self._counts[name]:
            del self._counts[name]

    def _judge(self) -> None:
        most = max(self._counts.values(), default=0)
        if most < self.needed or (self.start_up == "hold" and len(self._samples) < self.places):
            self.name = UNKNOWN
            return
        tied = {name for name, count in self._counts.items() if count == most}
        if self._last_name not in tied:
            self._last_name = next(name for name in reversed(self._samples) if name in tied)
        self.name = self._last_name


# --------------------------------------------------------------------------------------------------


@lru_cache(maxsize=4096)
def least(threshold: float, places: int) -> int:
    """How many of `places` samples suffice: ceil(t_r n), t_r being the decimal as it was typed.

    So 0.7 of 10 is 7, although 0.7 * 10 is more than 7 in floating point.
    """
    return math.ceil(Fraction(str(threshold)) * places)


class Fifo:
    """The last `samples` values: yes if the share of those that say yes reaches `threshold`.

    A flag says yes if it is true, a distance if it is `near` or less (pass `near` for distances).
    A queue that is not full counts empty places as no (`zero-fill`), divides by what it holds
    (`partial`) or has no verdict (`hold`). An empty one never says yes.
    """

    kind = "fifo"

    def __init__(
        self, samples: int, threshold: float, start_up: str = "zero-fill", near: float | None = None
    ) -> None:
        self.start_up = start_up
        self._near = near
        self._samples: deque[float] = deque(maxlen=samples)
        self.configure(samples, threshold)

    def configure(self, samples: int, threshold: float) -> None:
        """Other numbers from now on; the newest values that fit stay."""
        self.places = samples
        self.threshold = threshold
        self._needed = least(threshold, samples)
        self._samples = deque(self._samples, maxlen=samples)
        self._recount()

    def near_within(self, metres: float) -> None:
        """Another social distance, also for the values in the queue."""
        self._near = metres
        self._recount()

    def resume(self, values: list[float]) -> None:
        """Hold what another filter held, oldest first."""
        self._samples = deque(values, maxlen=self.places)
        self._recount()

    @property
    def values(self) -> list[float]:
        """What the queue holds, oldest first."""
        return list(self._samples)

    def add(self, value: float, t: int) -> None:
        """One more valid sample."""
        if len(self._samples) == self.places:
            self.count -= self._yes(self._samples[0])
        self._samples.append(value)
        self.count += self._yes(value)

    def forget(self) -> None:
        """Empty: as before the first sample."""
        self._samples.clear()
        self._recount()

    @property
    def needed(self) -> int:
        """How many samples suffice at present."""
        if self.start_up == "partial" and len(self._samples) < self.places:
            return least(self.threshold, len(self._samples))
        return self._needed

    @property
    def verdict(self) -> int | None:
        """1, 0, or None under `hold` while the queue is not full."""
        filled = len(self._samples)
        if self.start_up == "hold" and filled < self.places:
            return None
        return int(filled > 0 and self.count >= self.needed)

    def _yes(self, value: float) -> int:
        return int(bool(value) if self._near is None else value <= self._near)

    def _recount(self) -> None:
        self.count = sum(map(self._yes, self._samples))


class Median(Fifo):
    """Yes if the median of the last distances is near; the paper's prose, as an option.

    With an even number of samples the median is the mean of the two in the middle. Empty places
    count as far under `zero-fill`. The threshold has no say: half of the samples decide.
    """

    kind = "median"

    def __init__(self, samples: int, threshold: float, start_up: str, near: float) -> None:
        self._ordered: list[float] = []
        super().__init__(samples, threshold, start_up, near)

    def add(self, value: float, t: int) -> None:
        """One more valid sample."""
        if len(self._samples) == self.places:
            del self._ordered[bisect_left(self._ordered, self._samples[0])]
        insort(self._ordered, value)
        super().add(value, t)

    @property
    def needed(self) -> int:
        """How many near samples suffice, whatever the others are."""
        filled = self.places if self.start_up == "zero-fill" else len(self._samples)
        return filled // 2 + 1

    @property
    def median(self) -> float:
        """Metres; infinite for an empty queue."""
        places = self.places if self.start_up == "zero-fill" else len(self._samples)
        return (self._at((places - 1) // 2) + self._at(places // 2)) / 2

    @property
    def verdict(self) -> int | None:
        """1, 0, or None under `hold` while the queue is not full."""
        if self.start_up == "hold" and len(self._samples) < self.places:
            return None
        return int(self._near is not None and self.median <= self._near)

    def _at(self, rank: int) -> float:
        return self._ordered[rank] if 0 <= rank < len(self._ordered) else math.inf

    def _recount(self) -> None:
        self._ordered = sorted(self._samples)
        super()._recount()
