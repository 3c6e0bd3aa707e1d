"""A network between a driver and its robot that can be cut, slow or broken: a TCP forwarder.

`cut` is a pulled cable: nothing passes in either direction, and nobody is told. What was sent lies
where it is, as in a sender's system, and arrives when the cable is plugged in again (`heal`),
unless its sender has thrown it away meanwhile by resetting the connection.
"""

from __future__ import annotations

import asyncio
import socket
import struct
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

_AT_ONCE = struct.pack("ii", 1, 0)
_PIECE = 1 << 16


class DroppingProxy:
    """Forwards to one port of this machine; begins whole."""

    def __init__(self, port: int) -> None:
        self.delay_s = 0.0
        self.to_robot = 0
        self._target = port
        self._whole = asyncio.Event()
        self._whole.set()
        self._listening = socket.create_server(("127.0.0.1", 0))
        self._listening.setblocking(False)
        self._joined: set[asyncio.Task[None]] = set()
        #: Connections of drivers on which the robot has said something.
        self._answered: set[socket.socket] = set()
        self._accepting = asyncio.create_task(self._accept())

    @property
    def address(self) -> str:
        """Where a driver finds the robot."""
        return f"tcp://127.0.0.1:{self._listening.getsockname()[1]}"

    @property
    def connections(self) -> int:
        """How many are open."""
        return len(self._joined)

    def cut(self) -> None:
        """Nothing passes from now on."""
        self._whole.clear()

    def heal(self) -> None:
        """Everything passes again, also what was held."""
        self._whole.set()

    def retarget(self, port: int) -> None:
        """Lead new connections to another port."""
        self._target = port

    def reset(self) -> None:
        """Break all connections, as a network does that forgot them."""
        for task in tuple(self._joined):
            task.cancel()

    async def close(self) -> None:
        """End everything."""
        tasks = [self._accepting, *self._joined]
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        self._listening.close()

    async def _accept(self) -> None:
        loop = asyncio.get_running_loop()
        while True:
            driver, _ = await loop.sock_accept(self._listening)
            task = asyncio.create_task(self._join(driver))
            self._joined.add(task)
            task.add_done_callback(self._joined.discard)

    async def _join(self, driver: socket.socket) -> None:
        """One connection from its beginning to its end."""
        loop = asyncio.get_running_loop()
        robot = socket.socket()
        robot.setblocking(False)
        ways: list[asyncio.Task[None]] = []
        try:
            await self._whole.wait()
            await loop.sock_connect(robot, ("127.0.0.1", self._target))
            ways.append(asyncio.create_task(self._forward(driver, robot, inward=True)))
            ways.append(asyncio.create_task(self._forward(robot, driver, inward=False)))
            await asyncio.wait(ways, return_when=asyncio.FIRST_EXCEPTION)
        except OSError:
            pass
        finally:
            for way in ways:
                way.cancel()
            await asyncio.gather(*ways, return_exceptions=True)
            driver.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, _AT_ONCE)
            driver.close()
            if driver in self._answered:
                # A robot hosted by libqi 3.1.5 accepts nobody any more once a connection that it
                # had not accepted yet was reset.
                robot.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, _AT_ONCE)
            robot.close()
            self._answered.discard(driver)

    async def _forward(self, one: socket.socket, other: socket.socket, *, inward: bool) -> None:
        """One direction, until its sender says goodbye. Raises `OSError` if either end is gone."""
        loop = asyncio.get_running_loop()
        while True:
            await _readable(one)
            if not self._whole.is_set():
                await self._whole.wait()
                if number := one.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR):
                    raise OSError(number, "the sender has thrown away what it had sent")
            data = one.recv(_PIECE)
            if not data:
                other.shutdown(socket.SHUT_WR)
                return
            if self.delay_s:
                await asyncio.sleep(self.delay_s)
            await loop.sock_sendall(other, data)
            if inward:
                self.to_robot += len(data)
            else:
                self._answered.add(other)


async def _readable(end: socket.socket) -> None:
    loop = asyncio.get_running_loop()
    ready = asyncio.Event()
    loop.add_reader(end.fileno(), ready.set)
    try:
        await ready.wait()
    finally:
        loop.remove_reader(end.fileno())


@asynccontextmanager
async def dropping_proxy(port: int) -> AsyncIterator[DroppingProxy]:
    """A network in front of a port of this machine."""
    proxy = DroppingProxy(port)
    try:
        yield proxy
    finally:
        await proxy.close()
