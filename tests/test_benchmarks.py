"""How the benchmarks count. That each runs is seen by `make bench ARGS=--quick`."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.__main__ import TABLES
from benchmarks.figures import Spread, verdict
from benchmarks.sessions import Entry, matched
from benchmarks.stop_latency import answered


def test_make_bench_runs_every_benchmark() -> None:
    files = (Path(__file__).parents[1] / "benchmarks").glob("[a-z]*.py")
    assert {path.stem for path in files if "def main(" in path.read_text()} == set(TABLES)


def test_a_note_belongs_to_the_last_press_before_it() -> None:
    presses = [Entry(1_000_000, "a"), Entry(2_000_000, "b"), Entry(5_000_000, "a")]
    notes = [Entry(2_500_000, "a"), Entry(9_000_000, "a"), Entry(500_000, "b")]
    took, lost = matched(presses, notes)
    assert sorted(took) == [1.5, 4.0]
    assert lost == 1


def test_a_lost_press_does_not_take_the_next_ones_note() -> None:
    presses = [Entry(1_000_000, "stop"), Entry(2_000_000, "stop")]
    assert matched(presses, [Entry(2_100_000, "stop")]) == ([0.1], 1)


def test_late_stops_belong_to_their_presses_in_order() -> None:
    pressed = {"escape": [Entry(1_000_000, "stop all")], "ctrl+c": [Entry(2_000_000, "stop all")]}
    late = [Entry(4_000_000, "stop all"), Entry(5_000_000, "stop all")]
    assert answered(pressed, late) == {"escape": ([3.0], 0), "ctrl+c": ([3.0], 0)}
    assert answered(pressed, late[:1]) == {"escape": ([], 1), "ctrl+c": ([2.0], 0)}


def test_spreads_and_verdicts() -> None:
    spread = Spread.of([float(value) for value in range(100)])
    assert (spread.count, spread.p50, spread.p99, spread.worst) == (100, 50.0, 99.0, 99.0)
    assert spread.over(Spread(1, 25.0, 33.0, 33.0)) == (2.0, 3.0)
    assert verdict(1.0, 1.0) == "met"
    assert verdict(1.1, 1.0) == "MISSED"
    with pytest.raises(RuntimeError):
        Spread.of([])
