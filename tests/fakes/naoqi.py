"""A simulated Pepper for tests: `async with stand_in() as robot`.

It runs in a process of its own, so that it can be killed and frozen like a real one. Orders go
through its standard input, not through the wire under test.
"""

from __future__ import annotations

import asyncio
import json
import os
import signal
import sys
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, suppress
from typing import Any, NamedTuple

from naoqi_simulator.robot import NaoqiSimulator
from naoqi_simulator.robot_time import PacedTime, SimulatorTime
from naoqi_simulator.service_table import CallRefusedError
from naoqi_simulator.simulator_process import carry_out, start
from naoqi_simulator.world import SimulatedWorld, SimulatorOptions

from tests.fakes import libqi

_PROGRAMS = {"own": "naoqi_simulator", "qi": "tests.fakes.naoqi_by_libqi"}
#: Real seconds for anything that should happen; a broken robot fails a test, it hangs none.
PATIENCE_S = 40.0


class Call(NamedTuple):
    """One method that the robot was asked to carry out."""

    service: str
    method: str
    args: list[Any]
    at_ns: int

    @property
    def name(self) -> str:
        """As `ALMotion.moveTo`."""
        return f"{self.service}.{self.method}"


class Robot:
    """The robot as its test sees it, wherever it runs."""

    address: str

    async def order(self, **order: Any) -> Any:
        """Carry out an order of `process.carry_out`. Raises AssertionError if it says no."""
        raise NotImplementedError

    @property
    def port(self) -> int:
        """Where it listens."""
        return int(self.address.rpartition(":")[2])

    async def trace(self, *names: str) -> list[Call]:
        """What it was asked to do, the oldest first: everything, or only `ALMotion.moveTo` ..."""
        entries = await self.order(do="trace")
        calls = [Call(one, two, json.loads(args), at) for one, two, args, at in entries]
        return [call for call in calls if not names or call.name in names]

    async def clear(self) -> None:
        """Forget the trace, end all faults."""
        await self.order(do="clear")

    async def get(self, name: str = "state") -> Any:
        """Something about it, `memory:KEY`, or everything."""
        return await self.order(do="get", name=name)

    async def set(self, name: str, value: Any) -> None:
        """Change something about it."""
        await self.order(do="set", name=name, value=value)

    async def person(self, who: Any) -> None:
        """Put somebody before it: fields of `visitor.Person`, None for nobody, "auto"."""
        await self.order(do="person", who=who)

    async def touch(self, x: float, y: float) -> None:
        """Touch its tablet, in shares of the screen."""
        await self.order(do="touch", x=x, y=y)

    async def fault(self, kind: str, seconds: float = 0.0) -> None:
        """Let something be wrong; see `python -m naoqi_simulator --help`."""
        await self.order(do="fault", kind=kind, seconds=seconds)

    async def until(self, holds: Callable[[], Any], patience: float = PATIENCE_S) -> Any:
        """Await `holds()` again and again until its result is true; return that."""
        async with asyncio.timeout(patience):
            while not (result := await holds()):  # noqa: ASYNC110 - it is another process
                await asyncio.sleep(0.01)
            return result

    async def called(self, name: str, times: int = 1) -> list[Call]:
        """Wait until a method was entered at least so often; all its calls."""

        async def enough() -> list[Call]:
            calls = await self.trace(name)
            return calls if len(calls) >= times else []

        found: list[Call] = await self.until(enough)
        return found


class StandIn(Robot):
    """A robot in a process of its own."""

    def __init__(self, process: asyncio.subprocess.Process, address: str) -> None:
        self._process = process
        self._turn = asyncio.Lock()
        self.address = address

    @property
    def pid(self) -> int:
        """Its process."""
        return self._process.pid

    def kill(self) -> None:
        """End it at once, without a goodbye."""
        self._signal(signal.SIGKILL)

    def freeze(self) -> None:
        """It goes on existing and does nothing. Returns when all its threads stand still.

        On a busy machine that takes a while: its library would still let somebody in.
        """
        self._signal(signal.SIGSTOP)
        with suppress(ChildProcessError):  # it has ended
            os.waitid(os.P_PID, self.pid, os.WSTOPPED | os.WEXITED | os.WNOWAIT)

    def thaw(self) -> None:
        """It goes on."""
        self._signal(signal.SIGCONT)

    def _signal(self, number: int) -> None:
        # Not by `Process.kill`: that may take the exit status away from asyncio, which complains.
        if self._process.returncode is None:
            with suppress(ProcessLookupError):
                os.kill(self.pid, number)

    async def order(self, **order: Any) -> Any:
        """By its standard input. Raises AssertionError if it says no, or is gone."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        async with self._turn, asyncio.timeout(PATIENCE_S):
            self._process.stdin.write(json.dumps(order).encode() + b"\n")
            await self._process.stdin.drain()
            line = await self._process.stdout.readline()
        if not line:
            raise AssertionError(f"the stand-in is gone: {self._process.returncode}")
        answer = json.loads(line)
        if "error" in answer:
            raise AssertionError(answer["error"])
        return answer["ok"]

    async def close(self) -> None:
        """End it, frozen or not."""
        self.thaw()
        self._signal(signal.SIGTERM)
        try:
            async with asyncio.timeout(3):
                await self._process.wait()
        except TimeoutError:
            self.kill()
            await self._process.wait()


@asynccontextmanager
async def stand_in(
    server: str = "qi" if libqi.HERE else "own",
    *,
    pace: float = 20.0,
    port: int = 0,
    visitors: bool = False,
    life: str = "solitary",
    options: tuple[str, ...] = (),
) -> AsyncIterator[StandIn]:
    """Start a robot, yield it when it listens, end it.

    `server`: its own, or libqi's, which shows that ours understands that.
    `pace`: how many times as fast its time passes. Without `visitors` nobody comes by, so that
    nobody stands in its way; `person` puts somebody there.
    """
    process = await asyncio.create_subprocess_exec(
        *(sys.executable, "-m", _PROGRAMS[server], "--control"),
        *("--pace", str(pace), "--port", str(port), "--life", life),
        *("--visitors", "seeded" if visitors else "none", *options),
        stdin=asyncio.subprocess.PIPE,
        stdout=asyncio.subprocess.PIPE,
        limit=1 << 24,
    )
    robot = StandIn(process, "")
    try:
        assert process.stdout is not None
        async with asyncio.timeout(PATIENCE_S):
            line = await process.stdout.readline()
        if not line:
            raise AssertionError("the stand-in ended before it listened; see its standard error")
        robot.address = json.loads(line)["address"]
        yield robot
    finally:
        await robot.close()


class StandInHere(Robot):
    """A robot in the test's own loop, on our own server; `pepper` is all of it."""

    def __init__(self, pepper: NaoqiSimulator) -> None:
        self.pepper = pepper

    async def order(self, **order: Any) -> Any:
        """Carried out at once. Raises AssertionError if it says no."""
        try:
            return carry_out(self.pepper.standin, order)
        except CallRefusedError as refused:
            raise AssertionError(str(refused)) from None


@asynccontextmanager
async def stand_in_here(
    time: SimulatorTime | None = None, options: SimulatorOptions | None = None
) -> AsyncIterator[StandInHere]:
    """As `stand_in`, without a process: it cannot be killed, but its time can be injected.

    What goes on by itself needs `robot.pepper.tick()`.
    """
    world = SimulatedWorld(time or PacedTime(20.0), options or SimulatorOptions(visitors=False))
    robot = StandInHere(NaoqiSimulator(world))
    host, robot.address = await start(robot.pepper)
    try:
        yield robot
    finally:
        await host.close()
