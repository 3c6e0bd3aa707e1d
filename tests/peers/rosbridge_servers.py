"""The real rosbridge servers with a robot's node behind them, on this machine."""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import signal
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

from tests.fakes.ports import free_port
from tests.peers.places import place

HERE = Path(__file__).parent
#: The server of ROS 1 takes an address only for its log, and listens everywhere: so it is told.
LOOPBACK_ONLY = """
import functools, runpy, sys
import autobahn.twisted.websocket as web
web.listenWS = functools.partial(web.listenWS, interface="127.0.0.1")
sys.argv = sys.argv[1:]
runpy.run_path(sys.argv[0], run_name="__main__")
"""
#: So long a server may take to start on a busy machine, in seconds.
_STARTS_S = 60.0


class RealRobot:
    """One version of ROS with rosbridge, rosapi and a node that plays a robot.

    Attributes:
        told: What the node got: lines of `ros1_node.py` and `ros2_node.py`.
    """

    def __init__(self, ros: int) -> None:
        self.ros = ros
        self.folder = place(f"rosbridge-ros{ros}")
        self.port = free_port()
        self.told: list[dict[str, Any]] = []
        self._python = "/usr/bin/python3" if ros == 1 else str(self.folder / "bin" / "python")
        self._environment = {
            **os.environ,
            "ROS_MASTER_URI": f"http://127.0.0.1:{free_port()}",
            # Every test has a domain of its own.
            "ROS_DOMAIN_ID": str(self.port % 100 + 1),
        }
        for name in ("PYTHONDONTWRITEBYTECODE", "VIRTUAL_ENV"):
            self._environment.pop(name, None)
        self._programs: dict[str, asyncio.subprocess.Process] = {}
        self._reading: list[asyncio.Task[None]] = []

    async def __aenter__(self) -> RealRobot:
        try:
            if self.ros == 1:
                port = self._environment["ROS_MASTER_URI"].rpartition(":")[2]
                await self._start("master", "/usr/bin/rosmaster", "--core", "-p", port)
                await _listening(int(port))
            await self._start("node", self._python, str(HERE / f"ros{self.ros}_node.py"))
            await self._start(
                "rosapi", self._python, str(self.folder / "suite/rosapi/scripts/rosapi_node")
            )
            await self.start_rosbridge()
            async with asyncio.timeout(_STARTS_S):
                while not self.of("ready"):  # noqa: ASYNC110 - a program's output sets no event
                    await asyncio.sleep(0.05)
            # A server of ROS 2 that has just started has not found the node yet.
            await asyncio.sleep(2.0 if self.ros == 2 else 0.0)
        except BaseException:
            await self.__aexit__()
            raise
        return self

    async def __aexit__(self, *_: object) -> None:
        for name in tuple(self._programs):
            await self.end(name)
        for task in self._reading:
            task.cancel()
        await asyncio.gather(*self._reading, return_exceptions=True)

    @property
    def address(self) -> str:
        """Where rosbridge listens."""
        return f"127.0.0.1:{self.port}"

    def of(self, what: str) -> list[dict[str, Any]]:
        """Lines of the node."""
        return [line for line in self.told if line["what"] == what]

    async def start_rosbridge(self) -> None:
        """Start the server, or start it again."""
        script = str(self.folder / "suite/rosbridge_server/scripts/rosbridge_websocket.py")
        words = ["-c", LOOPBACK_ONLY, script] if self.ros == 1 else [script]
        options = ("--address", "127.0.0.1", "--port", str(self.port))
        await self._start("rosbridge", self._python, *words, *options)
        await _listening(self.port)

    async def end(self, name: str, number: signal.Signals = signal.SIGKILL) -> None:
        """End a program with all that it started."""
        program = self._programs.pop(name)
        with contextlib.suppress(ProcessLookupError):
            os.killpg(program.pid, number)
        await program.wait()

    def send_signal(self, name: str, number: signal.Signals) -> None:
        """Stop a program's clock, or let it go on."""
        os.killpg(self._programs[name].pid, number)

    async def _start(self, name: str, *words: str) -> None:
        log = (self.folder / f"{name}.log").open("ab")
        with log:
            program = await asyncio.create_subprocess_exec(
                str(self.folder / "run"),
                *words,
                env=self._environment,
                stdin=asyncio.subprocess.DEVNULL,
                stdout=asyncio.subprocess.PIPE if name == "node" else log,
                stderr=log,
                start_new_session=True,
            )
        self._programs[name] = program
        if program.stdout is not None:
            self._reading.append(asyncio.create_task(self._read(program.stdout)))

    async def _read(self, output: asyncio.StreamReader) -> None:
        async for line in output:
            with contextlib.suppress(ValueError):
                self.told.append(json.loads(line))


async def _listening(port: int) -> None:
    async with asyncio.timeout(_STARTS_S):
        while True:
            try:
                _, writer = await asyncio.open_connection("127.0.0.1", port)
            except OSError:
                await asyncio.sleep(0.1)
            else:
                writer.close()
                return


@contextlib.asynccontextmanager
async def real_robot(ros: int) -> AsyncIterator[RealRobot]:
    """A robot with this version of ROS; skips the test if it cannot be had."""
    async with RealRobot(ros) as robot:
        yield robot
