"""What reading a session back costs, beside plain `json.loads` of the same lines.

    python benchmarks/log_reading.py [--minutes 60] [--sensors 4] [--sessions 100] [--quick]

An hour with sensors at 100 Hz is written, then read in several ways, each in a process of its own
and in turns so that they meet the same machine: line by line with the `json` module, as lines and
as messages with the project's reader, and opened to seek in, without the index that lies beside the
samples (which then is made) and with it. Then the same for many sessions whose
samples are left aside. Memory is the peak of the process, less that of one that reads nothing.
"""

from __future__ import annotations

import argparse
import json
import random
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import msgspec

from benchmarks.figures import Spread, machine, table, verdict
from woz_tui.log.log_files import files_of
from woz_tui.log.log_index import LogIndex
from woz_tui.log.log_reader import messages, read
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m

#: Goals: an hour is open in a second, any moment of it is there in 50 ms, 100 sessions in 5 s.
OPEN_S, SEEK_MS, SESSIONS_S = 1.0, 50.0, 5.0
RATE_HZ = 100
TS = "2026-03-01T10:00:00.000000Z"
SENSORS = (
    m.Reading(sensor="distance", value=1.0, driver="belly", unit="m"),
    m.Reading(sensor="loudness", value=0.1, driver="microphone"),
    m.Reading(sensor="joint.pitch", value=1.0, driver="head", unit="deg"),
    m.Reading(sensor="setpoint.pitch", value=1.0, driver="head", unit="deg"),
    m.Reading(sensor="joint.yaw", value=1.0, driver="head", unit="deg"),
    m.Reading(sensor="setpoint.yaw", value=1.0, driver="head", unit="deg"),
)


class _Writer:
    """Numbers messages and puts them into the session's two files."""

    def __init__(self, actions: BinaryIO, samples: BinaryIO) -> None:
        self._actions, self._samples = actions, samples
        self.seq = 0

    def say(self, t: int, message: m.Message) -> None:
        sample = codec.is_sample(message)
        stamped = msgspec.structs.replace(message, seq=self.seq, t=t, ts="" if sample else TS)
        (self._samples if sample else self._actions).write(codec.encode(stamped))
        self.seq += 1


def write(folder: Path, minutes: float, sensors: int) -> Path:
    """A session: an action every four seconds, `sensors` at 100 Hz, the engagement model at 5."""
    path = folder / "2026-03-01T10-00-00_P07_S01.jsonl"
    chance = random.Random(1)
    with path.open("wb") as actions, path.with_suffix(".samples.jsonl").open("wb") as samples:
        writer = _Writer(actions, samples)
        for tick in range(round(minutes * 60 * RATE_HZ)):
            t = tick * 1_000_000 // RATE_HZ
            for sensor in SENSORS[:sensors]:
                value = round(chance.uniform(0, 3), 3)
                writer.say(t, msgspec.structs.replace(sensor, value=value, raw=value * 100))
            if tick % 20 == 0:
                writer.say(t, _shown(t))
            for message in _actions(tick):
                writer.say(t, message)
        writer.say(t, m.SessionEnd(reason="wizard", sha256="ab" * 32))
    return path


def _shown(t: int) -> m.EngagementShown:
    sign = m.SignShown(raw=1.0, verdict=1, count=8, needed=4, places=8, filter="fifo")
    return m.EngagementShown(
        state="Handshake",
        since=t,
        trail=["Handshake"],
        signs={"presence": sign, "gaze": sign, "distance": sign, "identity": sign},
        run="run",
        uses=["presence", "gaze"],
        social_distance=1.3,
        engaged=True,
    )


def _actions(tick: int) -> Iterator[m.Message]:
    second, rest = divmod(tick, RATE_HZ)
    if rest:
        return
    if second % 4 == 0:
        run, command = f"a{second:05}", f"c{second:05}"
        yield m.ActionRequested(run=run, action="Nod", panel="Gestures", source="key", key="n")
        args: dict[str, m.Json] = {"joints": {"pitch": 12.5}, "seconds": 0.5}
        yield m.Command(
            command=command, run=run, action="Nod", verb="pose", args=args, source="key"
        )
        yield m.Dispatched(command=command, driver="head", latency_us=223)
        yield m.Done(command=command, driver="head", sent=args, latency_us=223, duration_us=9)
        yield m.ActionDone(run=run, action="Nod")
    if second % 10 == 0:
        yield m.Checkpoint(sha256="ab" * 32, lines=tick)
    if second % 30 == 0:
        yield m.ClockTie(wall=TS)


# -- ways to read ---------------------------------------------------------------------------------


def _plain(paths: tuple[Path, ...]) -> int:
    count = 0
    for path in paths:
        with path.open("rb") as file:
            for line in file:
                json.loads(line)
                count += 1
    return count


def _opened(path: Path) -> int:
    with LogIndex.open(path, places=[]) as log:
        return len(log.actions)


def _opened_without_index(path: Path) -> int:
    for index in path.parent.glob("*.index"):
        index.unlink()
    return _opened(path)


def _count(items: Iterator[object]) -> int:
    return sum(1 for _ in items)


def _logs(folder: Path) -> list[Path]:
    return sorted(path for path in folder.glob("*.jsonl") if path.name.count(".") == 1)


def _each(way: Callable[[Path], int]) -> Callable[[Path], int]:
    return lambda folder: sum(map(way, _logs(folder)))


JSON, JSON_ACTIONS = "json.loads, every line", "json.loads, without samples"
SCAN, OPEN = "LogIndex.open without an index", "LogIndex.open"
MESSAGES_ACTIONS = "messages, without samples"
#: The first of each group is what the others are compared with.
WAYS: dict[str, Callable[[Path], int]] = {
    JSON: _each(lambda path: _plain(files_of(path, []).paths)),
    "read, every line": _each(lambda path: _count(read(path, places=[]))),
    "messages, every one": _each(lambda path: _count(messages(path, places=[], samples=True))),
    SCAN: _each(_opened_without_index),
    OPEN: _each(_opened),
    JSON_ACTIONS: _each(lambda path: _plain(files_of(path, [], samples=False).paths)),
    "read, without samples": _each(lambda path: _count(read(path, places=[], samples=False))),
    MESSAGES_ACTIONS: _each(lambda path: _count(messages(path, places=[]))),
}
NOTHING = "nothing"


def child(way: str, folder: Path) -> None:
    """Read `folder` once in this process and print what it cost."""
    begun, worked = time.perf_counter(), time.process_time()
    count = WAYS[way](folder) if way != NOTHING else 0
    took, worked = time.perf_counter() - begun, time.process_time() - worked
    print(count, took, worked, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000)


@dataclass(frozen=True)
class Cost:
    """Lines or messages that came, seconds, seconds of a processor, megabytes at the peak."""

    count: int
    took: float
    worked: float
    memory: float


def in_process(way: str, folder: Path) -> Cost:
    """One reading in a process of its own."""
    line = [sys.executable, __file__, "--child", way, str(folder)]
    done = subprocess.run(line, capture_output=True, text=True, check=True)
    count, took, worked, memory = done.stdout.split()
    return Cost(int(count), float(took), float(worked), float(memory))


def compared(
    title: str, folder: Path, ways: list[str], turns: int, goals: dict[str, float]
) -> None:
    """Read `folder` in each way, in turns, and print a table; the first way is the floor."""
    found: dict[str, list[Cost]] = {way: [] for way in ways}
    for _ in range(turns):
        for way in ways:
            found[way].append(in_process(way, folder))
    idle = in_process(NOTHING, folder).memory
    floor = statistics.median(run.worked for run in found[ways[0]])
    rows = []
    for way, runs in found.items():
        took = statistics.median(run.took for run in runs)
        worked = statistics.median(run.worked for run in runs)
        goal = goals.get(way)
        rows.append(
            [
                way,
                f"{took:.2f}",
                f"{worked:.2f}",
                f"{worked / floor:.2f} x",
                f"{runs[0].count:,}",
                f"{max(run.memory for run in runs) - idle:.0f}",
                f"< {goal:g} s {verdict(took, goal)}" if goal else "",
            ]
        )
    head = ["", "seconds", "processor", "/ json.loads", "given", "MB", "goal"]
    table(title, head, rows)


def seeks(path: Path, count: int) -> None:
    """Go to random moments and print how long each way took."""
    chance = random.Random(2)
    took: dict[str, list[float]] = {"the state of a moment": [], "and the 50 ms after it": []}
    with LogIndex.open(path, places=[]) as log:
        for _ in range(count):
            t_us = chance.randrange(log.length_us)
            begun = time.perf_counter()
            log.at(t_us)
            there = time.perf_counter()
            sum(1 for _ in log.between(t_us, t_us + 50_000))
            took["the state of a moment"].append(1000 * (there - begun))
            took["and the 50 ms after it"].append(1000 * (time.perf_counter() - there))
    rows = []
    for name, values in took.items():
        spread = Spread.of(values)
        figures = [f"{value:.2f}" for value in (spread.p50, spread.p99, spread.worst)]
        rows.append([name, *figures, verdict(spread.worst, SEEK_MS)])
    head = [f"{count} random seeks (ms)", "p50", "p99", "worst", f"< {SEEK_MS:g}"]
    table("LogIndex.at, LogIndex.between", head, rows)


def many(path: Path, folder: Path, sessions: int) -> None:
    """Copies of the session's actions under other names."""
    for number in range(sessions):
        shutil.copy(path, folder / f"2026-03-01T10-00-00_P{number:03}_S{number:03}.jsonl")


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=60)
    parser.add_argument("--sensors", type=int, default=4, choices=range(1, len(SENSORS) + 1))
    parser.add_argument("--sessions", type=int, default=100)
    parser.add_argument("--turns", type=int, default=3)
    parser.add_argument("--quick", action="store_true", help="a minute: does it run at all?")
    parser.add_argument("--child", nargs=2, metavar=("WAY", "FOLDER"), help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.child:
        child(arguments.child[0], Path(arguments.child[1]))
        return
    if arguments.quick:
        arguments.minutes, arguments.sessions, arguments.turns = 1, 3, 1
    with tempfile.TemporaryDirectory() as name:
        one, all_of_them = Path(name, "one"), Path(name, "many")
        one.mkdir()
        all_of_them.mkdir()
        path = write(one, arguments.minutes, arguments.sensors)
        size = sum(each.stat().st_size for each in one.iterdir()) / 1e6
        what = f"{arguments.minutes:g} min, {arguments.sensors} sensors at {RATE_HZ} Hz"
        ways = list(WAYS)
        middle = ways.index(JSON_ACTIONS)
        compared(f"{what}, {size:.0f} MB", one, ways[:middle], arguments.turns, {OPEN: OPEN_S})
        seeks(path, 20 if arguments.quick else 1000)
        many(path, all_of_them, arguments.sessions)
        title = f"{arguments.sessions} such sessions, samples left aside"
        goals = {MESSAGES_ACTIONS: SESSIONS_S}
        compared(title, all_of_them, ways[middle:], arguments.turns, goals)
    print(machine())


if __name__ == "__main__":
    main()
