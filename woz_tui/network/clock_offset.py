"""How two machines' clocks differ, measured by asking, with how far that may be off."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

#: How many answers count: the one that came soonest is the best.
_ANSWERS = 20


@dataclass(frozen=True, slots=True)
class ClockOffset:
    """What the other machine's clock has more than this one's, and how far that may be off, in
    microseconds.
    """

    offset_us: int
    uncertainty_us: int

    @classmethod
    def measured(cls, sent_us: int, other_us: int, received_us: int) -> ClockOffset:
        """From one question: when it was sent, what the other said, when that was here."""
        half = (received_us - sent_us) // 2
        return cls(other_us - sent_us - half, half + 1)

    def there(self, here_us: int) -> int:
        """The other's time at a time of ours: the earliest it can have been, so that nothing that
        was under way for long is taken for fresh.
        """
        return here_us + self.offset_us - self.uncertainty_us

    def here(self, there_us: int) -> int:
        """Our time at a time of the other's: the earliest it can have been."""
        return there_us - self.offset_us - self.uncertainty_us

    def latest_there(self, here_us: int) -> int:
        """The latest it can have been."""
        return here_us + self.offset_us + self.uncertainty_us


class ClockComparison:
    """The best of the last answers of the other clock."""

    def __init__(self) -> None:
        self._answers: deque[ClockOffset] = deque(maxlen=_ANSWERS)

    def add(self, answer: ClockOffset) -> None:
        """One more answer."""
        self._answers.append(answer)

    def forget(self) -> None:
        """Another clock from now on."""
        self._answers.clear()

    def __bool__(self) -> bool:
        return bool(self._answers)

    @property
    def best(self) -> ClockOffset:
        """The one that is known best. Raises ValueError before the first."""
        return min(self._answers, key=lambda each: each.uncertainty_us)
