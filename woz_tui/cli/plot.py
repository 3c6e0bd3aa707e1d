"""Curves in a terminal, drawn with braille dots: 2 x 4 of them in every cell."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

_BLANK = 0x2800
#: Bits of a braille sign by column and row of the dot.
_DOTS = ((0x01, 0x02, 0x04, 0x40), (0x08, 0x10, 0x20, 0x80))
_AXIS = 7


@dataclass(frozen=True, slots=True)
class Curve:
    """Values over evenly spaced times, drawn between `low` and `high`."""

    name: str
    values: Sequence[float]
    low: float
    high: float
    unit: str = "°"


def chart(curve: Curve, width: int, height: int) -> list[str]:
    """Lines of text, `width` cells wide, with the limits and the name beside the curve."""
    cells = max(8, width - _AXIS - 1)
    grid = [[_BLANK] * cells for _ in range(height)]
    span = curve.high - curve.low
    rows = height * 4 - 1
    if span > 0 and curve.values:
        before: int | None = None
        for column in range(cells * 2):
            row = _row(_at(curve.values, column / (cells * 2 - 1)), curve, rows)
            for each in _between(before, row):
                grid[each // 4][column // 2] |= _DOTS[column % 2][each % 4]
            before = row
    labels = [""] * height
    labels[-1] = f"{curve.low:g}{curve.unit}"
    labels[0] = f"{curve.high:g}{curve.unit}"
    lines = [
        f"{label:>{_AXIS}}┤{''.join(map(chr, cells_))}"
        for label, cells_ in zip(labels, grid, strict=True)
    ]
    return [f"{'':{_AXIS}} {curve.name}", *lines]


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


def _at(values: Sequence[float], share: float) -> float:
    return values[min(len(values) - 1, round(share * (len(values) - 1)))]


def _row(value: float, curve: Curve, rows: int) -> int:
    share = (value - curve.low) / (curve.high - curve.low)
    return rows - min(rows, max(0, math.floor(share * rows + 0.5)))


def _between(before: int | None, row: int) -> range:
    """Dots of one column, joined to those of the column before."""
    if before is None or before == row:
        return range(row, row + 1)
    return range(row, before) if before > row else range(before + 1, row + 1)
