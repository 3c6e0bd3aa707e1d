"""Who it is, out of many recognitions: formula 3 of the paper.

The formula does not say whether "Unknown" can win, nor what a tie means. Here it fills a place
but is nobody. Of IDs that tie, the one given out last keeps its place, else the one seen last
gets it, so that A B A B does not flip.
"""

from __future__ import annotations

from collections import Counter, deque

from woz_tui.sensing.filters import least
from woz_tui.sensing.samples import UNKNOWN


class IdentityFifo:
    """The last `samples` identities: the ID that is there most often, if its share suffices.

    Start-up policies are those of `Fifo`. A threshold of 0 never makes up an ID.
    """

    kind = "fifo"

    def __init__(self, samples: int, threshold: float, start_up: str = "zero-fill") -> None:
        self.start_up = start_up
        self._given = ""
        self.name = UNKNOWN
        self._held: deque[str] = deque(maxlen=samples)
        self.configure(samples, threshold)

    def configure(self, samples: int, threshold: float) -> None:
        """Other numbers from now on; the newest values that fit stay."""
        self.places = samples
        self.threshold = threshold
        self.resume(self.values)

    def resume(self, values: list[str]) -> None:
        """Hold what another filter held, oldest first."""
        self._held = deque(values, maxlen=self.places)
        self._counts = Counter(name for name in self._held if name != UNKNOWN)
        self._judge()

    @property
    def values(self) -> list[str]:
        """What the queue holds, oldest first."""
        return list(self._held)

    def take(self, name: str, t: int) -> None:
        """One more recognition; "Unknown" fills a place."""
        if len(self._held) == self.places:
            self._drop(self._held[0])
        self._held.append(name)
        if name != UNKNOWN:
            self._counts[name] += 1
        self._judge()

    def forget(self) -> None:
        """Empty: as before the first sample."""
        self._given = ""
        self.resume([])

    @property
    def verdict(self) -> int | None:
        """1 if there is a name, 0 if not, None under `hold` while the queue is not full."""
        if self.start_up == "hold" and len(self._held) < self.places:
            return None
        return int(self.name != UNKNOWN)

    @property
    def needed(self) -> int:
        """How many samples of one ID suffice; one at least."""
        partial = self.start_up == "partial"
        return max(1, least(self.threshold, len(self._held) if partial else self.places))

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
        if most < self.needed or (self.start_up == "hold" and len(self._held) < self.places):
            self.name = UNKNOWN
            return
        tied = {name for name, count in self._counts.items() if count == most}
        if self._given not in tied:
            self._given = next(name for name in reversed(self._held) if name in tied)
        self.name = self._given
