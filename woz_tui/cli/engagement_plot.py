"""Delay against stability of the filters, as a picture (SVG).

Colours are of Okabe and Ito's set for colour-blind readers; shapes and words say the same.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from woz_tui.sensing.bench.figures import Measured, Report

QUEUE, JOINT, GOAL, INK, FAINT = "#0072B2", "#D55E00", "#009E73", "#222222", "#BBBBBB"
#: A panel's frame in the picture's units, and what is around it.
WIDE, HIGH, LEFT, TOP, GAP, BELOW = 250, 230, 58, 84, 40, 92
#: Seconds and per cent at the ends of the axes.
LATEST, LEAST = 3.0, 0.0


@dataclass(frozen=True, slots=True)
class Panel:
    """One change against one kind of stability, with what is hoped of both."""

    title: str
    change: str
    steady: str
    within: float
    least: float = 98.0


PANELS = (
    Panel("Arriving", "arriving", "nobody", 0.67),
    Panel("Leaving", "leaving", "short glances", 0.67),
    Panel("Turning away", "turning away", "short glances", 1.7),
)
_STEADY = {"nobody": "nobody there", "short glances": "with glances of 0.56 s"}


def draw(report: Report) -> str:
    """The picture: a panel each for arriving, leaving and turning away."""
    width = LEFT + len(PANELS) * (WIDE + GAP)
    height = TOP + HIGH + BELOW
    body = [
        f'<rect width="{width}" height="{height}" fill="white"/>',
        _text(LEFT, 24, "Delay and stability of the filters", size=16, weight="bold"),
        _text(
            *(LEFT, 42, "Up and to the left is better."),
            colour="#555555",
        ),
    ]
    for index, panel in enumerate(PANELS):
        body += _panel(report, panel, LEFT + index * (WIDE + GAP))
    body += _legend(height - 14, report)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" '
        f'font-family="sans-serif" role="img">\n<title>Delay and stability of the filters</title>\n'
        + "\n".join(body)
        + "\n</svg>\n"
    )


def _panel(report: Report, panel: Panel, left: float) -> Iterator[str]:
    def across(seconds: float) -> float:
        return left + min(seconds, LATEST) / LATEST * WIDE

    yield _text(left, TOP - 12, panel.title, size=13, weight="bold")
    yield from _axes(panel, left, across)
    right, bottom = across(panel.within), _down(panel.least)
    yield (
        f'<rect x="{left:.1f}" y="{_down(100):.1f}" width="{right - left:.1f}" '
        f'height="{bottom - _down(100):.1f}" fill="{GOAL}" fill-opacity="0.25" stroke="{GOAL}"/>'
    )
    queues = [each for each in report.filters if each.candidate.key in _PLACES]
    places = [(across(_delay(each, panel)), _down(_share(each, panel))) for each in queues]
    line = " ".join(f"{x:.1f},{y:.1f}" for x, y in places)
    yield f'<polyline points="{line}" fill="none" stroke="{QUEUE}" stroke-dasharray="4 3"/>'
    for each, (x, y) in zip(queues, places, strict=True):
        yield f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4.5" fill="{QUEUE}"/>'
        if each.candidate.key == "none":
            yield _text(x - 8, y + 4, _PLACES["none"], colour=QUEUE, anchor="end")
        else:
            yield _text(x + 7, y + 16, _PLACES[each.candidate.key], colour=QUEUE)
    for each in report.filters:
        if each.candidate.key == "joint":
            yield from _star(across(_delay(each, panel)), _down(_share(each, panel)))


#: Queues in the order of their places, and what their points are called.
_PLACES = {
    **{"none": "1", "fifo-3": "3", "fifo-5": "5"},
    **{"published": "8", "fifo-15": "15"},
}


def _axes(panel: Panel, left: float, across: Callable[[float], float]) -> Iterator[str]:
    bottom = TOP + HIGH
    for share in range(0, 101, 20):
        y = _down(share)
        yield f'<path d="M{left:.1f} {y:.1f}h{WIDE}" stroke="{FAINT}" stroke-width="0.5"/>'
        yield _text(left - 6, y + 4, f"{share}", size=11, anchor="end")
    for half in range(int(LATEST * 2) + 1):
        x = across(half / 2)
        yield f'<path d="M{x:.1f} {bottom}v4" stroke="{INK}"/>'
        yield _text(x, bottom + 16, f"{half / 2:g}", size=11, anchor="middle")
    yield f'<path d="M{left:.1f} {TOP}v{HIGH}h{WIDE}" fill="none" stroke="{INK}"/>'
    middle = left + WIDE / 2
    yield _text(middle, bottom + 34, "noticed within (s, 95 % of runs)", anchor="middle")
    words = f"stable for 30 s (%), {_STEADY[panel.steady]}"
    yield _text(middle, bottom + 52, f"up: {words}", anchor="middle")


def _legend(y: float, report: Report) -> Iterator[str]:
    yield f'<circle cx="{LEFT + 5}" cy="{y - 4:.1f}" r="4.5" fill="{QUEUE}"/>'
    yield _text(
        LEFT + 16,
        y,
        "fifo of so many places (1: no filter, 8: the published program)",
    )
    yield from _star(LEFT + 482, y - 4)
    yield _text(LEFT + 494, y, "joint filter")
    yield f'<rect x="{LEFT + 580}" y="{y - 9:.1f}" width="12" height="10" fill="{GOAL}" '
    yield f'fill-opacity="0.25" stroke="{GOAL}"/>'
    words = f"hoped for \u00b7 {report.rate:g} Hz, {report.runs} runs, seed {report.seed}"
    yield _text(LEFT + 598, y, words)


def _star(x: float, y: float) -> Iterator[str]:
    yield (
        f'<path d="M{x:.1f} {y - 7:.1f}l7 7l-7 7l-7 -7z" fill="{JOINT}" stroke="white" '
        'stroke-width="0.8"/>'
    )


def _down(share: float) -> float:
    return TOP + HIGH * (100.0 - max(share, LEAST)) / (100.0 - LEAST)


def _delay(each: Measured, panel: Panel) -> float:
    return each.changes[panel.change].most


def _share(each: Measured, panel: Panel) -> float:
    return each.steady[panel.steady].share


def _text(
    x: float,
    y: float,
    words: str,
    *,
    size: int = 12,
    colour: str = INK,
    anchor: str = "start",
    weight: str = "normal",
) -> str:
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" fill="{colour}" '
        f'text-anchor="{anchor}" font-weight="{weight}">{escape(words)}</text>'
    )
