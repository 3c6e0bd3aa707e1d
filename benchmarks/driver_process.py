"""What a process of its own costs a driver: verb, stop, start and memory, beside the shared one.

    python benchmarks/driver_process.py [--calls 300] [--quick]

A session with its recorder, in turns with a driver in its own process and with the same driver in a
process of the driver's. From the call of the session (what a key does in the robot process) to the
driver's `perform` and to `stop`, and until the session knows of it; from opening the session to
the driver's word that it is connected; and memory of both processes (PSS).
"""

from __future__ import annotations

import argparse
import asyncio
import logging
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import psutil

from benchmarks.figures import Spread, machine, table
from benchmarks.timed_driver import Timed, TimedSettings
from woz_tui.config.experiment import (
    OWN_PROCESS,
    SHARED_PROCESS,
    Action,
    Call,
    DriverSpec,
    Experiment,
    Panel,
    ParallelCalls,
    SessionSettings,
)
from woz_tui.config.file_position import FilePosition
from woz_tui.gate.questions import RequestOrigin
from woz_tui.log.recorder import Recorder
from woz_tui.protocol import messages as m
from woz_tui.session.participant_identity import SessionIdentity
from woz_tui.session.session import Session
from woz_tui.system.clock import RealClock

HERE = FilePosition("made.yaml", 1, 1)
KEY = RequestOrigin("key", "w", "con1")
#: Pause between two calls, in seconds.
PAUSE_S = 0.01
#: What is measured, in milliseconds.
WAYS = ("verb: to perform", "verb: to its end", "stop: to stop", "stop: to its confirmation")


@dataclass
class Measured:
    """Of one kind of process."""

    took: dict[str, list[float]] = field(default_factory=lambda: {way: [] for way in WAYS})
    start_s: list[float] = field(default_factory=list)
    memory_mb: list[float] = field(default_factory=list)


class Measuring:
    """A session on a driver in one kind of process."""

    def __init__(self, folder: Path, process: str) -> None:
        wave = ParallelCalls((Call("wave", {}, "robot", HERE),))
        spec = DriverSpec(
            *("robot", "timed", TimedSettings(), Timed.offer(None), HERE),
            process=process,
        )
        made = Experiment(
            title="Benchmark",
            path=folder / "made.yaml",
            sha256="0" * 64,
            drivers=(spec,),
            panels=(Panel("P", (Action("Wave", "Wave", "w", "P", (wave,), HERE),), HERE),),
            session=SessionSettings(),
        )
        clock = RealClock()
        recorder = Recorder(folder / process, f"made{time.monotonic_ns()}", clock)
        who = SessionIdentity(session="S01")
        self.session = Session(made, {"timed": Timed}, who, recorder, clock)
        self.stopped_ns = 0.0
        self._awaited: tuple[type[m.Message], asyncio.Future[Any]] | None = None
        self.session.hub.listen(self._listen)

    def _listen(self, message: m.Message) -> None:
        if isinstance(message, m.Reading) and message.value is not None:
            self.stopped_ns = message.value
        if self._awaited is not None and isinstance(message, self._awaited[0]):
            came, self._awaited = self._awaited[1], None
            came.set_result((time.monotonic_ns(), message))

    def comes(self, kind: type[m.Message]) -> asyncio.Future[tuple[int, Any]]:
        """When the next one of this kind is published, and what it is."""
        self._awaited = kind, asyncio.get_running_loop().create_future()
        return self._awaited[1]


async def measure(folder: Path, process: str, calls: int, into: Measured) -> None:
    """One life of a session."""
    measuring = Measuring(folder, process)
    session, began = measuring.session, time.monotonic_ns()
    connected = measuring.comes(m.DriverConnected)
    await session.open()
    at, _ = await asyncio.wait_for(connected, 60)
    into.start_s.append((at - began) / 1e9)
    for _ in range(calls):
        ended, pressed = measuring.comes(m.Done), time.monotonic_ns()
        session.play("Wave", KEY)
        at, done = await asyncio.wait_for(ended, 10)
        into.took[WAYS[0]].append((done.sent["ns"] - pressed) / 1e6)
        into.took[WAYS[1]].append((at - pressed) / 1e6)
        await asyncio.sleep(PAUSE_S)
    for _ in range(calls):
        ended, pressed = measuring.comes(m.StopConfirmed), time.monotonic_ns()
        session.stop("escape")
        at, _ = await asyncio.wait_for(ended, 10)
        into.took[WAYS[2]].append((measuring.stopped_ns - pressed) / 1e6)
        into.took[WAYS[3]].append((at - pressed) / 1e6)
        session.release("escape")
        await asyncio.sleep(PAUSE_S)
    into.memory_mb.append(memory_mb())
    await session.close("measured")


def memory_mb() -> float:
    """Of this process and its children."""
    own = psutil.Process()
    return float(sum(each.memory_full_info().pss for each in (own, *own.children()))) / 1e6


def rows(shared: Measured, own: Measured) -> Sequence[Sequence[str]]:
    """Lines of the table."""
    told = []
    for way in WAYS:
        here, there = Spread.of(shared.took[way]), Spread.of(own.took[way])
        p50, p99 = there.over(here)
        told.append(
            (
                f"{way} (ms)",
                *(f"{here.p50:.2f}", f"{here.p99:.2f}"),
                *(f"{there.p50:.2f}", f"{there.p99:.2f}", f"{p50:.1f} x", f"{p99:.1f} x"),
            )
        )
    for name, here_s, there_s in (
        ("start (s)", shared.start_s, own.start_s),
        ("memory (MB)", shared.memory_mb, own.memory_mb),
    ):
        one, other = Spread.of(here_s), Spread.of(there_s)
        told.append(
            (
                name,
                *(f"{one.p50:.3g}", f"{one.worst:.3g}"),
                *(f"{other.p50:.3g}", f"{other.worst:.3g}"),
                *(f"{other.p50 / one.p50:.1f} x", f"{other.worst / one.worst:.1f} x"),
            )
        )
    return told


def main() -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--calls", type=int, default=100)
    parser.add_argument("--lives", type=int, default=5)
    parser.add_argument("--quick", action="store_true")
    arguments = parser.parse_args()
    calls, lives = (5, 1) if arguments.quick else (arguments.calls, arguments.lives)
    logging.disable(logging.WARNING)
    found: Mapping[str, Measured] = {SHARED_PROCESS: Measured(), OWN_PROCESS: Measured()}
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(lives):
            for process, into in found.items():
                asyncio.run(measure(Path(folder), process, calls, into))
    head = ("", "shared p50", "p99", "own p50", "p99", "ratio p50", "p99")
    table("a driver in the session's process and in one of its own", head,
          rows(found[SHARED_PROCESS], found[OWN_PROCESS]))  # fmt: skip
    print(machine())
    return 0


if __name__ == "__main__":
    sys.exit(main())
