"""Many faults in a row with calls in flight: each call ends once, nothing hangs, nothing that
was told as failed runs later, and neither memory nor threads grow.
"""

from __future__ import annotations

import asyncio
import gc
import random
import time
from contextlib import AsyncExitStack
from pathlib import Path

import psutil
import pytest

from tests.drivers.pepper.connection_rig import (
    WITHIN_S,
    ConnectionRig,
    Outcome,
    is_lost,
    started_connection,
    threads_now,
)
from tests.fakes.dropping_proxy import DroppingProxy, dropping_proxy
from tests.fakes.naoqi import StandIn, stand_in

pytestmark = pytest.mark.real_clock

#: Connections that meet their faults at the same time, each with a network of its own.
STANDS = 4
FAULTS = 12
#: What a call of this test writes; its value says which one it is.
KEY = "Test/Random"
#: What is told as lost so soon after a line broke had perhaps arrived at the robot, which on a busy
#: machine enters it a while later.
BROKE_NS, ARRIVED_NS = 1_000_000_000, 5_000_000_000
#: Bytes that Python and libqi may keep from a hundred lost connections.
GROWTH = 30 << 20


class FaultyConnection:
    """A connection, its network, and numbered calls that go on all the time."""

    def __init__(self, number: int, rig: ConnectionRig, network: DroppingProxy, seed: int) -> None:
        self.number = number
        self.connection = rig
        self.network = network
        self.calls: list[asyncio.Task[Outcome]] = []
        self.resets_ns: list[int] = []
        self.dice = random.Random(seed)
        self._calling = asyncio.create_task(self._calls())

    async def _calls(self) -> None:
        while True:
            name = f"{self.number}:{len(self.calls)}"
            self.calls.append(self.connection.begin("ALMemory", "insertData", KEY, name))
            await asyncio.sleep(self.dice.uniform(0.002, 0.02))

    async def meets(self, faults: int) -> None:
        """Faults in a row, most of them too short to be told of."""
        for _ in range(faults):
            match self.dice.choices(("reset", "cut", "long cut", "slow"), (12, 8, 1, 4))[0]:
                case "reset":
                    self.resets_ns.append(time.monotonic_ns())
                    self.network.reset()
                case "cut":
                    self.network.cut()
                    await asyncio.sleep(self.dice.uniform(0.01, 0.15))
                    self.network.heal()
                case "long cut":
                    await self.connection.until(lambda: self.connection.connection.ready)
                    went = self.connection.went
                    self.network.cut()
                    await self.connection.until(lambda went=went: self.connection.went > went)  # type: ignore[misc]
                    # A busy system brings the driver's reset to the other end a moment later.
                    await asyncio.sleep(0.1)
                    self.network.heal()
                case "slow":
                    self.network.delay_s = self.dice.uniform(0.0, 0.03)
            await asyncio.sleep(self.dice.uniform(0.0, 0.1))
        self.network.delay_s = 0.0

    async def ended(self) -> list[Outcome]:
        """How all calls ended."""
        self._calling.cancel()
        async with asyncio.timeout(WITHIN_S):
            return list(await asyncio.gather(*self.calls))


@pytest.mark.usefixtures("unhurried_loss")
async def test_many_faults_in_a_row(tmp_path: Path) -> None:
    process = psutil.Process()
    # On our own server: one of libqi may accept nobody any more once a connection was reset that it
    # had not accepted yet, and then there is nothing to be shown of the driver.
    async with stand_in("own") as robot:
        await trouble(robot, tmp_path, faults=3)
        gc.collect()
        threads, memory = threads_now(), process.memory_info().rss
        lost = await trouble(robot, tmp_path, faults=FAULTS)
        assert lost > STANDS * FAULTS / 2, "the faults had no effect"
        gc.collect()
        assert process.memory_info().rss - memory < GROWTH
        async with asyncio.timeout(WITHIN_S):
            while threads_now() > threads:  # noqa: ASYNC110
                await asyncio.sleep(0.01)


async def trouble(robot: StandIn, folder: Path, faults: int) -> int:
    """That many faults for each of the connections; returns how many calls were lost."""
    await robot.clear()
    tasks = len(asyncio.all_tasks())
    async with asyncio.timeout(100), AsyncExitStack() as stack:
        troubled: list[FaultyConnection] = []
        for number in range(STANDS):
            network = await stack.enter_async_context(dropping_proxy(robot.port))
            rig = await stack.enter_async_context(started_connection(folder, network.address))
            await rig.until(lambda it=rig: it.came == 1)  # type: ignore[misc]
            troubled.append(FaultyConnection(number, rig, network, seed=faults * 10 + number))
        await asyncio.gather(*(one.meets(faults) for one in troubled))
        for one in troubled:
            await one.connection.until(lambda one=one: one.connection.connection.ready)  # type: ignore[misc]
        lost = await judged(robot, troubled)
    async with asyncio.timeout(WITHIN_S):
        while len(asyncio.all_tasks()) > tasks:  # noqa: ASYNC110
            await asyncio.sleep(0.01)
    return lost


async def judged(robot: StandIn, troubled: list[FaultyConnection]) -> int:
    """Compare with what the robot entered; returns how many calls were told as lost."""
    outcomes = [await one.ended() for one in troubled]
    entered: dict[str, int] = {}
    for call in await robot.trace("ALMemory.insertData"):
        if call.args[0] == KEY:
            assert call.args[1] not in entered, "a call was carried out twice"
            entered[call.args[1]] = call.at_ns
    for rig, ends in zip(troubled, outcomes, strict=True):
        for at, one in enumerate(ends):
            ran_ns = entered.get(f"{rig.number}:{at}", 0)
            assert one.ends == 1
            if one.error is None:
                assert one.begun_ns <= ran_ns <= one.ended_ns
                continue
            assert is_lost(one), one.error
            if not any(0 <= one.ended_ns - reset < BROKE_NS for reset in rig.resets_ns):
                assert ran_ns <= one.ended_ns, "it ran after it was told as failed"
            else:
                assert ran_ns <= one.ended_ns + ARRIVED_NS, "it ran long after the line broke"
    return sum(is_lost(one) for ends in outcomes for one in ends)
