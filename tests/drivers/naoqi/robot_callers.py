"""A robot whose time the test moves, and callers of a robot by either library."""

from __future__ import annotations

import asyncio
import heapq
import itertools
import os
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from typing import Any, Protocol

from naoqi_simulator.robot import TICK_S
from qimessaging import NaoqiClient, RefusedError

from tests.fakes.naoqi import Robot, StandInHere

#: Real seconds for an answer.
WITHIN_S = 20.0


class HandTime:
    """Time of the robot that passes only when the test says so."""

    def __init__(self) -> None:
        self._now = 0.0
        self._order = itertools.count()
        self._sleepers: list[tuple[float, int, asyncio.Future[None]]] = []

    def now(self) -> float:
        return self._now

    async def sleep(self, seconds: float) -> None:
        waiting: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        due = self._now + max(0.0, seconds)
        heapq.heappush(self._sleepers, (due, next(self._order), waiting))
        await waiting

    async def advance(self, seconds: float) -> None:
        """Wake the sleepers in order, each at its time; all that can run runs in between."""
        end = self._now + seconds
        await settle()
        while self._sleepers and self._sleepers[0][0] <= end + 1e-9:
            due, _, waiting = heapq.heappop(self._sleepers)
            self._now = max(self._now, due)
            if not waiting.done():
                waiting.set_result(None)
                await settle()
        self._now = end


async def settle() -> None:
    """Let everything run that needs no more than the loop."""
    for _ in range(20):
        await asyncio.sleep(0)


class Caller(Protocol):
    """Who calls the robot's services over the wire."""

    async def __call__(self, name: str, *args: Any) -> Any:
        """Call `ALMotion.moveTo`. Raises Said with the robot's words."""
        ...


class RobotCallError(Exception):
    """What the robot said instead of a value."""


class SimulatedRobotRig:
    """One test's hold on a robot in its own loop: call, let time pass."""

    def __init__(self, robot: StandInHere, client: NaoqiClient, time: HandTime) -> None:
        self.robot, self.client, self.time = robot, client, time
        self.pepper = robot.pepper
        self._signals: list[Any] = []

    async def call(self, name: str, *args: Any) -> Any:
        """Call a method that needs no time of the robot."""
        service, _, method = name.partition(".")
        try:
            return await self.client.call(service, method, *args, within=WITHIN_S)
        except RefusedError as error:
            raise RobotCallError(str(error)) from None

    async def begin(self, name: str, *args: Any, kind: str = "") -> asyncio.Task[Any]:
        """Call a method that needs time; returns when what it does is going on."""
        task = asyncio.ensure_future(self.call(name, *args))
        before = len(self.pepper.world.going.of(kind))

        async def goes_on() -> bool:
            return len(self.pepper.world.going.of(kind)) > before or task.done()

        await self.robot.until(goes_on)
        return task

    async def done(self, task: asyncio.Task[Any]) -> Any:
        """The value of a call that must end now without any more time of the robot."""
        async with asyncio.timeout(WITHIN_S):
            return await task

    async def pending(self, task: asyncio.Task[Any]) -> bool:
        """Whether a call is still going on after a round trip of another one."""
        await self.call("ALSystem.robotName")
        return not task.done()

    async def pass_by(self, seconds: float) -> None:
        """Let time pass, the robot looks about meanwhile."""
        for _ in range(round(seconds / TICK_S)):
            await self.time.advance(TICK_S)
            self.pepper.tick()

    async def hear(self, service: str, signal: str) -> Callable[[int], Any]:
        """Listen; the result waits for so many signals and gives their values."""
        heard: list[tuple[Any, ...]] = []
        await self.client.listen(service, signal, lambda *values: heard.append(values))

        async def wait(number: int) -> list[tuple[Any, ...]]:
            async def enough() -> bool:
                return len(heard) >= number

            await self.robot.until(enough)
            return heard

        return wait


async def own_caller(robot: Robot) -> tuple[Caller, NaoqiClient]:
    """Calls with our own client."""
    client = await NaoqiClient.open("127.0.0.1", int(robot.address.rpartition(":")[2]))

    async def call(name: str, *args: Any) -> Any:
        service, _, method = name.partition(".")
        try:
            return await client.call(service, method, *args, within=WITHIN_S)
        except RefusedError as error:
            raise RobotCallError(str(error)) from None

    return call, client


@asynccontextmanager
async def qi_session(address: str) -> AsyncIterator[Any]:
    """A session of the package qi."""
    os.environ.setdefault("QI_LOG_LEVEL", "0")
    import qi  # noqa: PLC0415 - not installed everywhere

    session: Any = qi.Session()
    await asyncio.to_thread(session.connect, address)
    try:
        yield session
    finally:
        await asyncio.to_thread(session.close)


def qi_caller(session: Any) -> Caller:
    """Calls with the package qi."""

    async def call(name: str, *args: Any) -> Any:
        service, _, method = name.partition(".")

        def ask() -> Any:
            return session.service(service).call(method, *args)

        try:
            async with asyncio.timeout(WITHIN_S):
                return await asyncio.to_thread(ask)
        except RuntimeError as error:
            raise RobotCallError(str(error)) from None

    return call
