"""Figures and tables for the benchmarks: percentiles, ratios, and whether a goal was met."""

from __future__ import annotations

import importlib.metadata
import os
import platform
from collections.abc import Mapping, Sequence
from dataclasses import dataclass


def percentile(values: Sequence[float], share: float) -> float:
    """The value below which `share` (0..1) of `values` lie, by the nearest rank."""
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(share * len(ordered)))]


@dataclass(frozen=True)
class Spread:
    """What is told of many values: how many, the middle, the tail, the worst."""

    count: int
    p50: float
    p99: float
    worst: float

    @classmethod
    def of(cls, values: Sequence[float]) -> Spread:
        """Of at least one value."""
        if not values:
            raise RuntimeError("nothing was measured")
        return cls(len(values), percentile(values, 0.5), percentile(values, 0.99), max(values))

    def over(self, floor: Spread) -> tuple[float, float]:
        """How many times the floor, at p50 and at p99."""
        return self.p50 / floor.p50, self.p99 / floor.p99


def verdict(value: float, goal: float) -> str:
    """Whether `value` stays below `goal`, as a word for a table."""
    return "met" if value <= goal else "MISSED"


def table(title: str, head: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Print a table: the first column to the left, the others to the right."""
    lines = [list(head), *(list(row) for row in rows)]
    widths = [max(len(line[column]) for line in lines) for column in range(len(head))]
    print(f"\n{title}")
    for line in lines:
        cells = [
            text.ljust(width) if column == 0 else text.rjust(width)
            for column, (text, width) in enumerate(zip(line, widths, strict=True))
        ]
        print("  " + "   ".join(cells).rstrip())


def trips(title: str, took: Mapping[str, Sequence[float]], floor: str) -> None:
    """Print a table of round trips in milliseconds: a row for each way, with its ratios to `floor`,
    one of them.
    """
    spreads = {name: Spread.of(values) for name, values in took.items()}
    rows = []
    for name, spread in spreads.items():
        p50, p99 = spread.over(spreads[floor])
        ratios = ["", ""] if name == floor else [f"{p50:.1f} x", f"{p99:.1f} x"]
        figures = [f"{spread.p50:.2f}", f"{spread.p99:.2f}", f"{spread.worst:.1f}"]
        rows.append([name, str(spread.count), *figures, *ratios])
    table(title, ("way", "trips", "p50 ms", "p99 ms", "worst ms", "p50", "p99"), rows)


def machine() -> str:
    """What the figures were measured on, and how busy it was."""
    load = os.getloadavg()
    return (
        f"{os.cpu_count()} cores {platform.machine()}, Python {platform.python_version()}, "
        f"Textual {importlib.metadata.version('textual')}, "
        f"load average {load[0]:.1f} (1 min) {load[1]:.1f} (5 min)"
    )
