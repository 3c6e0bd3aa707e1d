"""How steady and how quick the signs were with people, by markers in a session's log.

Two marks in a session are enough. From `steady` to the next marker nothing is meant to change:
somebody stands there and looks at the robot, or nobody is there. At `now` somebody arrives, turns
away, steps back. What was true in a steady stretch is what most of its samples say. A sign was
right for its first 10, 20 or 30 seconds if its verdict was that all the time, which is how Table 1
of the paper counts; the same is counted without filters.
"""

from __future__ import annotations

import bisect
import itertools
import math
import statistics
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from woz_tui.analysis.engagement_rerun import FILTER, ModelRerun, SettingsOverride
from woz_tui.config.engagement import EngagementSettings
from woz_tui.config.engagement_words import SIGNS
from woz_tui.protocol import messages as m
from woz_tui.sensing.model_time import SECOND

#: What a marker says.
STEADY, NOW = "steady", "now"

#: How long the paper's volunteers stood there, in seconds.
LASTS = (10, 20, 30)

#: A change that comes later than this after `now`, in seconds, has another reason.
LATEST = 10

#: What is judged: the signs, and engagement itself.
ENGAGED = "engaged"

JUDGED = (*SIGNS, ENGAGED)


@dataclass
class VerdictHistory:
    """How the verdicts went: times in microseconds, and all verdicts from each on."""

    times: list[int] = field(default_factory=list)
    values: list[dict[str, m.Json]] = field(default_factory=list)

    def note(self, t: int, verdicts: dict[str, m.Json]) -> None:
        """They are so now."""
        if not self.values or self.values[-1] != verdicts:
            self.times.append(t)
            self.values.append(verdicts)

    def at(self, t: int) -> dict[str, m.Json]:
        """As they were."""
        place = bisect.bisect_right(self.times, t) - 1
        return self.values[place] if place >= 0 else {}

    def between(self, begin: int, end: int) -> Iterator[tuple[int, dict[str, m.Json]]]:
        """Every change in between, and first how they were at `begin`."""
        yield begin, self.at(begin)
        first = bisect.bisect_right(self.times, begin)
        last = bisect.bisect_right(self.times, end)
        yield from zip(self.times[first:last], self.values[first:last], strict=True)

    def holds(self, name: str, value: m.Json, begin: int, end: int) -> bool:
        """Whether a verdict is `value` all the time."""
        return all(verdicts.get(name) == value for _, verdicts in self.between(begin, end))

    def mostly(self, name: str, begin: int, end: int) -> m.Json:
        """The value that a verdict had for the longest time."""
        lasted: Counter[str] = Counter()
        by_text: dict[str, m.Json] = {}
        moments = [*self.between(begin, end), (end, {})]
        for (since, verdicts), (until, _) in itertools.pairwise(moments):
            value = verdicts.get(name)
            lasted[str(value)] += until - since
            by_text[str(value)] = value
        return by_text[max(lasted, key=lambda text: lasted[text])]

    def becomes(self, name: str, value: m.Json, t: int) -> float | None:
        """Seconds after `t` until a verdict is `value`; None if that does not happen in time."""
        for moment, verdicts in self.between(t, t + LATEST * SECOND):
            if verdicts.get(name) == value:
                return (moment - t) / SECOND
        return None


@dataclass(frozen=True, slots=True)
class EngagementDelay:
    """Seconds from a mark `now`, at `at` microseconds, until engagement was what most samples say
    some seconds later: without filter, with it; None: never. `changes` is False where they say what
    they said before as well: there was nothing to be slow at.
    """

    at: int
    plain: float | None = None
    filtered: float | None = None
    changes: bool = True


@dataclass(frozen=True)
class Trials:
    """What a session's markers ask for: stretches and moments, in microseconds."""

    stretches: Sequence[tuple[int, int]]
    moments: Sequence[int]
    plain: VerdictHistory
    filtered: VerdictHistory

    def steady(self, name: str, seconds: int) -> tuple[int, int, int]:
        """Stretches of so many seconds at least; in how many of them a sign was right throughout,
        without filter, with it.
        """
        long = [begin for begin, end in self.stretches if end - begin >= seconds * SECOND]
        right = [0, 0]
        for begin in long:
            end = begin + seconds * SECOND
            truth = self.plain.mostly(name, begin, end)
            for place, course in enumerate((self.plain, self.filtered)):
                right[place] += course.holds(name, truth, begin, end)
        return len(long), right[0], right[1]

    def delays(self) -> list[EngagementDelay]:
        """How quickly engagement became, after each moment, what it was to be."""
        return [self._delay(at) for at in self.moments]

    def _delay(self, at: int) -> EngagementDelay:
        half = LATEST * SECOND // 2
        before = self.plain.mostly(ENGAGED, max(0, at - half), at)
        after = self.plain.mostly(ENGAGED, at + half, at + 2 * half)
        if before == after:
            return EngagementDelay(at, changes=False)
        plain, filtered = (
            course.becomes(ENGAGED, after, at) for course in (self.plain, self.filtered)
        )
        return EngagementDelay(at, plain, filtered)

    def as_json(self) -> dict[str, m.Json]:
        steady: list[m.Json] = []
        for name in JUDGED:
            for seconds in LASTS:
                count, plain, filtered = self.steady(name, seconds)
                if count:
                    steady.append(
                        {
                            **{"sign": name, "seconds": seconds, "stretches": count},
                            **{"right_unfiltered": plain, "right": filtered},
                        }
                    )
        delays: list[m.Json] = [
            {
                **{"t": delay.at / SECOND, "changes": delay.changes},
                **{"unfiltered": delay.plain, "filtered": delay.filtered},
            }
            for delay in self.delays()
        ]
        return {"steady": steady, "delays": delays}


def trials(
    messages: Iterable[m.Message],
    settings: EngagementSettings | None,
    above: SettingsOverride | None = None,
) -> Trials:
    """Run a session through the model with and without filters; `settings` and `above` are as
    `engagement_rerun.rerun` takes them.
    """
    above = above or (SettingsOverride.always(settings) if settings else SettingsOverride())
    plain = SettingsOverride(
        lambda recorded: _unfiltered(above.change(recorded)), {**above.named, "filter": FILTER}
    )
    unfiltered = None if settings is None else _unfiltered(settings)
    models = (ModelRerun(unfiltered, plain), ModelRerun(settings, above))
    courses = (VerdictHistory(), VerdictHistory())
    marks: list[tuple[int, str]] = []
    end = 0
    for message in messages:
        end = max(end, message.t)
        if isinstance(message, m.Marker):
            marks.append((message.moment, message.text.strip().casefold()))
        for again, course in zip(models, courses, strict=True):
            again.apply(message)
            if again.follower is not None:
                model = again.follower.model
                course.note(message.t, {**model.verdicts, ENGAGED: int(model.engaged)})
    marks.append((end, ""))
    stretches = [
        (begin, until)
        for (begin, text), (until, _) in itertools.pairwise(marks)
        if text == STEADY and until > begin
    ]
    return Trials(stretches, [at for at, text in marks if text == NOW], *courses)


def _unfiltered(settings: EngagementSettings) -> EngagementSettings:
    """Each sample decides; what the wizard asks of a filter does not count then."""
    signs: dict[str, Any] = {
        sign: replace(settings.sign(sign), filter=None, samples=None, threshold=None)
        for sign in SIGNS
    }
    return replace(settings, filter="fifo", samples=1, threshold=1.0, **signs)


def medians(delays: Iterable[EngagementDelay]) -> tuple[float | None, float | None] | None:
    """Of the marks at which something was to change, without and with filter, as `EngagementDelay`
    has them; None if there is no such mark.
    """
    changes = [delay for delay in delays if delay.changes]
    if not changes:
        return None
    return _median(each.plain for each in changes), _median(each.filtered for each in changes)


def _median(delays: Iterable[float | None]) -> float | None:
    """The middle one; never comes after all others. There must be one at least."""
    middle = statistics.median(math.inf if delay is None else delay for delay in delays)
    return middle if math.isfinite(middle) else None
