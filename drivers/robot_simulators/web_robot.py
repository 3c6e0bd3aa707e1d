"""What simulated robots behind HTTP and WebSocket share: serving, faults to order, the program."""

from __future__ import annotations

import abc
import argparse
import asyncio
import contextlib
import json
import signal
import sys
from collections.abc import AsyncIterator, Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Self

from aiohttp import WSMsgType, web
from naoqi_simulator.robot_time import PacedTime, SimulatorTime
from naoqi_simulator.visitor import SimulatedVisitors


@dataclass(slots=True)
class WebFaults:
    """What goes wrong with a simulated robot, until it is set back.

    Attributes:
        refused: Requests, or messages, that are answered with an error: name to its text.
        delay_s: Every answer comes so much later, in seconds of the robot.
    """

    refused: dict[str, str] = field(default_factory=dict)
    delay_s: float = 0.0


class WebRobot(abc.ABC):
    """One simulated robot: `async with Robot() as robot: robot.address`.

    Attributes:
        time: The robot's time; a test gives one that it moves by hand.
        visitors: Who stands before it; None: nobody ever.
        calls: What clients asked for, in order: name and arguments.
        faults: What goes wrong now.
    """

    def __init__(
        self, time: SimulatorTime | None = None, visitors: SimulatedVisitors | None = None
    ) -> None:
        self.time = time or PacedTime()
        self.visitors = visitors
        self.calls: list[tuple[str, Any]] = []
        self.faults = WebFaults()
        self._awake = asyncio.Event()
        self._awake.set()
        self._runner: web.AppRunner | None = None
        self._port = 0
        self._host = "127.0.0.1"
        self._living: asyncio.Task[None] | None = None
        self._transports: set[asyncio.Transport] = set()
        self.sockets: set[web.WebSocketResponse] = set()

    @property
    def address(self) -> str:
        """`host:port` where it listens."""
        return f"{self._host}:{self._port}"

    @abc.abstractmethod
    def routes(self) -> Sequence[web.AbstractRouteDef]:
        """What it serves."""

    async def live(self) -> None:  # noqa: B027  # a robot need not do anything by itself
        """What it does by itself, until it is cancelled."""

    async def start(self, host: str = "127.0.0.1", port: int = 0) -> None:
        """Listen, on a free port if `port` is 0. Raises OSError when it cannot be had."""
        app = web.Application(middlewares=[self._faulty], client_max_size=1 << 26)
        app.add_routes(self.routes())
        self._runner = web.AppRunner(app, access_log=None, shutdown_timeout=0.1)
        await self._runner.setup()
        site = web.TCPSite(self._runner, host, port or self._port)
        await site.start()
        self._host, self._port = self._runner.addresses[0][:2]
        self._living = asyncio.create_task(self.live(), name=f"life of {type(self).__name__}")

    async def close(self) -> None:
        """Hang up on everybody and stop listening; `start` takes the same port again."""
        if self._living is not None:
            self._living.cancel()
            await asyncio.gather(self._living, return_exceptions=True)
            self._living = None
        self.drop()
        if self._runner is not None:
            await self._runner.cleanup()
            self._runner = None

    def drop(self) -> None:
        """Break all connections off; new ones are taken."""
        for transport in tuple(self._transports):
            transport.abort()

    def freeze(self) -> None:
        """Answer nothing any more, pings included; what comes is taken when it is thawed."""
        self._awake.clear()

    def thaw(self) -> None:
        self._awake.set()

    async def __aenter__(self) -> Self:
        """Start it on a free port."""
        await self.start()
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()

    # -- for subclasses --------------------------------------------------------------------------

    async def messages(self, request: web.Request) -> AsyncIterator[tuple[Any, Any]]:
        """Take a WebSocket, and give it with each decoded JSON message that comes."""
        opened = web.WebSocketResponse(autoping=False)
        await opened.prepare(request)
        self.sockets.add(opened)
        try:
            yield opened, None
            async for message in opened:
                await self._late()
                if message.type is WSMsgType.PING:
                    with contextlib.suppress(ConnectionError):
                        await opened.pong(message.data)
                elif message.type in (WSMsgType.TEXT, WSMsgType.BINARY):
                    yield opened, json.loads(message.data)
        finally:
            self.sockets.discard(opened)

    async def tell(self, opened: web.WebSocketResponse, message: Any) -> None:
        """Send a message as JSON; whoever is gone or hears nothing is left out."""
        if self._awake.is_set():
            with contextlib.suppress(ConnectionError):
                await opened.send_str(json.dumps(message))

    async def tell_all(self, message: Any) -> None:
        """Send a message to every open WebSocket."""
        for opened in tuple(self.sockets):
            await self.tell(opened, message)

    async def _late(self) -> None:
        if self.faults.delay_s:
            await self.time.sleep(self.faults.delay_s)
        await self._awake.wait()

    @web.middleware
    async def _faulty(self, request: web.Request, handler: Any) -> web.StreamResponse:
        transport = request.transport
        assert transport is not None
        self._transports.add(transport)
        try:
            await self._late()
            refusal = self.faults.refused.get(request.path)
            if refusal is not None:
                return web.json_response({"detail": refusal}, status=500)
            answer: web.StreamResponse = await handler(request)
            return answer
        finally:
            self._transports.discard(transport)


def run_as_program(
    name: str,
    make: Callable[[SimulatorTime, SimulatedVisitors | None], WebRobot],
    words: Sequence[str] | None = None,
) -> int:
    """Serve a robot until SIGTERM or SIGINT; the first line says where: `{"address": "..."}`.

    `words`: the command line without what the robot's module has read of it.
    """
    parser = argparse.ArgumentParser(
        prog=f"python -m robot_simulators.{name}", description=f"A simulated robot: {name}."
    )
    add = parser.add_argument
    add("--host", default="127.0.0.1", help="address to listen on (default: this machine only)")
    add("--port", type=int, default=0, help="port, 0: a free one")
    add("--pace", type=float, default=1.0, help="its time passes so many times as fast")
    add("--seed", type=int, default=7, help="which visitors come")
    add("--no-visitors", action="store_true", help="nobody ever comes")
    arguments = parser.parse_args(words)
    try:
        visitors = None if arguments.no_visitors else SimulatedVisitors(arguments.seed)
        robot = make(PacedTime(arguments.pace), visitors)
        asyncio.run(_serve(robot, arguments.host, arguments.port))
    except (OSError, ValueError) as error:
        sys.stderr.write(f"{error}\n")
        return 2
    return 0


async def _serve(robot: WebRobot, host: str, port: int) -> None:
    ended = asyncio.Event()
    for number in (signal.SIGTERM, signal.SIGINT):
        asyncio.get_running_loop().add_signal_handler(number, ended.set)
    await robot.start(host, port)
    sys.stdout.write(json.dumps({"address": robot.address}) + "\n")
    sys.stdout.flush()
    await ended.wait()
    await robot.close()
