"""A session's timeline as it is without a script: the whole of it, as wide as a sheet of paper."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from woz_tui.analysis.html.markup import Markup, joined, short, tag
from woz_tui.analysis.html.timeline_items import TimelineItem, TimelineRow, curve_range, thinned
from woz_tui.analysis.html.timeline_styles import SORTS
from woz_tui.analysis.text_format import clock
from woz_tui.analysis.timeline_lanes import SensorCurve, TimelineDrawing

WIDTH, GUTTER, RIGHT = 960, 150, 10
RULER, ROW, GAP, CURVE = 22, 18, 5, 46
_LETTER = 6.7
#: Points of a curve in the picture: one for each pixel or two.
_POINTS = 500
#: Distances between the ruler's ticks, in seconds.
_STEPS = (0.1, 0.5, 1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 14400, 86400)


@dataclass(frozen=True, slots=True)
class PictureScale:
    """From times in microseconds to places in the picture."""

    duration_us: int
    left: float = GUTTER
    width: float = WIDTH - GUTTER - RIGHT

    def x(self, us: float) -> float:
        """The place of `us`."""
        return self.left + us / max(self.duration_us, 1) * self.width

    def ticks(self, room: float = 76) -> Iterator[tuple[float, str]]:
        """Places of the ruler's ticks, at least `room` apart, and what stands there.

        Whole days apart where a damaged time makes a session last for years.
        """
        seconds = max(self.duration_us, 1) / 1e6
        apart = room / self.width * seconds
        days = math.ceil(apart / _STEPS[-1]) * _STEPS[-1]
        step = next((each for each in _STEPS if each >= apart), days)
        for number in range(int(seconds / step) + 1):
            us = round(number * step * 1e6)
            yield self.x(us), clock(us, 1 if step < 1 else 0)


def picture(timeline: TimelineDrawing, lanes: Sequence[TimelineRow], title: str) -> Markup:
    """Draws the session as an SVG element."""
    scale = PictureScale(timeline.duration_us)
    drawn: list[Markup] = []
    y: float = RULER
    for row in lanes:
        stacked = stack(row.items)
        drawn.append(_title(row.title, y, ROW))
        drawn += [_row(items, scale, y + place * ROW) for place, items in enumerate(stacked)]
        y += max(len(stacked), 1) * ROW + GAP
    for curve in timeline.curves:
        if path := _curve(curve, scale, y):
            drawn += [_title(curve.sensor, y, CURVE), path]
            y += CURVE + GAP
    return tag(
        "svg",
        _ruler(scale, y),
        drawn,
        class_="lanes",
        viewBox=f"0 0 {WIDTH} {short(y)}",
        role="img",
        aria_label=f"Timeline of {title}; the list of events below has its content",
    )


def stack(items: Sequence[TimelineItem]) -> list[list[TimelineItem]]:
    """The items in rows in which none overlap, each in the first that has room."""
    rows: list[list[TimelineItem]] = []
    ends: list[int] = []
    for item in items:
        place = next((n for n, end in enumerate(ends) if _free(end, item)), None)
        if place is None:
            place = len(rows)
            rows.append([])
            ends.append(-1)
        rows[place].append(item)
        ends[place] = item.begin if item.end is None else item.end
    return rows


def _free(end: int, item: TimelineItem) -> bool:
    """Whether a row has room from `end` on; of two moments at the same time each has its own."""
    return end < item.begin or (end == item.begin and item.end is not None)


def _ruler(scale: PictureScale, bottom: float) -> Markup:
    return joined(
        (
            tag("line", x1=x, x2=x, y1=RULER - 6, y2=bottom, class_="grid"),
            tag("text", text, x=x, y=11, class_="tick"),
        )
        for x, text in scale.ticks()
    )


def _title(text: str, y: float, height: float) -> Markup:
    return tag("text", cut(text, GUTTER - 12), x=4, y=y + height / 2, class_="title")


def cut(text: str, room: float) -> str:
    """As many letters of `text` as have room in `room` pixels."""
    letters = int(room / _LETTER)
    return text if len(text) <= letters else text[: max(letters - 1, 0)] + "…"


def _row(items: Sequence[TimelineItem], scale: PictureScale, y: float) -> Markup:
    """Bars as one path for each look, so that an hour's picture stays small; then what is on them.

    Items that fall on the same pixel and look the same are drawn once.
    """
    paths: dict[str, str] = {}
    above: list[Markup] = []
    last: tuple[str, int] = ("", -1)
    for item in items:
        x0 = scale.x(item.begin)
        x1 = max(scale.x(item.begin if item.end is None else item.end), x0 + 1.2)
        if (item.sort, int(x1)) == last:
            continue
        last = (item.sort, int(x1))
        if item.end is not None:
            box = f"M{short(x0)} {short(y + 1)}H{short(x1)}v{ROW - 2}H{short(x0)}z"
            paths[item.sort] = paths.get(item.sort, "") + box
        above += _on(item, x0, x1, y)
    bars = [tag("path", d=path, class_=f"bar s-{sort}") for sort, path in paths.items()]
    return joined(bars, above)


def _on(item: TimelineItem, x0: float, x1: float, y: float) -> Iterator[Markup]:
    middle = y + ROW / 2
    room = x1 - x0 - 8
    if SORTS[item.sort].path:
        inside = room > 8
        center = x0 if item.end is None else (x1 - 6.5 if inside else x1 + 6.5)
        place = {"x": center - 5.5, "y": middle - 5.5, "width": 11, "height": 11}
        where = " within" if inside and item.end is not None else ""
        yield tag("use", href=f"#g-{item.sort}", class_=f"glyph s-{item.sort}{where}", **place)
        room -= 11
    if room > 3 * _LETTER:
        yield tag("text", cut(item.label, room), x=x0 + 4, y=middle, class_=f"on s-{item.sort}")


def _curve(curve: SensorCurve, scale: PictureScale, y: float) -> Markup | None:
    points = thinned(curve, _POINTS)
    span = curve_range(points)
    if span is None:
        return None
    low, high = span
    path, command, per_value = [], "M", (CURVE - 4) / ((high - low) or 1)
    for t, number in points:
        if number is None:
            command = "M"
            continue
        up = y + CURVE - 2 - (number - low) * per_value
        # A line of no length makes a value that stands alone a dot.
        dot = "h0" if command == "M" else ""
        path.append(f"{command}{short(scale.x(t))} {short(up)}{dot}")
        command = "L"
    right = WIDTH - RIGHT - 3
    return joined(
        tag("path", d="".join(path), class_="curve"),
        tag("text", f"{high:.3g} {curve.unit}", x=right, y=y + 7, class_="axis"),
        tag("text", f"{low:.3g} {curve.unit}", x=right, y=y + CURVE - 5, class_="axis"),
    )
