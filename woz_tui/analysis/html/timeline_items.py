"""A timeline's content as the page has it: numbered items in lanes, with everything to be said."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from statistics import median

from woz_tui.analysis.feature_figures import Instant
from woz_tui.analysis.html.markup import clean
from woz_tui.analysis.html.timeline_styles import SORTS
from woz_tui.analysis.timeline_lanes import (
    Interval,
    SensorCurve,
    TimelineDrawing,
    TimelineLane,
)
from woz_tui.sensing.state_machine import ENGAGED
from woz_tui.timeline.episodes import LEFT_OUT, EpisodeOutcome

#: Points of a curve on the page; more could not be told apart, and would only make it large.
POINTS = 1500
#: A curve goes on over pauses of up to this, in microseconds.
_PAUSE = 1_000_000
#: What the detail of an interval is called.
_DETAILS = {"state": "why", "trial": "condition", "stop": "reach"}
#: Outcomes of actions and commands that look like another one.
_LOOKS: Mapping[str, str] = {
    EpisodeOutcome.TIMED_OUT: "failed",
    EpisodeOutcome.SUPERSEDED: "stopped",
    EpisodeOutcome.LEFT_OUT: "left-out",
}


@dataclass(frozen=True, slots=True)
class TimelineItem:
    """Something in a lane. `end` is None for a moment; times in microseconds.

    `facts` are names and values: what else is known of it.
    """

    number: int
    lane: str
    begin: int
    end: int | None
    label: str
    sort: str
    facts: tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True)
class TimelineRow:
    """A lane: its items by their beginning."""

    title: str
    sort: str
    items: tuple[TimelineItem, ...]


def rows(timeline: TimelineDrawing) -> list[TimelineRow]:
    """All lanes; the items are numbered through, from 0."""
    found: list[TimelineRow] = []
    number = 0
    for lane in timeline.lanes:
        things: list[Interval | Instant] = [*lane.intervals, *lane.instants]
        things.sort(key=_begin)
        items = tuple(_item(number + place, lane, thing) for place, thing in enumerate(things))
        number += len(items)
        found.append(TimelineRow(clean(lane.name), lane.sort, items))
    return found


def by_time(lanes: Sequence[TimelineRow]) -> list[TimelineItem]:
    """All items, the earliest first."""
    return sorted(
        (item for row in lanes for item in row.items), key=lambda it: (it.begin, it.number)
    )


def _begin(thing: Interval | Instant) -> int:
    return thing.begin if isinstance(thing, Interval) else thing.t


def _item(number: int, lane: TimelineLane, thing: Interval | Instant) -> TimelineItem:
    if isinstance(thing, Instant):
        facts = _non_empty(detail=thing.detail)
        return TimelineItem(
            number, lane.name, thing.t, None, clean(thing.label), _known_sort(thing.sort), facts
        )
    facts = tuple(_facts(thing))
    end = max(thing.end, thing.begin)
    # What was understood says more than the number of the utterance.
    label = thing.detail or thing.label if thing.sort == "speech" else thing.label
    return TimelineItem(number, lane.name, thing.begin, end, clean(label), _sort(thing), facts)


def _facts(thing: Interval) -> Iterator[tuple[str, str]]:
    yield from ((name, clean(value)) for name, value in thing.facts)
    if thing.outcome != _sort(thing):
        yield from _non_empty(outcome=thing.outcome.replace("_", " "))
    if thing.sort != "speech":  # whose detail is its label
        yield from _non_empty(**{_DETAILS.get(thing.sort, "detail"): thing.detail})
    yield from _non_empty(source=thing.source)
    if thing.cut:
        yield "end", "end not in the log: drawn to the last moment of the log"
    yield from _non_empty(run=thing.run)


def _non_empty(**facts: str) -> tuple[tuple[str, str], ...]:
    return tuple((name, clean(value)) for name, value in facts.items() if value)


def _sort(thing: Interval) -> str:
    if thing.sort == "action":
        return _known_sort(_LOOKS.get(thing.outcome, thing.outcome))
    if thing.sort == "state":
        return "engaged" if thing.label in ENGAGED else "state"
    if thing.sort == "trial":
        return "left-out" if thing.outcome in LEFT_OUT else "trial"
    return _known_sort(thing.sort)


def _known_sort(sort: str) -> str:
    name = sort.replace(" ", "-")
    return name if name in SORTS else "other"


def page_data(
    timeline: TimelineDrawing, lanes: Sequence[TimelineRow], zero: str
) -> dict[str, object]:
    """The data from which the page's script draws; see assets/04-lanes.js."""
    return {
        "end": _seconds(timeline.duration_us),
        "zero": zero,
        "lanes": [
            *({"title": row.title, "items": [_array(item) for item in row.items]} for row in lanes),
            *(drawn for curve in timeline.curves if (drawn := _curve(curve))),
        ],
    }


def _array(item: TimelineItem) -> list[object]:
    end = None if item.end is None else _seconds(item.end)
    return [_seconds(item.begin), end, item.label, item.sort, [list(fact) for fact in item.facts]]


def _seconds(us: int) -> float:
    return round(us / 1e6, 4)


def thinned(curve: SensorCurve, limit: int = POINTS) -> list[tuple[int, float | None]]:
    """Times and values of at most `limit` points; None where the curve is interrupted, because
    nothing was read for much longer than usual.
    """
    times = -(-len(curve.values) // limit) or 1
    step = curve.step_us * times
    means = [
        (place * step, float(f"{mean:.4g}"))
        for place, mean in enumerate(_means(curve.values, times))
        if mean is not None
    ]
    gaps = [after[0] - before[0] for before, after in pairwise(means)]
    longest = max(_PAUSE, 4 * median(gaps)) if gaps else 0
    points: list[tuple[int, float | None]] = []
    for t, mean in means:
        if points and t - points[-1][0] > longest:
            points.append((points[-1][0] + step, None))
        points.append((t, mean))
    return points


def _means(values: Sequence[float | None], times: int) -> Iterable[float | None]:
    """Of so many values each."""
    if times == 1:
        return values
    parts = (values[place : place + times] for place in range(0, len(values), times))
    there = ([value for value in part if value is not None] for part in parts)
    return (sum(part) / len(part) if part else None for part in there)


def curve_range(points: Sequence[tuple[int, float | None]]) -> tuple[float, float] | None:
    """The range of a curve's axis: from 0, or the least value below it, to the largest; None
    without values.
    """
    there = [value for _, value in points if value is not None]
    return (min(0.0, *there, 0.0), max(*there, 0.0)) if there else None


def _curve(curve: SensorCurve) -> dict[str, object] | None:
    points = thinned(curve)
    span = curve_range(points)
    if span is None:
        return None
    low, high = span
    return {
        "title": clean(curve.sensor),
        "unit": clean(curve.unit),
        "low": low,
        "high": high,
        "points": [[_seconds(t), value] for t, value in points],
    }
