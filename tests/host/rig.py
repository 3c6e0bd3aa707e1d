"""A served session on a real Unix socket, and clients that speak lines to it."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Self

from tests.session.rig import WAIT_S, SessionRig, experiment
from woz_tui.config.experiment import Experiment, SessionSettings
from woz_tui.drivers.contract import Driver
from woz_tui.host.request_handlers import RequestHandlers
from woz_tui.host.session_server import SessionServer
from woz_tui.log.disk import LogDisk
from woz_tui.protocol import messages as m
from woz_tui.session.typed_actions import Reader
from woz_tui.system.clock import RealClock
from woz_tui.system.session_sockets import bind


class Peer:
    """A program at the other end of the socket."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.reader = reader
        self.writer = writer
        self.seen: list[dict[str, Any]] = []

    async def say(self, **fields: Any) -> None:
        self.writer.write(json.dumps(fields).encode() + b"\n")
        await self.writer.drain()

    async def until(self, wanted: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
        """The first line that fits, among those not yet looked at."""

        async def look() -> dict[str, Any]:
            while True:
                line = await self.reader.readline()
                if not line:
                    raise EOFError(f"the host closed; seen {self.seen[-3:]}")
                message: dict[str, Any] = json.loads(line)
                self.seen.append(message)
                if wanted(message):
                    return message

        return await asyncio.wait_for(look(), WAIT_S)

    async def kind(self, kind: str) -> dict[str, Any]:
        return await self.until(lambda message: message["kind"] == kind)

    async def ask(self, kind: str, **fields: Any) -> dict[str, Any]:
        """Ask and return the reply."""
        ref = len(self.seen) + 1000
        await self.say(kind=kind, ref=ref, **fields)
        return await self.until(
            lambda message: message["kind"] == "reply" and message["ref"] == ref
        )

    async def hello(self, role: str = "program", **fields: Any) -> dict[str, Any]:
        await self.say(kind="hello", role=role, **fields)
        return await self.kind("welcome")

    def leave(self) -> None:
        self.writer.close()


class ServedSession(SessionRig):
    """A session, the host that serves it, and where to connect."""

    def __init__(
        self,
        folder: Path,
        path: Path,
        load: Callable[[], Experiment] | None,
        read: Reader | None,
        **session: Any,
    ) -> None:
        super().__init__(folder, rests=False, **session)
        self.path = path
        handlers = RequestHandlers(self.session, load or (lambda: self.experiment), read)
        self.host = SessionServer(self.session, path, handlers, pulse_s=0.05)
        self._peers: list[Peer] = []

    async def __aenter__(self) -> Self:
        await super().__aenter__()
        self.host.listen(bind(self.path))
        return self

    async def __aexit__(self, *failed: object) -> None:
        await super().__aexit__(*failed)
        await self.host.close()
        self.leave()

    async def connect(self) -> Peer:
        # Kept: from Python 3.13 on a connection that nobody holds any more closes by itself.
        peer = Peer(*await asyncio.open_unix_connection(str(self.path), limit=1 << 22))
        self._peers.append(peer)
        return peer

    def leave(self) -> None:
        """All peers go."""
        for peer in self._peers:
            peer.leave()

    async def published(self, wanted: Callable[[m.Message], bool]) -> m.Message:
        """Wait until a message that fits has been published."""
        await self.until(lambda: any(map(wanted, self.lines)))
        return next(filter(wanted, self.lines))


def served_session(
    tmp_path: Path,
    settings: SessionSettings | None = None,
    load: Callable[[], Experiment] | None = None,
    path: Path | None = None,
    made: Experiment | None = None,
    *,
    catalogue: Mapping[str, type[Driver]] | None = None,
    clock: RealClock | None = None,
    read: Reader | None = None,
    disk: LogDisk | None = None,
) -> ServedSession:
    """A host that serves until the block ends."""
    made = made or experiment(tmp_path)
    if load is None and read is None:  # nobody beats here, unless a test is about that
        settings = settings or replace(made.session, dead_man=60.0)
    made = replace(made, session=settings) if settings else made
    session = {"made": made, "catalogue": catalogue, "clock": clock or RealClock(), "disk": disk}
    return ServedSession(tmp_path, path or tmp_path / "s", load, read, **session)
