"""How long a wizard does not know that a robot is gone, and how soon it is back, for each robot.

    python benchmarks/robot_faults.py [--faults 50] [--away 2.5] [--robots furhat] [--quick]

Each simulated robot is a process of its own behind a network that can be cut. Its driver makes
fifty calls a second while one utterance of minutes is under way. Then, in turns,

* it is killed, and another one is started;
* it is frozen (SIGSTOP), and goes on after a while;
* its cable is cut (nothing passes, nobody is told) and plugged in again after a while.

Known: from the fault until the driver says that the robot is lost, and every call has ended. Back:
from its recovery until it is connected again. Late: calls that the robot took after they had been
told as failed. `pepper_faults.py` measures the same at the connection of a Pepper.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import random
import signal
import sys
import tempfile
import time
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from pathlib import Path

from benchmarks.figures import Spread, machine, table, verdict
from benchmarks.tested_robots import ROBOTS, SimulatorProcess, TestedRobot
from tests.fakes.dropping_proxy import DroppingProxy, dropping_proxy
from woz_tui.config.loading import load_robot
from woz_tui.drivers.contract import Driver, DriverError, Health
from woz_tui.drivers.plugins import installed
from woz_tui.testing import PlainJob, RecordingContext

FAULTS = ("killed", "frozen", "cut")
GOAL_S = 2.0
#: Between two calls, and how long late ones are waited for, in seconds.
_GAP_S, _SETTLE_S = 0.02, 0.3
#: Longer than anything may take, in seconds.
_PATIENCE_S = 30.0


@dataclass
class Figures:
    """Of one kind of fault; seconds."""

    known: list[float] = field(default_factory=list)
    back: list[float] = field(default_factory=list)
    calls: int = 0
    failed: int = 0
    late: int = 0


@dataclass
class Player:
    """A driver, what it tells, and a caller that makes numbered calls all the time."""

    robot: TestedRobot
    driver: Driver
    context: RecordingContext
    #: When each call that failed was told, in nanoseconds, by its number.
    failed: dict[int, int] = field(default_factory=dict)
    calls: int = 0

    async def until(self, holds: Callable[[], bool]) -> None:
        """Wait; raises TimeoutError."""
        async with asyncio.timeout(_PATIENCE_S):
            while not holds():  # noqa: ASYNC110 - a benchmark
                await asyncio.sleep(0.002)

    def health(self) -> Health:
        """How the robot is."""
        return self.context.healths[-1][0] if self.context.healths else Health.CONNECTING

    async def call(self) -> None:
        """Fifty calls a second, one after the other, until it is cancelled."""
        while True:
            self.calls += 1
            number = self.calls
            try:
                await self.driver.perform(PlainJob(self.robot.verb, self.robot.args(number)))
            except DriverError:
                self.failed[number] = time.monotonic_ns()
            await asyncio.sleep(_GAP_S)

    async def speak(self) -> None:
        """The long command; a robot that is lost ends it."""
        verb, args = self.robot.long
        try:
            await self.driver.perform(PlainJob(verb, args, command="c2"))
        except DriverError:
            return


@asynccontextmanager
async def player(robot: TestedRobot, network: DroppingProxy) -> AsyncIterator[Player]:
    """A driver that is connected."""
    catalogue = installed()
    with tempfile.TemporaryDirectory() as folder:
        address = (
            network.address
            if "naoqi_simulator" in robot.simulator
            else (network.address.removeprefix("tcp://"))
        )
        file = Path(folder) / "robot.yaml"
        settings = {"type": robot.name, **robot.settings(address)}
        file.write_text(json.dumps({"drivers": {"robot": settings}}))
        (spec,) = load_robot(file, catalogue)
        context = RecordingContext(Path(folder))
        driver = catalogue[robot.name]("robot", spec.settings, context)
        made = Player(robot, driver, context)
        await driver.open()
        try:
            await made.until(lambda: made.health() is Health.CONNECTED)
            yield made
        finally:
            await driver.close()


async def measure(robot: TestedRobot, fault: str, away_s: float, figures: Figures) -> None:
    """One fault."""
    process = SimulatorProcess(robot)
    try:
        async with dropping_proxy(process.port) as network, player(robot, network) as it:
            speaking = asyncio.create_task(it.speak())
            calling = asyncio.create_task(it.call())
            await asyncio.sleep(random.uniform(0.3, 0.6))
            begun = time.monotonic()
            if fault == "killed":
                process.kill()
            elif fault == "frozen":
                process.send_signal(signal.SIGSTOP)
            else:
                network.cut()
            at = it.calls
            await it.until(lambda: it.health() is not Health.CONNECTED)
            await it.until(lambda: speaking.done() and it.calls > at + 1)
            figures.known.append(time.monotonic() - begun)
            await asyncio.sleep(max(0.0, away_s - (time.monotonic() - begun)))
            if fault == "killed":
                process = await asyncio.to_thread(SimulatorProcess, robot)
                network.retarget(process.port)
            elif fault == "frozen":
                process.send_signal(signal.SIGCONT)
            else:
                network.heal()
            recovered = time.monotonic()
            await it.until(lambda: it.health() is Health.CONNECTED)
            figures.back.append(time.monotonic() - recovered)
            await asyncio.sleep(_SETTLE_S)
            calling.cancel()
            await asyncio.gather(calling, return_exceptions=True)
            taken = await asyncio.to_thread(process.taken)
            figures.calls += it.calls
            figures.failed += len(it.failed)
            figures.late += sum(ns > it.failed.get(number, sys.maxsize) for number, ns in taken)
    finally:
        process.kill()


def row(robot: TestedRobot, fault: str, figures: Figures) -> list[str]:
    """One line of the table."""
    known, back = Spread.of(figures.known), Spread.of(figures.back)
    return [
        f"{robot.name}: {fault}",
        str(known.count),
        f"{known.p50 * 1000:.0f}",
        f"{known.worst * 1000:.0f}",
        f"{GOAL_S:g} s {verdict(known.worst, GOAL_S)}",
        f"{back.p50 * 1000:.0f}",
        f"{back.worst * 1000:.0f}",
        f"{figures.failed} of {figures.calls}",
        str(figures.late) if robot.unique else "-",
    ]


async def measured(robot: TestedRobot, faults: int, away_s: float) -> list[list[str]]:
    """All faults of one robot, in turns."""
    figures = {fault: Figures() for fault in FAULTS}
    for number in range(faults):
        fault = FAULTS[number % len(FAULTS)]
        await measure(robot, fault, away_s, figures[fault])
    return [row(robot, fault, found) for fault, found in figures.items() if found.known]


def main() -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument("--faults", type=int, default=50, help="of each robot")
    parser.add_argument("--away", type=float, default=2.5, help="seconds until it comes back")
    parser.add_argument("--robots", nargs="*", help="these alone")
    parser.add_argument("--quick", action="store_true", help="one of each fault")
    given = parser.parse_args()
    print(machine())
    faults, away_s = (len(FAULTS), 1.8) if given.quick else (given.faults, given.away)
    rows = []
    for robot in ROBOTS:
        if not given.robots or robot.name in given.robots:
            rows += asyncio.run(measured(robot, faults, away_s))
    head = ("", "faults", "known ms", "worst", "goal", "back ms", "worst", "calls failed", "late")
    table("robots that go and come back", head, rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
