"""Small pictures of distributions, and tables whose cells are coloured by their numbers."""

from __future__ import annotations

from collections.abc import Mapping

from woz_tui.analysis.durations import Durations
from woz_tui.analysis.html.figure_definitions import wide
from woz_tui.analysis.html.markup import Markup, isolated, joined, short, tag
from woz_tui.analysis.text_format import duration

_WIDTH, _HEIGHT, _BINS = 300, 84, 24
_BASE = 64
#: Shades of a coloured table.
_SHADES = 6
#: The widths that a bin may have, times a power of ten.
_NICE = (1, 2, 5, 10)


def distribution(series: Durations, title: str) -> Markup:
    """How often which duration occurred, with median and 95th percentile; the last bin has all
    that is longer than its beginning.
    """
    if not series.n or series.median is None or series.p95 is None:
        return tag("p", "No data.", class_="none")
    step = _bin(series)
    bins = [0] * _BINS
    for one in series.values:
        bins[min(one // step, _BINS - 1)] += 1
    span = step * _BINS
    lines = ((series.median, "median", "median"), (series.p95, "p95", "p95"))
    words = f"{title}: {series.n} values, median {duration(series.median)}, "
    words += f"95th percentile {duration(series.p95)}, longest {duration(series.most)}"
    return tag(
        "svg",
        tag("title", words),
        [_bar(place, number, max(bins), step) for place, number in enumerate(bins) if number],
        tag("line", x1=0, x2=_WIDTH, y1=_BASE + 0.5, y2=_BASE + 0.5, class_="base"),
        [_line(min(value / span, 1) * _WIDTH, style) for value, _, style in lines],
        tag("text", "0", x=0, y=_BASE + 14, class_="tick first"),
        tag("text", duration(span / 2), x=_WIDTH / 2, y=_BASE + 14, class_="tick"),
        tag("text", f"≥ {duration(span - step)}", x=_WIDTH, y=_BASE + 14, class_="tick last"),
        class_="distribution",
        viewBox=f"0 0 {_WIDTH} {_HEIGHT}",
        role="img",
        aria_label=words,
    )


def _bin(series: Durations) -> int:
    """The width of a bin: a round number, so that few values lie beyond the last bin."""
    if not series.p95:
        return 1_000
    least = max(series.p95 * 1.25 / _BINS, 1)
    power = 1
    while power * 10 <= least:
        power *= 10
    return power * next(nice for nice in _NICE if power * nice >= least)


def _bar(place: int, number: int, most: int, step: int) -> Markup:
    width = _WIDTH / _BINS
    height = max(number / most * (_BASE - 10), 1.5)
    beyond = place == _BINS - 1
    span = (
        f"from {duration(place * step)}"
        if beyond
        else (f"{duration(place * step)} to {duration((place + 1) * step)}")
    )
    return tag(
        "rect",
        tag("title", f"{span}: {number}"),
        x=place * width + 0.5,
        y=_BASE - height,
        width=width - 1,
        height=height,
        class_="column",
    )


def _line(x: float, style: str) -> Markup:
    return joined(
        tag("line", x1=x, x2=x, y1=4, y2=_BASE, class_=style),
        tag("path", d=f"M{short(x - 3.5)} 0h7l-3.5 5z", class_=style),
    )


def transitions(table: Mapping[str, Mapping[str, int]]) -> Markup:
    """A table of how often each state (row) led to each other (column); darker is more often."""
    states = [*dict.fromkeys([*table, *(each for row in table.values() for each in row)])]
    most = max((number for row in table.values() for number in row.values()), default=0)
    if not most:
        return tag("p", "No transitions.", class_="none")
    head = tag(
        "tr", tag("th", "from \\ to", scope="col"), [_head(state, "col") for state in states]
    )
    body = []
    for state in states:
        if row := table.get(state):
            cells = [_head(state, "row")]
            for number in (row.get(other, 0) for other in states):
                shade = -(-number * _SHADES // most)
                cells.append(tag("td", str(number) if number else "", class_=f"heat-{shade}"))
            body.append(tag("tr", cells))
    caption = tag("caption", "Transitions of the engagement model")
    return wide(
        tag("table", caption, tag("thead", head), tag("tbody", body), class_="heat"),
        "Transitions of the engagement model",
    )


def _head(text: str, scope: str) -> Markup:
    return tag("th", isolated(text), scope=scope)
