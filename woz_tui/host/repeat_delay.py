"""How long a keyboard waits before a held key repeats, learnt from the keys that are held.

Nothing can be asked for it: the keyboard is at the far end of the line, and a terminal does not say
that a key is down. But a key that came `REPEATS` times more, each within `QUICK_S`, was repeating,
so what came before the first of them was its press.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from statistics import median_low

#: Repeats follow each other this closely; a burst after a standstill even closer, and says nothing.
BURST_S, QUICK_S = 0.01, 0.15
#: So many in a row are repeats: fingers tap twice as quickly, but hardly four times.
REPEATS = 3
#: Of so many holds the middle one counts: what was seen longer had waited on its way.
_HOLDS = 3
#: Delays that differ by less are the same.
SAME_S = 0.02
#: What a line adds to the delay that was measured, and what comes of it at least and at most.
JITTER_S, SHORTEST_S, LONGEST_S = 0.15, 0.3, 1.2


@dataclass(slots=True)
class _Course:
    """When a key came last, and its press and first repeat as far as they can be supposed."""

    key: str
    last: float
    pressed: float
    repeated: float | None = None
    #: How many came quickly behind that.
    quick: int = 0
    #: It repeats: nothing more is to be learnt.
    over: bool = False


class RepeatDelays:
    """Of each console the delay of its last holds."""

    def __init__(self) -> None:
        self._courses: dict[str, _Course] = {}
        self._holds: dict[str, deque[float]] = {}

    def first_repeat_s(self, console: str, default: float) -> float:
        """How long after a press at this console its first repeat may take."""
        delay = self._delay(console)
        return default if delay is None else min(LONGEST_S, max(SHORTEST_S, delay + JITTER_S))

    def _delay(self, console: str) -> float | None:
        holds = self._holds.get(console)
        return None if holds is None else median_low(holds)

    def came(self, console: str, key: str, now: float) -> float | None:
        """A key came; the delay if that is news."""
        course = self._courses.get(console)
        if course is None or course.key != key or now - course.last > LONGEST_S:
            self._courses[console] = _Course(key, now, now)
            return None
        before, course.last = course.last, now
        if now - before > QUICK_S:
            if course.over or course.quick:
                self._courses[console] = _Course(key, now, now)
            else:  # this is the first repeat of what came before, or one more press
                course.pressed, course.repeated = before, now
            return None
        course.quick += 1
        course.over |= course.repeated is None or now - before < BURST_S
        if course.over or course.repeated is None or course.quick < REPEATS:
            return None
        course.over = True
        known = self._delay(console)
        self._holds.setdefault(console, deque(maxlen=_HOLDS)).append(
            course.repeated - course.pressed
        )
        delay = self._delay(console)
        if known is not None and delay is not None and abs(delay - known) < SAME_S:
            return None
        return delay
