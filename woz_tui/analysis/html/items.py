"""A timeline's content as the page has it: numbered items in lanes, with everything to be said."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from woz_tui.analysis.html.numbers import duration
from woz_tui.analysis.html.sorts import SORTS
from woz_tui.analysis.rows import NOT_COUNTED
from woz_tui.analysis.timeline import Curve, Instant, Interval, Lane, Timeline
from woz_tui.sensing.machine import ENGAGED

#: Points of a curve on the page; more could not be told apart, and would only make it large.
POINTS = 1500


@dataclass(frozen=True, slots=True)
class Item:
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
class Row:
    """A lane: its items by their beginning."""

    title: str
    sort: str
    items: tuple[Item, ...]


def rows(timeline: Timeline) -> list[Row]:
    """All lanes; the items are numbered through, from 0."""
    found: list[Row] = []
    number = 0
    for lane in timeline.lanes:
        things: list[Interval | Instant] = [*lane.intervals, *lane.instants]
        things.sort(key=_begin)
        items = tuple(_item(number + place, lane, thing) for place, thing in enumerate(things))
        number += len(items)
        found.append(Row(lane.name, lane.sort, items))
    return found


def by_time(lanes: Sequence[Row]) -> list[Item]:
    """All items, the earliest first."""
    return sorted((item for row in lanes for item in row.items), key=lambda it: (it.begin, it.number))


def _begin(thing: Interval | Instant) -> int:
    return thing.begin if isinstance(thing, Interval) else thing.t


def _item(number: int, lane: Lane, thing: Interval | Instant) -> Item:
    if isinstance(thing, Instant):
        facts = _stated(detail=thing.detail)
        return Item(number, lane.name, thing.t, None, thing.label, _known(thing.sort), facts)
    facts = tuple(_facts(thing))
    end = max(thing.end, thing.begin)
    # What was understood says more than the number of the utterance.
    label = thing.detail or thing.label if thing.sort == "speech" else thing.label
    return Item(number, lane.name, thing.begin, end, label, _sort(thing), facts)


def _facts(thing: Interval) -> Iterator[tuple[str, str]]:
    yield from thing.facts
    yield from _stated(outcome=thing.outcome, detail=thing.detail, source=thing.source)
    if thing.cut:
        yield "end", "not in the log"
    yield from _stated(run=thing.run)


def _stated(**facts: str) -> tuple[tuple[str, str], ...]:
    return tuple((name, value) for name, value in facts.items() if value)


def _sort(thing: Interval) -> str:
    if thing.sort == "action":
        return _known(thing.outcome)
    if thing.sort == "state":
        return "engaged" if thing.label in ENGAGED else "state"
    if thing.sort == "trial":
        return "left-out" if thing.outcome in NOT_COUNTED else "trial"
    return _known(thing.sort)


def _known(sort: str) -> str:
    name = sort.replace(" ", "-")
    return name if name in SORTS else "other"


def page_data(timeline: Timeline, lanes: Sequence[Row], zero: str) -> dict[str, object]:
    """What the page's script draws from; see assets/04-lanes.js. Times in seconds."""
    return {
        "end": _seconds(timeline.duration_us),
        "zero": zero,
        "lanes": [
            *({"title": row.title, "items": [_array(item) for item in row.items]} for row in lanes),
            *(drawn for curve in timeline.curves if (drawn := _curve(curve))),
        ],
    }


def _array(item: Item) -> list[object]:
    end = None if item.end is None else _seconds(item.end)
    return [_seconds(item.begin), end, item.label, item.sort, [list(fact) for fact in item.facts]]


def _seconds(us: int) -> float:
    return round(us / 1e6, 4)


def thinned(curve: Curve, limit: int = POINTS) -> tuple[int, list[float | None]]:
    """The curve's step and values, means over so many values that at most `limit` are left."""
    times = -(-len(curve.values) // limit) or 1
    return curve.step_us * times, [
        _mean(curve.values[first : first + times]) for first in range(0, len(curve.values), times)
    ]


def _mean(values: Sequence[float | None]) -> float | None:
    there = [value for value in values if value is not None]
    return float(f"{sum(there) / len(there):.4g}") if there else None


def curve_range(values: Sequence[float | None]) -> tuple[float, float] | None:
    """What the picture's axis spans: from 0, or below, to the largest; None without values."""
    there = [value for value in values if value is not None]
    return (min(0.0, *there, 0.0), max(*there, 0.0)) if there else None


def _curve(curve: Curve) -> dict[str, object] | None:
    step, values = thinned(curve)
    span = curve_range(values)
    if span is None:
        return None
    points = [[_seconds(place * step), value] for place, value in enumerate(values)]
    low, high = span
    return {"title": curve.sensor, "unit": curve.unit, "low": low, "high": high, "points": points}


def spoken(item: Item) -> str:
    """The item in words, for those who see no picture."""
    lasting = "" if item.end is None else f", {duration(item.end - item.begin)}"
    return f"{item.label} ({SORTS[item.sort].title}{lasting})"
