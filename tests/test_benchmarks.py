"""The benchmarks run, in a reduced form, and print their tables; their figures are not judged."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
import uuid
from collections.abc import Iterator
from pathlib import Path

import psutil
import pytest

from benchmarks.figures import Spread, verdict
from benchmarks.sessions import Entry, matched
from benchmarks.stop_latency import answered
from tests.fakes import libqi

pytestmark = pytest.mark.real_clock

ROOT = Path(__file__).parents[1]
#: Script -> what must stand in its tables.
TABLES: dict[str, tuple[str, ...]] = {
    "key_latency.py": ("idle: key to perform", "load: key to perform", "50 Hz loop"),
    "stop_latency.py": ("idle: escape + key", "asleep: ctrl+c", "spinning: escape"),
    "midi_latency.py": ("a body at 50 Hz", "a body at 100 Hz", "byte to setpoint"),
    "bml_timing.py": ("on the simulated robot", "on EyePi", "bare timer", "words begin", "strokes"),
    "blob.py": ("20 x 15 rgb24, a ball", "160 x 120 rgb24, noise", "of a core"),
    "screen_bytes.py": ("calm 80x24", "demo 80x24", "load 80x24"),
    "motion_rate.py": ("robot process", "in the console's process", "bare loop"),
    "engagement_sample.py": ("bare queues", "the model, joint", "lines, fifo"),
    "report.py": ("json.loads on every line", "woz report --csv", "woz methods"),
    "pepper_faults.py": ("killed", "frozen", "cut", "late unforeseen"),
    "pepper_latency.py": ("idle: woz", "polling: woz"),
    "log_reading.py": ("LogIndex.open", "random seeks (ms)", "messages, without samples"),
    "finding.py": tuple(
        f"{way:<6}   3 of 3" for way in ("letter", "page", "phase", "finder", "words")
    ),
    "robot_latency.py": (
        "pepper: bare client",
        "nao: key to call",
        "reachy-mini: key",
        "furhat",
        "ros",
    ),
    "robot_faults.py": (
        "pepper: killed",
        "nao: frozen",
        "reachy-mini: cut",
        "furhat: cut",
        "ros: cut",
    ),
    "ros_latency.py": ("ROS 1", "ROS 2"),
    "five_robots.py": ("robot process", "simulated nao", "simulated furhat", "console"),
    "live_sound.py": ("heard: microphone", "spoken: standard input", "stop beside live sound"),
    "voices.py": ("the player alone", "espeak-ng: prepared", "espeak-ng: typed"),
    "bridge_timing.py": ("a message there and back", "start", "stroke", "end"),
    "round_trips.py": (
        "a socket of one's own",
        "client, blocking",
        "WebSocket with TLS",
        "Zenoh with TLS",
        "a stop, confirmed",
    ),
    "start_up.py": ("woz run, to first paint", "woz host, to its line", "woz_tui.console.app"),
}


if libqi.HERE:
    TABLES["pepper_latency.py"] += ("idle: Flask route", "bare qi")


#: Longer than all others together: `make test ARGS="-m benchmarks"` runs them, quickly, too.
LONG = {
    *("key_latency.py", "screen_bytes.py", "start_up.py", "stop_latency.py"),
    *("robot_latency.py", "robot_faults.py", "five_robots.py", "bridge_timing.py", "bml_timing.py"),
}
MARKS = dict.fromkeys(LONG, pytest.mark.benchmarks) | {"voices.py": pytest.mark.espeak}


@pytest.fixture
def environ() -> Iterator[dict[str, str]]:
    """A benchmark's environment. Nothing is left of what has it: robot processes, which have
    sessions of their own, would take the cores from all tests that follow.
    """
    mark, value = "WOZ_TESTED_BENCHMARK", uuid.uuid4().hex
    yield {**os.environ, "PYTHONPATH": "", mark: value}
    for process in psutil.process_iter():
        with contextlib.suppress(psutil.Error, OSError):
            if process.environ().get(mark) == value:
                process.kill()


@pytest.mark.timeout(300)
@pytest.mark.parametrize(
    "script",
    [pytest.param(name, marks=MARKS.get(name, ())) for name in TABLES],
)
def test_a_quick_run_prints_its_tables(script: str, environ: dict[str, str]) -> None:
    done = subprocess.run(
        [sys.executable, f"benchmarks/{script}", "--quick"],
        cwd=ROOT,
        env=environ,
        capture_output=True,
        text=True,
        timeout=280,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    for line in TABLES[script]:
        assert line in done.stdout
    assert f"{os.cpu_count()} cores" in done.stdout


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
