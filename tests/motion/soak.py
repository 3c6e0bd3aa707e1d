"""Hours of random input in virtual time, with an eye on memory and on every tick.

    python -m tests.motion.soak --hours 8

One tick every 20 virtual milliseconds, two inputs a second, a quarter of them absurd; the table has
a line for each virtual hour (or tenth of the whole). It ends with 1 if anything is not as it must.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass

import psutil

from tests.motion.bodies import BODIES
from tests.motion.hostile import Hostile
from tests.motion.setpoint_watch import Watch
from woz_tui.drivers.contract import RejectedError
from woz_tui.motion.builtin_moves import BUILT_IN
from woz_tui.motion.engine import Engine
from woz_tui.motion.engine_io import Tick

DT = 0.02
#: Inputs a tick: two a second.
INPUTS = 0.04
#: Memory may grow by so much after the first part of a soak, in MiB.
MAY_GROW = 2.0


@dataclass(frozen=True)
class Part:
    """What a part of a soak was like; `slow_us` is the 99th percentile of the ticks' times."""

    hours: float
    ticks: int
    taken: int
    refused: int
    notices: int
    median_us: float
    slow_us: float
    longest_us: float
    memory_mib: float

    HEAD = "   hours     ticks    taken  refused  notices  median us   99% us   longest us      MiB"

    def __str__(self) -> str:
        return (
            f"{self.hours:8.2f} {self.ticks:9d} {self.taken:8d} {self.refused:8d}"
            f" {self.notices:8d} {self.median_us:10.1f} {self.slow_us:8.1f}"
            f" {self.longest_us:12.1f} {self.memory_mib:8.2f}"
        )


class Soak:
    """One body under random input."""

    def __init__(self, body: str, seed: int) -> None:
        shape = BODIES[body]
        self.engine = Engine(shape, BUILT_IN, seed=seed)
        self._hostile = Hostile(shape, f"soak {seed}")
        self._tick = self.engine.tick(0.0)
        self._watch = Watch(shape, self._tick)
        self._ticks = self._taken = self._refused = self._notices = 0

    def part(self, seconds: float) -> Part:
        """So many virtual seconds. Raises `AssertionError` at the first bad tick."""
        times = []
        for _ in range(round(seconds / DT)):
            self._disturb()
            begun = time.perf_counter()
            tick = self.engine.tick(self._tick.t + DT)
            times.append((time.perf_counter() - begun) * 1e6)
            self._look_at(tick)
        times.sort()
        return Part(
            self._ticks * DT / 3600,
            self._ticks,
            self._taken,
            self._refused,
            self._notices,
            times[len(times) // 2],
            times[int(len(times) * 0.99)],
            times[-1],
            psutil.Process().memory_info().rss / 2**20,
        )

    def _look_at(self, tick: Tick) -> None:
        self._watch.check(tick)
        self._tick = tick
        self._ticks += 1
        self._notices += len(tick.notices)

    def _disturb(self) -> None:
        hostile = self._hostile
        if hostile.often(INPUTS):
            try:
                self.engine.apply(*hostile.input())
                self._taken += 1
            except RejectedError:
                self._refused += 1
        if hostile.often(INPUTS):
            self.engine.see(hostile.seen())
        if hostile.often(INPUTS / 100):
            self.engine.freeze("soak")
        if hostile.often(INPUTS / 20):
            self.engine.resume()


def soak(hours: float, body: str, seed: int, tell: Callable[[str], object]) -> list[Part]:
    """`hours` of virtual time in parts of an hour, or tenths if it is shorter."""
    parts = []
    one = Soak(body, seed)
    count = max(10, round(hours))
    tell(Part.HEAD)
    for _ in range(count):
        parts.append(one.part(hours * 3600 / count))
        tell(str(parts[-1]))
    return parts


def grown(parts: list[Part]) -> float:
    """By how much memory has grown since the first fifth, in MiB."""
    return parts[-1].memory_mib - parts[max(0, len(parts) // 5 - 1)].memory_mib


def main() -> int:
    """Run a soak and say how it went."""
    parser = argparse.ArgumentParser(description="Soak test of a body's engine in virtual time.")
    parser.add_argument("--hours", type=float, default=8.0, help="virtual hours (8)")
    parser.add_argument("--body", choices=tuple(BODIES), default="eyepi")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()

    def tell(line: str) -> None:
        sys.stdout.write(f"{line}\n")
        sys.stdout.flush()

    parts = soak(arguments.hours, arguments.body, arguments.seed, tell)
    growth = grown(parts)
    tell(f"memory since the first fifth: {growth:+.2f} MiB (may grow by {MAY_GROW:g})")
    return int(growth > MAY_GROW)


if __name__ == "__main__":
    raise SystemExit(main())
