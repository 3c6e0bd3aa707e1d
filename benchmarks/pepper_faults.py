"""How long a wizard does not know that a Pepper is gone, and what runs that was told as failed.

    python benchmarks/pepper_faults.py [--rounds 10] [--away 3] [--quick]

The simulated Pepper is a process of its own behind a network that can be cut. Fifty calls a second
go to it, and one utterance of some minutes is under way. Then, in turns,

* it is killed, and another one is started on its port;
* it is frozen (SIGSTOP), and goes on after a while;
* its cable is cut (nothing passes, nobody is told) and plugged in again after a while.

Known: from the fault until the wizard is told and every call has ended. Back: from its recovery
until calls are let through again, after all speech and motion were ended. Late: calls that the
robot entered after the wizard had been told that they had failed; of a frozen robot those which lay
in its own memory, since it had been heard less than 0.02 s before they were sent.
"""

from __future__ import annotations

import argparse
import asyncio
import random
import sys
import tempfile
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from pathlib import Path

from woz_drivers.naoqi_robot.line import FRESH_S

from benchmarks.figures import Spread, machine, table, verdict
from tests.drivers.pepper.connection_rig import ConnectionRig, Outcome, started_connection
from tests.fakes.dropping_proxy import DroppingProxy, dropping_proxy
from tests.fakes.naoqi import StandIn, stand_in

FAULTS = ("killed", "frozen", "cut")
GOAL_S = 2.0
_GAP_S = 0.02
_MARK = ("ALMemory", "insertData", "Benchmark/Mark")
#: How long late calls are waited for, in seconds.
_SETTLE_S = 0.3


@dataclass
class Figures:
    """Of one kind of fault; seconds."""

    known: list[float] = field(default_factory=list)
    back: list[float] = field(default_factory=list)
    calls: int = 0
    failed: int = 0
    late: int = 0
    unforeseen: int = 0


class Caller:
    """Makes numbered calls all the time, and remembers how each ended."""

    def __init__(self, it: ConnectionRig) -> None:
        self._it = it
        self._task = asyncio.create_task(self._calls())
        self.calls: list[asyncio.Task[Outcome]] = []

    async def _calls(self) -> None:
        while True:
            self.calls.append(self._it.begin(*_MARK, len(self.calls)))
            await asyncio.sleep(_GAP_S)

    async def end(self) -> list[Outcome]:
        """How all of them ended, by number."""
        self._task.cancel()
        return list(await asyncio.gather(*self.calls))


@asynccontextmanager
async def scene() -> AsyncIterator[tuple[StandIn, DroppingProxy, ConnectionRig]]:
    """A robot, the network before it, and a connection that stands."""
    with tempfile.TemporaryDirectory() as folder:
        async with (
            stand_in() as robot,
            dropping_proxy(robot.port) as network,
            started_connection(Path(folder), network.address) as it,
        ):
            await it.until(lambda: it.came == 1)
            yield robot, network, it


async def measure(fault: str, away_s: float, figures: Figures) -> None:
    """One fault."""
    async with scene() as (robot, network, it):
        saying = it.begin("ALTextToSpeech", "say", "word " * 1000, within=600)
        await robot.called("ALTextToSpeech.say")
        caller = Caller(it)
        await asyncio.sleep(random.uniform(0.3, 0.6))
        went, came, begun = it.went, it.came, time.monotonic()
        if fault == "killed":
            robot.kill()
        elif fault == "frozen":
            robot.freeze()
        else:
            network.cut()
        await saying
        await it.until(lambda: it.went > went)
        figures.known.append(time.monotonic() - begun)
        await asyncio.sleep(max(0.0, away_s - (time.monotonic() - begun)))
        if fault == "killed":
            async with stand_in() as other:
                network.retarget(other.port)
                await _come_back(it, other, caller, begun, figures, came=came)
        else:
            (robot.thaw if fault == "frozen" else network.heal)()
            await _come_back(it, robot, caller, begun, figures, came=came)


async def _come_back(
    it: ConnectionRig, robot: StandIn, caller: Caller, begun: float, figures: Figures, *, came: int
) -> None:
    recovered = time.monotonic()
    await it.until(lambda: it.came > came)
    figures.back.append(time.monotonic() - recovered)
    await asyncio.sleep(_SETTLE_S)
    outcomes = await caller.end()
    entered = {int(call.args[1]): call.at_ns for call in await robot.trace("ALMemory.insertData")}
    figures.calls += len(outcomes)
    for number, one in enumerate(outcomes):
        figures.failed += one.error is not None
        if one.error is not None and entered.get(number, 0) > one.ended_ns:
            figures.late += 1
            figures.unforeseen += one.begun_ns / 1e9 > begun + FRESH_S + _GAP_S


def row(fault: str, figures: Figures) -> list[str]:
    """One line of the table."""
    known, back = Spread.of(figures.known), Spread.of(figures.back)
    return [
        fault,
        str(known.count),
        f"{known.p50 * 1000:.0f}",
        f"{known.worst * 1000:.0f}",
        f"{GOAL_S:g} s {verdict(known.worst, GOAL_S)}",
        f"{back.p50 * 1000:.0f}",
        f"{back.worst * 1000:.0f}",
        f"{figures.failed} of {figures.calls}",
        str(figures.late),
        str(figures.unforeseen),
    ]


async def measured(rounds: int, away_s: float, together: bool) -> list[list[str]]:
    """All faults, in turns or, for a quick look, together."""
    figures = {fault: Figures() for fault in FAULTS}
    measures = [measure(fault, away_s, figures[fault]) for _ in range(rounds) for fault in FAULTS]
    if together:
        await asyncio.gather(*measures)
    else:
        for one in measures:
            await one
    return [row(fault, figures[fault]) for fault in FAULTS]


def main() -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=10)
    parser.add_argument("--away", type=float, default=3.0, help="seconds until it comes back")
    parser.add_argument("--quick", action="store_true")
    given = parser.parse_args()
    print(machine())
    rounds, away_s = (1, 2.0) if given.quick else (given.rounds, given.away)
    head = ("", "faults", "known ms", "worst", "goal", "back ms", "worst", "calls failed")
    rows = asyncio.run(measured(rounds, away_s, given.quick))
    table("a Pepper that goes and comes back", (*head, "late", "late unforeseen"), rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
