"""Curves over time, of dots, with an axis below them."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from woz_tui.console.drawing.cells import fit
from woz_tui.console.drawing.dot_canvas import DotCanvas, DotLayer
from woz_tui.console.drawing.glyphs import UNICODE

#: What a curve may lack without being drawn as lacking it.
SEEN = 1.0
#: A key frame that the joints reach in time, one that they do not, and one of a layer that is off.
KEY, MISSED, OFF = "◆", "!", "◇"
#: Cells left of a curve.
_AXIS = 7


@dataclass(frozen=True, slots=True)
class Curve:
    """Values over evenly spaced times, drawn between `low` and `high`; `wanted` are as many, drawn
    dotted where they are not what came out.
    """

    name: str
    values: Sequence[float]
    low: float
    high: float
    unit: str = "°"
    wanted: Sequence[float] = ()

    @property
    def lags(self) -> bool:
        """Whether something else came out than was wanted."""
        pairs = zip(self.values, self.wanted, strict=False)
        return any(abs(value - wanted) > SEEN for value, wanted in pairs)


def chart(curve: Curve, width: int, height: int) -> list[str]:
    """Lines of text, `width` cells wide, with the limits and the name beside the curve."""
    cells = max(8, width - _AXIS - 1)
    layers = {"wanted": DotLayer("plain", "."), "curve": DotLayer("plain", "*")}
    canvas = DotCanvas(cells, height, layers)
    span = curve.high - curve.low
    drawn = {"wanted": curve.wanted if curve.lags else (), "curve": curve.values}
    for layer, values in drawn.items():
        if span <= 0 or not values:
            continue
        places = (round(dot * (len(values) - 1) / (cells * 2 - 1)) for dot in range(cells * 2))
        shares = (min(1.0, max(0.0, (curve.high - values[place]) / span)) for place in places)
        dots = [(dot, round(share * (height * 4 - 1))) for dot, share in enumerate(shares)]
        for before, dot in itertools.pairwise(dots[:1] + dots):
            canvas.line(before, dot, layer, every=3 if layer == "wanted" else 1)
    labels = [""] * height
    labels[-1] = f"{curve.low:g}{curve.unit}"
    labels[0] = f"{curve.high:g}{curve.unit}"
    lines = [
        f"{label:>{_AXIS}}┤{''.join(sign for sign, _ in row)}"
        for label, row in zip(labels, canvas.rows(UNICODE), strict=True)
    ]
    return [f"{'':{_AXIS}} {curve.name}", *lines]


def key_row(name: str, keys: Mapping[float, str], seconds: float, width: int) -> str:
    """A line of signs at their times, by the same axis; of two in one cell the later one is seen,
    but what is missed is never hidden.
    """
    cells = max(8, width - _AXIS - 1)
    row = ["─"] * cells
    for time, sign in sorted(keys.items()):
        place = min(cells - 1, round(time / seconds * (cells - 1)) if seconds > 0 else 0)
        if row[place] != MISSED:
            row[place] = sign
    return f"{fit(name, _AXIS, UNICODE.ellipsis):>{_AXIS}}┤{''.join(row)}"


def time_axis(seconds: float, width: int) -> list[str]:
    """A line of ticks and a line of seconds below the curves; ticks stand at round times."""
    cells = max(8, width - _AXIS - 1)
    times = _round_times(seconds, max(1, min(10, cells // 12)))
    places = [round(time / seconds * (cells - 1)) if seconds > 0 else 0 for time in times]
    ruler = "".join("┬" if place in places else "─" for place in range(cells))
    labels = [" "] * (cells + 8)
    for place, time in zip(places, times, strict=True):
        text = f"{time:g}" + ("s" if time == times[-1] else "")
        start = max(0, min(place - len(text) // 2, cells - len(text)))
        labels[start : start + len(text)] = text
    return [f"{'':{_AXIS}}└{ruler}", f"{'':{_AXIS}} {''.join(labels).rstrip()}"]


def _round_times(seconds: float, most: int) -> list[float]:
    """0 and up to `most` multiples of 1, 2 or 5 times a power of ten, none beyond `seconds`."""
    if not seconds > 0:
        return [0.0]
    power = math.floor(math.log10(seconds / most))
    step, digits = next(
        (factor * 10.0**exponent, max(0, -exponent))
        for exponent in (power, power + 1)
        for factor in (1, 2, 5)
        if seconds / (factor * 10.0**exponent) <= most
    )
    return [round(index * step, digits) for index in range(math.floor(seconds / step + 1e-9) + 1)]
