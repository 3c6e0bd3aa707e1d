"""`woz engagement LOG --trials`: how steady and how quick the signs were with people, by markers.

Two marks in a session are enough. From `steady` to the next marker nothing is meant to change:
somebody stands there and looks at the robot, or nobody is there. At `now` somebody arrives, turns
away, steps back. What was true in a steady stretch is what most of its samples say. A sign was
right for its first 10, 20 or 30 seconds if its verdict was that all the time, which is how Table 1
of the paper counts; the same is counted without filters.
"""

from __future__ import annotations

import bisect
import itertools
import json
import math
import statistics
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from rich.table import Table

from woz_tui.cli.engagement_log import FILTER, ModelRerun, SettingsOverride, message_of
from woz_tui.config.engagement import EngagementSettings
from woz_tui.config.engagement_words import SIGNS
from woz_tui.console.drawing.text_console import TextConsole
from woz_tui.log.log_reader import Damage, read
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
#: Columns of a page that goes into a file or a pipe.
_PAGE = 80


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
        """All figures for programs."""
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
    `engagement_log.rerun` takes them.
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


# -- on the screen --------------------------------------------------------------------------------


def show(
    log: Path, settings: EngagementSettings | None, above: SettingsOverride, *, as_json: bool
) -> None:
    """Print the figures of a log; it must be one (`log.log_reader.read` says what it raises)."""
    lines = (message_of(line) for line in read(log, Damage()))
    found = trials((message for message in lines if message is not None), settings, above)
    if as_json:
        print(json.dumps(found.as_json()))
        return
    console = TextConsole(page=_PAGE)
    if not found.stretches and not found.moments:
        console.print(
            f"no trials: put markers called {STEADY!r} and {NOW!r} into the session's log"
        )
        return
    if found.stretches:
        console.print("Correct throughout", style="bold")
        console.print(_steady(found))
    if found.moments:
        console.print("Seconds until engagement changed", style="bold")
        console.print(_delays(found))
        if unmoved := _unmoved(found):
            console.print(unmoved)


def _table(*columns: str) -> Table:
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for place, column in enumerate(columns):
        table.add_column(column, justify="right" if place else "left")
    return table


def _steady(found: Trials) -> Table:
    table = _table("sign", "s", "stretches", "no filter", "filtered")
    for name in JUDGED:
        for seconds in LASTS:
            count, plain, filtered = found.steady(name, seconds)
            if count:
                shares = (f"{100 * right / count:.0f} %" for right in (plain, filtered))
                table.add_row(name, str(seconds), str(count), *shares)
    return table


def _delays(found: Trials) -> Table:
    table = _table("at", "no filter", "filtered")
    rows = found.delays()
    for row in rows:
        cells = (_seconds(row.plain), _seconds(row.filtered)) if row.changes else ("-", "-")
        table.add_row(f"{row.at / SECOND:.1f} s", *cells)
    middle = medians(rows)
    if middle is not None:
        table.add_row("median", *map(_seconds, middle))
    return table


def medians(delays: Iterable[EngagementDelay]) -> tuple[float | None, float | None] | None:
    """Of the marks at which something was to change, without and with filter, as `EngagementDelay`
    has them; None if there is no such mark.
    """
    changes = [delay for delay in delays if delay.changes]
    if not changes:
        return None
    return _median(each.plain for each in changes), _median(each.filtered for each in changes)


def _unmoved(found: Trials) -> str:
    """How many marks are left out of the median; empty: none."""
    count = sum(not row.changes for row in found.delays())
    if not count:
        return ""
    return f"-: engagement was the same before and after, {count} of {len(found.moments)} marks"


def _median(delays: Iterable[float | None]) -> float | None:
    """The middle one; never comes after all others. There must be one at least."""
    middle = statistics.median(math.inf if delay is None else delay for delay in delays)
    return middle if math.isfinite(middle) else None


def _seconds(delay: float | None) -> str:
    return "never" if delay is None else f"{delay:.2f}"
