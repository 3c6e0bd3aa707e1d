"""Two machines and the network between them, which can be cut, frozen and slowed down."""

from __future__ import annotations

import asyncio
import contextlib
import tempfile
from collections.abc import AsyncIterator
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from tests.fakes.ports import free_port
from tests.host.rig import Peer, ServedSession, served_session
from tests.session.rig import WAIT_S
from woz_tui.config.experiment import AccessRole, SessionSettings
from woz_tui.network.certificates import AccessFile, Authority
from woz_tui.network.listen_address import ListenAddress
from woz_tui.remote.access_server import AccessServer
from woz_tui.remote.remote_session import RemoteSession, RemoteSessionError
from woz_tui.system.clock import RealClock

S = 1_000_000


class BootClock(RealClock):
    """All machines are as far as the test says."""

    def __init__(self) -> None:
        self.boot = 100 * S

    def boot_us(self) -> int:
        return self.boot


@dataclass
class Cable:
    """Carries bytes to `port` and back. While `frozen`, they wait; `delay` seconds each way."""

    port: int
    delay: float = 0.0
    flowing: asyncio.Event = field(default_factory=asyncio.Event)
    _ends: set[asyncio.StreamWriter] = field(default_factory=set)
    _server: asyncio.Server | None = None
    _tasks: set[asyncio.Task[None]] = field(default_factory=set)
    own_port: int = 0
    #: The longest piece that waits, on the way to `port` and on the way back, in bytes.
    held_there: int = 0
    held_back: int = 0

    async def lay(self) -> None:
        self.flowing.set()
        self.own_port = self.own_port or free_port()  # it comes back to it
        self._server = await asyncio.start_server(self._join, "127.0.0.1", self.own_port)

    async def cut(self) -> None:
        """Nothing comes through, and who is connected notices."""
        if self._server is not None:
            self._server.close()
        for end in tuple(self._ends):
            end.transport.abort()
        for task in tuple(self._tasks):
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)

    async def _join(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        try:
            others = await asyncio.open_connection("127.0.0.1", self.port)
        except OSError:
            writer.transport.abort()
            return
        self._ends |= {writer, others[1]}
        for source, target, there in ((reader, others[1], True), (others[0], writer, False)):
            task = asyncio.ensure_future(self._carry(source, target, there=there))
            self._tasks.add(task)
            task.add_done_callback(self._tasks.discard)

    async def _carry(
        self, source: asyncio.StreamReader, target: asyncio.StreamWriter, *, there: bool
    ) -> None:
        with contextlib.suppress(OSError):
            while data := await source.read(1 << 16):
                if not self.flowing.is_set():
                    self._hold(len(data), there=there)
                await self.flowing.wait()
                if self.delay:
                    await asyncio.sleep(self.delay)
                target.write(data)
                await target.drain()
            target.write_eof() if target.can_write_eof() else target.close()

    def _hold(self, size: int, *, there: bool) -> None:
        if there:
            self.held_there = max(self.held_there, size)
        else:
            self.held_back = max(self.held_back, size)


@dataclass
class Machines:
    """A robot's computer with a session, and the folder of another machine."""

    robot: ServedSession
    server: AccessServer
    authority: Authority
    cable: Cable
    folder: Path
    clock: RealClock

    @property
    def address(self) -> str:
        """Where the other machine finds the robot."""
        return f"127.0.0.1:{self.cable.own_port}"

    def access(self, name: str, role: AccessRole | None, days: int = 30) -> AccessFile:
        """A file for this name, which has that role."""
        file = self.folder / f"{name}.access"
        self.authority.new(name, days, "", file)
        self.server.adopt({**self.server.roles, **({name: role} if role else {})})
        return AccessFile.read(file)

    @contextlib.asynccontextmanager
    async def joined(
        self, access: AccessFile, clock: RealClock | None = None
    ) -> AsyncIterator[RemoteSession]:
        """The session, usable on the other machine, whose clock is that of all unless given."""
        remote = RemoteSession(access, self.address, clock or self.clock)
        running = asyncio.create_task(remote.run())
        try:
            yield remote
        finally:
            running.cancel()
            await asyncio.gather(running, return_exceptions=True)

    async def refusal(self, access: AccessFile) -> str:
        """Why somebody with this file does not get in."""
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(WAIT_S):
                remote = RemoteSession(access, self.address, self.clock)
                try:
                    await remote.connect_once()
                except RemoteSessionError as error:
                    return str(error)
        return ""


async def connected_peer(remote: RemoteSession) -> Peer:
    """A program on the other machine, as soon as the session can be used there."""
    async with asyncio.timeout(WAIT_S):
        return Peer(*await asyncio.open_unix_connection(await remote.usable(), limit=1 << 22))


@contextlib.asynccontextmanager
async def machines(tmp_path: Path, clock: RealClock | None = None) -> AsyncIterator[Machines]:
    """Both, until the block ends."""
    with tempfile.TemporaryDirectory() as run, pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_RUNTIME_DIR", run)  # a short path, and of this test alone
        async with _machines(tmp_path, clock or BootClock()) as made:
            yield made


@contextlib.asynccontextmanager
async def _machines(tmp_path: Path, clock: RealClock) -> AsyncIterator[Machines]:
    async with served_session(
        tmp_path, SessionSettings(), path=tmp_path / "S07.sock", clock=clock
    ) as robot:
        authority = Authority(tmp_path / "access")
        authority.new("first", 30, "", tmp_path / "first.access")
        server = AccessServer(robot.path, authority, clock)
        port = int((await server.listen(ListenAddress("127.0.0.1", 0))).rpartition(":")[2])
        cable = Cable(port)
        await cable.lay()
        try:
            yield Machines(robot, server, authority, cable, tmp_path, clock)
        finally:
            await cable.cut()
            await server.close()
