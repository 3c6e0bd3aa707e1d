"""From a key on the wizard's terminal to the first call that the robot has taken.

    python benchmarks/robot_latency.py [--presses 200] [--robots pepper furhat] [--quick]

Each simulated robot is a process of its own, which notes when it has taken a call. In turns a key
is pressed on the terminal of `woz run`, which goes through console, socket, log, bus and driver;
and a bare client in one loop makes the same call over a connection that stays open. The goal is the
console's share: at most 1.5 ms more than the bare client at p50, in the same run.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import json
import time
from collections.abc import AsyncIterator
from dataclasses import dataclass

from benchmarks.figures import Spread, machine, table, verdict
from benchmarks.sessions import KEYS, SETTLE_S, Entry, Gaps, Terminal, bench, matched, session
from benchmarks.tested_robots import ROBOTS, Send, TestedRobot, simulated

#: Milliseconds that a key may take more than a bare client's call, at p50.
GOAL_MS = 1.5
#: Numbers of the bare client's calls begin here; those of the keys are 1 to 26.
BARE = 1000


@dataclass(frozen=True)
class Measured:
    """One robot: a bare client and the console, milliseconds; presses that never came."""

    robot: str
    bare: Spread
    console: Spread
    lost: int


@contextlib.asynccontextmanager
async def console(robot: TestedRobot, address: str, settle: float) -> AsyncIterator[Terminal]:
    """`woz run` with one numbered action on each letter."""
    settings = json.dumps({"type": robot.name, **robot.settings(address)})
    actions = "\n".join(
        f'      - {{key: {key}, label: "Action {key.upper()}",'
        f" {robot.verb}: {json.dumps(robot.args(index))}}}"
        for index, key in enumerate(KEYS, 1)
    )
    with bench() as it:
        file = it.written(f"  drivers:\n    robot: {settings}\n", actions)
        with session(it, it.run_command(file), settle) as terminal:
            yield terminal


async def measure(robot: TestedRobot, presses: int, settle: float) -> Measured:
    """Keys and bare calls in turns."""
    gaps = Gaps()
    pressed: list[Entry] = []
    called: dict[int, int] = {}
    with simulated(robot) as process:
        async with (
            robot.client(process.address) as send,
            console(robot, process.address, settle) as terminal,
        ):
            for turn in range(presses):
                key = turn % len(KEYS)
                pressed.append(Entry(terminal.press(KEYS[key].encode()), str(key + 1)))
                gaps.rest()
                called[BARE + turn] = await _timed(send, BARE + turn)
                gaps.rest()
            taken = process.taken()
    took, lost = matched(pressed, [Entry(at, str(number)) for number, at in taken])
    arrived = dict(taken)
    bare = [(arrived[number] - at) / 1e6 for number, at in called.items() if number in arrived]
    return Measured(robot.name, Spread.of(bare), Spread.of(took), lost)


async def _timed(send: Send, number: int) -> int:
    at = time.monotonic_ns()
    await send(number)
    await asyncio.sleep(0)
    return at


def tell(measured: Measured) -> list[list[str]]:
    """The lines of one robot."""
    more = measured.console.p50 - measured.bare.p50
    tail = measured.console.p99 - measured.bare.p99
    return [
        [f"{measured.robot}: bare client", *_figures(measured.bare), "", "", ""],
        [
            f"{measured.robot}: key to call",
            *_figures(measured.console),
            f"{more:.2f} {verdict(more, GOAL_MS)}",
            f"{tail:.2f}",
            str(measured.lost),
        ],
    ]


def _figures(spread: Spread) -> list[str]:
    return [str(spread.count), f"{spread.p50:.2f}", f"{spread.p99:.2f}", f"{spread.worst:.1f}"]


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument("--presses", type=int, default=200, help="of each robot")
    parser.add_argument("--robots", nargs="*", help="these alone")
    parser.add_argument("--quick", action="store_true", help="a few presses")
    given = parser.parse_args()
    presses, settle = (4, 0.5) if given.quick else (given.presses, SETTLE_S)
    rows = []
    for robot in ROBOTS:
        if not given.robots or robot.name in given.robots:
            rows += tell(asyncio.run(measure(robot, presses, settle)))
    table(
        f"Key to the robot's first call, ms (goal: at most {GOAL_MS:g} more at p50)",
        ("", "calls", "p50", "p99", "worst", "more at p50", "at p99", "lost"),
        rows,
    )
    print(f"\n{machine()}")


if __name__ == "__main__":
    main()
