"""The model's own time: it never goes back, whatever the stamps of the samples do."""

from __future__ import annotations

from fractions import Fraction

#: A second, in microseconds.
SECOND = 1_000_000
#: The longest pause that one step of the stamps can mean, in microseconds.
LONGEST_PAUSE = 3600 * SECOND


class ModelClock:
    """Whole microseconds that have passed by stamps `t`, which may jump about.

    A step forward is a pause, of an hour at most. A step back (the wall clock was set, a log was
    put together from two) counts as one `period` and no more.
    """

    def __init__(self, t: int, period: int) -> None:
        self.now = t
        self._stamp = t
        self.period = period

    def to(self, t: int) -> None:
        """The stamps stand at `t`."""
        step = t - self._stamp
        self._stamp = t
        self.now += min(step, LONGEST_PAUSE) if step >= 0 else self.period

    def stamp(self, moment: int) -> int:
        """What the stamps say, or would say, at a moment of the model's time."""
        return moment - self.now + self._stamp


def microseconds(seconds: float) -> int:
    """Finite seconds as the least whole microseconds that are no less."""
    whole = round(seconds * SECOND)
    return whole if whole / SECOND >= seconds else whole + 1


def periods(count: int, rate: float) -> int:
    """So many periods at `rate` samples a second, in whole microseconds that are no more.

    Three at 3 Hz are a second and not 2 us longer: a sign that misses two samples is not stale.
    """
    return int(count * SECOND / Fraction(str(rate)))
