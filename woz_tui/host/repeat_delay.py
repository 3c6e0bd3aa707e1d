"""How long a keyboard waits before a held key repeats, learnt from the keys that are held.

Nothing can be asked for it: the keyboard is at the far end of the line, and a terminal does not say
that a key is down. But a key that came twice within `QUICK_S` was repeating, so what came before
these two was its press.
"""

from __future__ import annotations

from dataclasses import dataclass

#: Repeats follow each other this closely; a burst after a standstill even closer, and says nothing.
BURST_S, QUICK_S = 0.01, 0.15
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
    #: It repeats: nothing more is to be learnt.
    over: bool = False


class RepeatDelays:
    """Of each console the shortest delay: what was seen longer had waited on its way."""

    def __init__(self) -> None:
        self._courses: dict[str, _Course] = {}
        self._delays: dict[str, float] = {}

    def first_repeat_s(self, console: str, default: float) -> float:
        """How long after a press at this console its first repeat may take."""
        delay = self._delays.get(console)
        return default if delay is None else min(LONGEST_S, max(SHORTEST_S, delay + JITTER_S))

    def came(self, console: str, key: str, now: float) -> float | None:
        """A key came; the delay if that is news."""
        course = self._courses.get(console)
        if course is None or course.key != key or now - course.last > LONGEST_S:
            self._courses[console] = _Course(key, now, now)
            return None
        before, course.last = course.last, now
        if now - before > QUICK_S:
            if course.over:
                self._courses[console] = _Course(key, now, now)
            else:  # this is the first repeat of what came before, or one more press
                course.pressed, course.repeated = before, now
            return None
        repeats = not course.over and course.repeated is not None and now - before >= BURST_S
        course.over = True
        if not repeats or course.repeated is None:
            return None
        delay = course.repeated - course.pressed
        if delay > self._delays.get(console, LONGEST_S) - SAME_S:
            return None
        self._delays[console] = delay
        return delay
