"""Outcomes as pictures: every participant, and what may be said of all of them.

The pictures need no style of the page, so that each can be a file of its own.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from woz_tui.analysis.html.markup import Markup, short, tag
from woz_tui.analysis.outcome_tables import caption, value_of
from woz_tui.analysis.outcomes import ConditionSummary, Outcome

_HEIGHT, _LEFT, _TOP, _BOTTOM, _COLUMN = 230, 92, 14, 36, 110
_GREY, _COLOUR = "#8c8c8c", "#0072b2"
#: Shades of the points of a scale: from one end over grey to the other (Okabe and Ito's blue and
#: orange), which people with all common kinds of colour vision tell apart.
_LOW, _MIDDLE, _HIGH = (0, 114, 178), (222, 222, 222), (230, 159, 0)
_TEXT = {"fill": "currentColor", "font_family": "sans-serif", "font_size": "11"}


class _Scale:
    """From values to places in the picture."""

    def __init__(self, low: float, high: float) -> None:
        self.low, self.high = low, high if high > low else low + 1

    def y(self, value: float) -> float:
        """What lies beyond the scale is drawn at its end."""
        share = (min(max(value, self.low), self.high) - self.low) / (self.high - self.low)
        return _HEIGHT - _BOTTOM - share * (_HEIGHT - _BOTTOM - _TOP)


def comparison(outcome: Outcome) -> Markup:
    """Participants, means and intervals by condition."""
    found = outcome.summaries()
    scale = _scale(outcome, found)
    width = _LEFT + _COLUMN * max(len(found), 1)
    return tag(
        "svg",
        tag("title", outcome.name.title),
        tag("desc", caption(outcome)),
        list(_axis(outcome, scale, width)),
        list(_people(outcome, scale)),
        [_mean(each, place, scale) for place, each in enumerate(found)],
        [
            _condition(outcome.label(each.condition), each.n, place)
            for place, each in enumerate(found)
        ],
        xmlns="http://www.w3.org/2000/svg",
        viewBox=f"0 0 {width} {_HEIGHT}",
        width=width,
        height=_HEIGHT,
        role="img",
        aria_label=f"{outcome.name.title}; the table beside it has its content",
    )


def _x(place: int) -> float:
    return _LEFT + _COLUMN * (place + 0.5)


def _scale(outcome: Outcome, found: Sequence[ConditionSummary]) -> _Scale:
    """The scale's own ends; without any, from 0 (or below) to the largest value or bar."""
    if outcome.name.low is not None and outcome.name.high is not None:
        return _Scale(outcome.name.low, outcome.name.high)
    values = [value for each in found for value in each.values]
    bars = [each.estimate.mean + (each.estimate.half or 0) for each in found if each.estimate]
    return _Scale(min(0.0, *values, 0.0), max(0.0, *values, *bars))


def _axis(outcome: Outcome, scale: _Scale, width: float) -> Iterator[Markup]:
    yield tag("line", x1=_LEFT, x2=_LEFT, y1=_TOP, y2=_HEIGHT - _BOTTOM, stroke="currentColor")
    middle = [] if outcome.name.unit else [(scale.low + scale.high) / 2]
    for value in (scale.low, *middle, scale.high):
        y = scale.y(value)
        yield tag("line", x1=_LEFT, x2=width, y1=y, y2=y, stroke=_GREY, stroke_width="0.4")
        at = f"{value:g}" if not outcome.name.unit else value_of(outcome.name, value)
        yield tag("text", at, x=_LEFT - 5, y=y + 4, text_anchor="end", **_TEXT)
    for text, y in zip(outcome.name.ends, (scale.y(scale.low), scale.y(scale.high)), strict=True):
        if text:
            place = y + (15 if y > _HEIGHT / 2 else -4)
            yield tag("text", text[:24], x=2, y=place, **_TEXT)


def _people(outcome: Outcome, scale: _Scale) -> Iterator[Markup]:
    within = outcome.within
    for number, (_, values) in enumerate(outcome.lines()):
        # Apart from each other, so that equal answers can be counted.
        aside = ((number * 7) % 11 - 5) * 1.6
        points = [
            (_x(place) + aside, scale.y(value))
            for place, value in enumerate(values)
            if value is not None
        ]
        if within and len(points) > 1:
            drawn = " ".join(f"{short(x)},{short(y)}" for x, y in points)
            yield tag(
                "polyline", points=drawn, fill="none", stroke=_GREY, stroke_width="1", opacity="0.5"
            )
        for x, y in points:
            yield tag("circle", cx=x, cy=y, r=2.5, fill=_GREY, opacity="0.7")


def _mean(each: ConditionSummary, place: int, scale: _Scale) -> Markup | None:
    if each.estimate is None or each.is_few:
        return None
    x = _x(place) + 18
    mean, half = each.estimate.mean, each.estimate.half
    bar = None
    if half is not None:
        low, high = scale.y(mean - half), scale.y(mean + half)
        bar = tag("line", x1=x, x2=x, y1=low, y2=high, stroke=_COLOUR, stroke_width="2.5")
    return tag("g", bar, tag("circle", cx=x, cy=scale.y(mean), r=4.5, fill=_COLOUR))


def _condition(name: str, n: int, place: int) -> Markup:
    words = name[:16]
    y = _HEIGHT - _BOTTOM + 16
    return tag(
        "g",
        tag("text", words, x=_x(place), y=y, text_anchor="middle", **_TEXT),
        tag("text", f"n = {n}", x=_x(place), y=y + 14, text_anchor="middle", **_TEXT),
    )


_BAR, _ROW = 300, 26
#: Pixels that a number needs.
_ROOM = 10


def distribution(outcome: Outcome) -> Markup | None:
    """How often each point of a scale was chosen, one row a condition; None: it has no points."""
    rows = [
        (outcome.label(each.condition), each.counts)
        for each in outcome.summaries()
        if sum(each.counts)
    ]
    if not rows:
        return None
    low = int(outcome.name.low or 0)
    height = _ROW * len(rows) + 18
    drawn: list[Markup | None] = []
    for place, (condition, counts) in enumerate(rows):
        y, x, total = place * _ROW + 2, float(_LEFT), sum(counts)
        words = condition[:14]
        drawn.append(
            tag("text", words, x=_LEFT - 6, y=y + _ROW / 2 + 2, text_anchor="end", **_TEXT)
        )
        for point, count in enumerate(counts):
            width = count / total * _BAR
            box = tag(
                "rect",
                tag("title", f"{low + point}: {count}"),
                x=x,
                y=y,
                width=width,
                height=_ROW - 6,
                fill=_shade(point, len(counts)),
                stroke="#ffffff",
                stroke_width="0.7",
            )
            drawn += [box, _inside(x, y, width, f"{low + point}")] if count else []
            x += width
    y = _ROW * len(rows) + 14
    ends = [
        f"{value:g}{f' {text}' if text else ''}"
        for value, text in zip(
            (outcome.name.low or 0, outcome.name.high or 0), outcome.name.ends, strict=True
        )
    ]
    words = "; ".join(
        f"{condition}: "
        + ", ".join(f"{low + point} {count} times" for point, count in enumerate(counts) if count)
        for condition, counts in rows
    )
    return tag(
        "svg",
        tag("title", f"Answers to {outcome.name.title}: {words}"),
        drawn,
        tag("text", ends[0], x=_LEFT, y=y, **_TEXT),
        tag("text", ends[1], x=_LEFT + _BAR, y=y, text_anchor="end", **_TEXT),
        xmlns="http://www.w3.org/2000/svg",
        viewBox=f"0 0 {_LEFT + _BAR + 8} {height}",
        width=_LEFT + _BAR + 8,
        height=height,
        role="img",
        aria_label=f"Answers to {outcome.name.title}: {words}",
    )


def _inside(x: float, y: float, width: float, words: str) -> Markup | None:
    """Words in the middle of a box, where there is room."""
    if width < _ROOM:
        return None
    style = {**_TEXT, "fill": "#000000"}
    return tag("text", words, x=x + width / 2, y=y + _ROW / 2 + 1, text_anchor="middle", **style)


def _shade(point: int, points: int) -> str:
    share = point / max(points - 1, 1) * 2 - 1
    end = _LOW if share < 0 else _HIGH
    mixed = (
        round(middle + (far - middle) * abs(share) * 0.85)
        for middle, far in zip(_MIDDLE, end, strict=True)
    )
    return "#" + "".join(f"{each:02x}" for each in mixed)
