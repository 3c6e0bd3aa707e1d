"""From the byte of a key on the wizard's terminal to the driver.

    python benchmarks/key_latency.py [--presses 300] [--servo-presses 40] [--quick]

`woz run` on a pseudo-terminal; each press goes through console, socket, log and bus to the probe
driver, which notes when `perform` was called. In turns with it a bare asyncio program on a terminal
of its own is pressed: the floor; and two such programs, the first of which hands each key to the
second over a Unix socket: what two processes cost that do nothing else. Once with nothing else
going on, once in the worst load: six readings at 30 Hz and 300 log lines a second, all shown; once
crowded: a program that computes all the time on every core, as speech and cameras do. The log says
where a press spent its time; `host_functions.py` counts what it passes there. Then from the key to
the first setpoint on the wire of emulated servos; there the servo loop's 50 Hz set
the pace.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path

from benchmarks.figures import Spread, machine, table, verdict
from benchmarks.sessions import (
    KEYS,
    ROOT,
    SETTLE_S,
    Bench,
    Entry,
    Gaps,
    bench,
    entries,
    floor,
    matched,
    session,
)

#: Goals: times the floor of the same run, at p50 and at p99.
GOAL_P50, GOAL_P99 = 3.0, 5.0
#: Where others take every core: times the floor's p50, at p50 and at p99.
CROWDED_P50, CROWDED_P99 = 5.0, 25.0
#: Where a press spends its time, in order.
LEGS = (
    "console, socket, whether it may happen",
    "action requested to command requested",
    "to command dispatched",
    "to perform",
)
#: The servo loop's period, in milliseconds.
PERIOD_MS = 20.0
#: Goal position of the X series.
_GOAL_POSITION = 116
_SERVOS = """\
  drivers:
    head:
      type: dynamixel
      port: {port}
      torque: true
      joints:
        pan: {{id: 11, min: -90, max: 90, speed: 600}}
"""
_POSES = """\
      - {key: a, label: "Action A", pose: {pan: 30}, seconds: 0.3}
      - {key: b, label: "Action B", pose: {pan: -30}, seconds: 0.3}
"""


@dataclass(frozen=True)
class Measured:
    """One scene: one bare program, two of them, the console (milliseconds); presses lost."""

    name: str
    floor: Spread
    pair: Spread
    console: Spread
    lost: int
    crowded: bool = False
    #: Milliseconds of each leg of a press.
    legs: dict[str, Spread] = field(default_factory=dict)

    @property
    def ratios(self) -> tuple[float, float]:
        """Times the floor, at p50 and p99; crowded both of them times its p50."""
        if self.crowded:
            return self.console.p50 / self.floor.p50, self.console.p99 / self.floor.p50
        return self.console.over(self.floor)

    @property
    def goals(self) -> tuple[float, float]:
        """What the ratios may be at most."""
        return (CROWDED_P50, CROWDED_P99) if self.crowded else (GOAL_P50, GOAL_P99)


@contextlib.contextmanager
def crowd() -> Iterator[None]:
    """A program that computes all the time for every core."""
    busy = [
        subprocess.Popen([sys.executable, "-c", "while True: pass"])
        for _ in range(os.cpu_count() or 1)
    ]
    try:
        yield
    finally:
        for one in busy:
            one.kill()
            one.wait()


def scene(
    name: str, presses: int, settle: float, *, load: bool = False, crowded: bool = False
) -> Measured:
    """Press console, floor and pair in turns."""
    gaps = Gaps()
    pressed: tuple[list[Entry], ...] = ([], [], [])
    with (
        bench(load) as it,
        session(it, settle=settle) as console,
        floor(it) as (bare, journal),
        floor(it, through=1) as (pair, far_journal),
        crowd() if crowded else contextlib.nullcontext(),
    ):
        for number in range(presses):
            key = KEYS[number % len(KEYS)]
            whats = (f"perform {key}", key, key)
            for where, sent, what in zip((console, bare, pair), pressed, whats, strict=True):
                sent.append(Entry(where.press(key.encode()), what))
                gaps.rest()
        time.sleep(0.5)
        performed = entries(it.journal)
        took, lost = matched(pressed[0], performed)
        legs = by_leg(pressed[0], it.folder, performed)
        bottom, _ = matched(pressed[1], entries(journal))
        far, _ = matched(pressed[2], entries(far_journal))
    return Measured(name, Spread.of(bottom), Spread.of(far), Spread.of(took), lost, crowded, legs)


def by_leg(pressed: Sequence[Entry], folder: Path, performed: Sequence[Entry]) -> dict[str, Spread]:
    """Milliseconds of each leg: up to the first line in the log, then from line to line."""
    noted: dict[str, list[Entry]] = {
        "action.requested": [],
        "command.requested": [],
        "command.dispatched": [],
    }
    wall_ns = time.time_ns() - time.monotonic_ns()
    said: dict[str, str] = {}
    for log in (folder / "recordings").glob("*.jsonl"):
        for line in map(json.loads, log.read_text().splitlines()):
            if line["kind"] == "command.requested":
                said[line["command"]] = line["action"]
            if (found := noted.get(line["kind"])) is not None:
                at = datetime.fromisoformat(line["ts"]).timestamp() * 1e9
                action = line.get("action") or said[line["command"]]
                key = action.removeprefix("Action ").lower()
                found.append(Entry(round(at) - wall_ns, f"perform {key}"))
    stations = [pressed, *noted.values(), performed]
    return {
        name: Spread.of(matched(begin, end)[0])
        for name, begin, end in zip(LEGS, stations[:-1], stations[1:], strict=True)
    }


@contextlib.contextmanager
def servos(it: Bench) -> Iterator[Path]:
    """An emulated servo at `servos` in the bench's folder; gives its journal."""
    journal = it.folder / "wire"
    command = [sys.executable, "-m", "tests.fakes.servos", "--link", str(it.folder / "servos"),
               "--ids", "11", "--journal", str(journal)]  # fmt: skip
    process = subprocess.Popen(
        command, cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    try:
        assert process.stdout is not None
        if not process.stdout.readline().startswith("ready"):
            raise RuntimeError("the emulated servos did not start")
        yield journal
    finally:
        process.terminate()
        process.communicate()


def to_the_wire(presses: int, settle: float) -> tuple[list[float], int]:
    """Milliseconds from a key to the first new setpoint on the wire; and how many never came."""
    gaps = Gaps()
    pressed: list[int] = []
    with bench() as it, servos(it) as journal:
        file = it.written(_SERVOS.format(port=it.folder / "servos"), _POSES)
        with session(it, it.run_command(file), settle) as console:
            for number in range(presses):
                pressed.append(console.press(b"ab"[number % 2 :][:1]))
                gaps.rest(0.5, 0.6)
            written = _setpoints(journal)
    took = []
    for begun, end in zip(pressed, [*pressed[1:], sys.maxsize], strict=True):
        first = next((ns for ns in written if begun < ns < end), None)
        if first is not None:
            took.append((first - begun) / 1e6)
    return took, presses - len(took)


def _setpoints(journal: Path) -> list[int]:
    lines = map(json.loads, journal.read_text().splitlines())
    return [
        line["t_ns"]
        for line in lines
        if line["event"] == "write" and line["address"] == _GOAL_POSITION
    ]


def tell(measured: Measured) -> list[list[str]]:
    """The lines of one scene."""
    p50, p99 = measured.ratios
    goals = measured.goals
    found = [f"{p50:.1f} x  {verdict(p50, goals[0])}", f"{p99:.1f} x  {verdict(p99, goals[1])}"]
    return [
        [*_figures(f"{measured.name}: floor", measured.floor), "", "", ""],
        [*_figures(f"{measured.name}: two programs", measured.pair),
         *(f"{ratio:.1f} x" for ratio in measured.pair.over(measured.floor)), ""],
        [*_figures(f"{measured.name}: key to perform", measured.console), *found,
         str(measured.lost)],
    ]  # fmt: skip


def _figures(name: str, spread: Spread) -> list[str]:
    return [name, str(spread.count), f"{spread.p50:.2f}", f"{spread.p99:.2f}",
            f"{spread.worst:.1f}"]  # fmt: skip


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument("--presses", type=int, default=300, help="in each scene")
    parser.add_argument("--servo-presses", type=int, default=40)
    parser.add_argument("--quick", action="store_true", help="a few presses")
    arguments = parser.parse_args()
    settle = SETTLE_S
    if arguments.quick:
        arguments.presses, arguments.servo_presses, settle = 4, 2, 0.3
    scenes = [
        scene("idle", arguments.presses, settle),
        scene("load", arguments.presses, settle, load=True),
        scene("crowded", arguments.presses, settle, crowded=True),
    ]
    table(
        f"Key byte to the driver, ms (goals, times the floor: p50 <= {GOAL_P50:g}, "
        f"p99 <= {GOAL_P99:g}; crowded, times its p50: p50 <= {CROWDED_P50:g}, "
        f"p99 <= {CROWDED_P99:g})",
        ("", "presses", "p50", "p99", "worst", "p50 / floor", "p99 / floor", "lost"),
        [line for measured in scenes for line in tell(measured)],
    )
    table(
        "Where a press spends its time, ms",
        ("", "presses", "p50", "p99", "worst"),
        [
            _figures(f"{measured.name}: {leg}", spread)
            for measured in scenes
            for leg, spread in measured.legs.items()
        ],
    )
    took, lost = to_the_wire(arguments.servo_presses, max(1.0, settle))
    wire = Spread.of(took)
    table(
        f"Key byte to the first new setpoint on the servos' wire (one tick is {PERIOD_MS:g} ms)",
        ("", "presses", "p50", "p99", "worst", "p50", "lost"),
        [("50 Hz loop, ms", str(wire.count), f"{wire.p50:.1f}", f"{wire.p99:.1f}",
          f"{wire.worst:.1f}", f"{wire.p50 / PERIOD_MS:.1f} ticks", str(lost))],
    )  # fmt: skip
    print(f"\n{machine()}")


if __name__ == "__main__":
    main()
