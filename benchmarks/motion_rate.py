"""How punctual the body's 50 Hz are, beside the busiest console there is.

    python benchmarks/motion_rate.py [--minutes 10] [--quick]

A robot process with the five joints of experiments/robots/five-joints.yaml: its body breathes,
plays moves and follows what a camera claims to see, at 50 Hz, and five emulated servos follow it.
Beside it the worst load: six readings at 30 Hz and 300 log lines a second, all shown by an attached
console. In the same minutes the same engine ticks in a thread of that console's own process, which
is what two processes are for, and a bare 50 Hz loop runs in a process of its own: the floor.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import psutil

from benchmarks.figures import machine, table, verdict
from benchmarks.sessions import PROGRAMS, ROOT, SETTLE_S, Bench, Terminal, bench, woz

#: Goal: the robot process's ticks at p99, in milliseconds (8 h soak: under 5 ms).
GOAL_MS = 5.0
IDS = (21, 22, 23, 24, 25)
ROBOT = ROOT / "experiments" / "robots" / "five-joints.yaml"
#: What is pressed, one after the other, and how long it is watched in seconds.
SCENES = (("a", 8.0), ("b", 3.0), ("c", 8.0), ("d", 2.0), ("e", 3.0), ("f", 2.0))
ACTIONS = """\
      - {key: a, label: "Action A", play: dance, when_busy: replace}
      - {key: b, label: "Action B", play: nod, when_busy: replace}
      - {key: c, label: "Action C", mode: tracking}
      - {key: d, label: "Action D", mode: normal}
      - {key: e, label: "Action E", gaze: {yaw: 40, pitch: 5, seconds: 1}, emotion: happy}
      - {key: f, label: "Action F", home: 1, emotion: neutral}
"""
_NOTICE = re.compile(
    r"(?P<ticks>\d+) ticks, late by (?P<p50>[\d.]+) ms .*, (?P<p99>[\d.]+) ms \(99 %\),"
    r" (?P<worst>[\d.]+) ms \(the latest\); (?P<missed>\d+) left out"
)
#: Until the first line of a journal, in seconds.
_JOURNAL_S = 30.0


@dataclass(frozen=True)
class Punctual:
    """How late ticks were, in milliseconds."""

    name: str
    ticks: float
    p50: float
    p99: float
    worst: float
    missed: float

    def row(self, share: str = "") -> list[str]:
        """A line of the table."""
        figures = [f"{value:.2f}" for value in (self.p50, self.p99, self.worst)]
        return [self.name, f"{self.ticks:.0f}", *figures, f"{self.missed:.0f}", share]


def experiment(it: Bench) -> Path:
    """The five joints with servos, a camera and the busiest sensors."""
    names = re.findall(r"^      (\w+):  ", ROBOT.read_text(), re.MULTILINE)[: len(IDS)]
    body = ROBOT.read_text().partition("drivers:\n")[2]
    body = re.sub(r"^    moves: ", f"    moves: {ROBOT.parent}/", body, flags=re.MULTILINE)
    body = body.replace(
        "    type: body\n", "    type: body\n    servos: head\n    camera: eye\n", 1
    )
    joints = "".join(
        f"        {name}: {{id: {number}, min: -110, max: 110, speed: 300}}\n"
        for name, number in zip(names, IDS, strict=True)
    )
    drivers = "".join(f"  {line}" for line in f"drivers:\n{body}".splitlines(keepends=True))
    return it.written(
        f"{drivers}\n"
        f"    head:\n      type: dynamixel\n      follows: body\n"
        f"      port: {it.folder / 'servos'}\n      torque: true\n      joints:\n{joints}"
        f"    probe:\n      type: probe\n      journal: {it.journal}\n      load: true\n"
        "    eye: {type: probe-eye}\n",
        ACTIONS,
    )


@contextlib.contextmanager
def servos(it: Bench) -> Iterator[None]:
    """Five emulated servos at `servos` in the bench's folder."""
    command = [sys.executable, "-m", "tests.fakes.servos", "--link", str(it.folder / "servos"),
               "--ids", ",".join(map(str, IDS))]  # fmt: skip
    process = subprocess.Popen(
        command, cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    try:
        assert process.stdout is not None
        if not process.stdout.readline().startswith("ready"):
            raise RuntimeError("the emulated servos did not start")
        yield
    finally:
        process.terminate()
        process.communicate()


@contextlib.contextmanager
def robot(it: Bench, file: Path) -> Iterator[tuple[psutil.Popen, Path]]:
    """The robot process and its socket; it is ended in order, so that its log has an end."""
    process = psutil.Popen(
        woz("host", str(file), *it.options(), "--announce"), cwd=ROOT,
        env={**_environ(), **it.environ()}, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
    )  # fmt: skip
    try:
        yield process, Path(json.loads(process.stdout.readline())["socket"])
    finally:
        process.send_signal(signal.SIGTERM)
        try:
            process.wait(30)
        except psutil.TimeoutExpired:
            process.kill()
            process.wait()
        process.stdout.close()


def _environ() -> dict[str, str]:
    return dict(psutil.Process().environ())


@contextlib.contextmanager
def bare(journal: Path) -> Iterator[None]:
    """A 50 Hz loop that does nothing, in a process of its own."""
    process = subprocess.Popen([sys.executable, str(PROGRAMS / "ticking.py"), "bare", str(journal)])
    try:
        yield
    finally:
        process.kill()
        process.wait()


def measure(seconds: float, settle: float) -> tuple[list[Punctual], float]:
    """All three, and the share of a core that the robot process took."""
    with bench() as it:
        file = experiment(it)
        floor, beside = it.folder / "floor", it.folder / "beside"
        command = [sys.executable, str(PROGRAMS / "ticking.py"), "console", str(beside), str(file)]
        with (
            servos(it),
            robot(it, file) as (process, socket),
            Terminal([*command, str(socket)], it.environ()) as console,
            bare(floor),
        ):
            console.wait_for(b"probe: line")
            time.sleep(settle)
            share = _play(console, process, seconds)
            others = [_kept("in the console's process", beside), _kept("bare loop", floor)]
        return [_logged(it.folder / "recordings"), *others], share


def _play(console: Terminal, process: psutil.Popen, seconds: float) -> float:
    """Press keys for so long; the robot process's share of a core meanwhile."""
    before, begun = sum(process.cpu_times()[:2]), time.monotonic()
    while (left := begun + seconds - time.monotonic()) > 0:
        for key, watched in SCENES:
            console.press(key.encode())
            time.sleep(max(0.0, min(watched, left)))
            left = begun + seconds - time.monotonic()
    return float(sum(process.cpu_times()[:2]) - before) / (time.monotonic() - begun)


def _kept(name: str, journal: Path) -> Punctual:
    """What a process wrote last; on a busy machine its first second may not be over yet."""
    until = time.monotonic() + _JOURNAL_S
    while True:
        try:
            return Punctual(name, **json.loads(journal.read_text()))
        except (FileNotFoundError, json.JSONDecodeError):  # not there, or being written
            if time.monotonic() > until:
                raise
        time.sleep(0.05)


def _logged(recordings: Path) -> Punctual:
    """What the body said of its ticks when it was closed."""
    for log in recordings.rglob("*.jsonl"):
        found = _NOTICE.search(log.read_text())
        if found is not None:
            figures = {name: float(value) for name, value in found.groupdict().items()}
            return Punctual("robot process", **figures)
    raise RuntimeError("the body said nothing of its ticks")


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--quick", action="store_true", help="a few seconds")
    arguments = parser.parse_args()
    seconds, settle = arguments.minutes * 60, SETTLE_S
    if arguments.quick:
        seconds, settle = 2.0, 0.2
    found, share = measure(seconds, settle)
    met = verdict(found[0].p99, GOAL_MS)
    table(
        f"Lateness of 50 Hz ticks in {seconds:g} s, ms (goal, robot process: p99 <= {GOAL_MS:g})",
        ("", "ticks", "p50", "p99", "worst", "left out", ""),
        [one.row(met if index == 0 else "") for index, one in enumerate(found)],
    )
    print(f"\nThe robot process took {share:.0%} of a core.")
    print(machine())


if __name__ == "__main__":
    main()
