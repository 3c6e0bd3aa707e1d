"""The port that strangers see: who has a certificate goes on to the line behind it.

Zenoh's own listener looks at one failed connection in 0.1 s and holds back all others meanwhile:
three hundred of them, which anybody can open, kept the robot's own computers out for half a minute.
Here each costs a descriptor and some kilobytes until it has failed, or others take its place.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import ssl
from collections.abc import Mapping
from pathlib import Path
from typing import Any

#: Connections without a certificate at the same time, and as many with one; one more takes the
#: place of the one of its kind that is silent for longest.
MOST = 128
#: How long one may be silent before it is closed, in seconds: a robot's computer speaks some times
#: in each second.
SILENT_S = 10.0
#: How many may wait until they are accepted.
_BACKLOG = 128
#: Bytes that are taken from a connection at once.
_PIECE = 1 << 16

log = logging.getLogger(__name__)


class FrontPort:
    """Listens, examines certificates, and hands on.

    Args:
        behind: Sockets of the lines, by the name of the computer that goes there; an empty name:
            everybody.
        context: For certificates; None: they are not asked for.
    """

    def __init__(self, behind: Mapping[str, Path], context: ssl.SSLContext | None) -> None:
        self.behind = behind
        self.context = context
        self._server: asyncio.Server | None = None
        self._looking: asyncio.Task[None] | None = None
        #: By when they spoke last, or came: the one that is silent for longest first.
        self._strangers: dict[_Outside, float] = {}
        self._known: dict[_Outside, float] = {}

    async def listen(self, host: str, port: int) -> None:
        """Begin. Raises `OSError`."""
        loop = asyncio.get_running_loop()
        self._server = await loop.create_server(
            lambda: _Outside(self), host or None, port, backlog=_BACKLOG
        )
        self._looking = loop.create_task(self._look())

    def close(self) -> None:
        if self._server is not None:
            self._server.close()
        if self._looking is not None:
            self._looking.cancel()
        for connection in (*self._strangers, *self._known):
            connection.end()

    def came(self, connection: _Outside) -> None:
        """One more, without a certificate so far."""
        self._take(self._strangers, connection)

    def spoke(self, connection: _Outside) -> None:
        """It has a certificate, and is not silent."""
        self._strangers.pop(connection, None)
        self._known.pop(connection, None)
        self._take(self._known, connection)

    def went(self, connection: _Outside) -> None:
        self._strangers.pop(connection, None)
        self._known.pop(connection, None)

    def _take(self, those: dict[_Outside, float], connection: _Outside) -> None:
        if len(those) >= MOST:
            self._end_oldest(those)
        those[connection] = asyncio.get_running_loop().time()

    def _end_oldest(self, those: dict[_Outside, float]) -> None:
        oldest = next(iter(those))
        del those[oldest]
        oldest.end()

    async def _look(self) -> None:
        while True:
            await asyncio.sleep(1.0)
            long_ago = asyncio.get_running_loop().time() - SILENT_S
            for those in (self._strangers, self._known):
                while those and next(iter(those.values())) < long_ago:
                    self._end_oldest(those)


class _Side(asyncio.Protocol):
    """One of two connections whose bytes go over to each other."""

    _transport: asyncio.Transport | None = None

    def read_on(self, on: bool) -> None:
        """Whether it may send more."""
        if self._transport is not None:
            if on:
                self._transport.resume_reading()
            else:
                self._transport.pause_reading()


class _Outside(_Side):
    """A connection of the network."""

    def __init__(self, port: FrontPort) -> None:
        self._port = port
        self._came, self._goes = ssl.MemoryBIO(), ssl.MemoryBIO()
        self._tls: ssl.SSLObject | None = None
        self._name: str | None = None
        self._inside: _Inside | None = None
        self._connecting: asyncio.Task[None] | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Wait until it speaks."""
        assert isinstance(transport, asyncio.Transport)
        self._transport = transport
        self._port.came(self)

    def data_received(self, data: bytes) -> None:
        """First its certificate is examined."""
        if self._port.context is None:
            self._go_on("", data)
            return
        if self._tls is None:
            self._tls = self._port.context.wrap_bio(self._came, self._goes, server_side=True)
        self._came.write(data)
        try:
            if self._name is None:
                self._tls.do_handshake()
                self._name = _common_name(self._tls)
            self._flush()
            if self._name in self._port.behind:
                while piece := self._tls.read(_PIECE):
                    self._go_on(self._name, piece)
            self.end()  # nobody is behind it, or the other side has ended it
        except ssl.SSLWantReadError:
            self._flush()
        except ssl.SSLError:
            self._flush()  # the alert that says why
            self.end()

    def _go_on(self, name: str, data: bytes) -> None:
        self._port.spoke(self)
        if self._inside is None:
            self._inside = _Inside(self)
            connect = self._connect(self._inside, self._port.behind[name])
            self._connecting = asyncio.get_running_loop().create_task(connect)
        self._inside.send(data)

    async def _connect(self, inside: _Inside, behind: Path) -> None:
        try:
            loop = asyncio.get_running_loop()
            await loop.create_unix_connection(lambda: inside, str(behind))
        except OSError as error:
            log.warning("a connection cannot be handed on: %s", error)
            self.end()

    def send(self, data: bytes) -> None:
        """To the network."""
        if self._tls is None:
            if self._transport is not None:
                self._transport.write(data)
            return
        with contextlib.suppress(ssl.SSLError):  # it has ended meanwhile
            self._tls.write(data)
        self._flush()

    def _flush(self) -> None:
        if self._transport is not None and self._goes.pending:
            self._transport.write(self._goes.read())

    def pause_writing(self) -> None:
        """The network takes no more for now."""
        if self._inside is not None:
            self._inside.read_on(False)

    def resume_writing(self) -> None:
        if self._inside is not None:
            self._inside.read_on(True)

    def connection_lost(self, exc: Exception | None) -> None:
        self._transport = None
        self._port.went(self)
        if self._inside is not None:
            self._inside.end()

    def end(self) -> None:
        if self._transport is not None:
            self._transport.close()


class _Inside(_Side):
    """The connection to the line that belongs to one of the network."""

    def __init__(self, outside: _Outside) -> None:
        self._outside = outside
        #: What has come before it was open.
        self._early = bytearray()
        self._ended = False

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """What has come meanwhile goes first."""
        assert isinstance(transport, asyncio.Transport)
        self._transport = transport
        transport.write(bytes(self._early))
        self._early.clear()
        if self._ended:
            transport.close()

    def send(self, data: bytes) -> None:
        """To the line."""
        if self._transport is None:
            self._early += data
        else:
            self._transport.write(data)

    def data_received(self, data: bytes) -> None:
        self._outside.send(data)

    def pause_writing(self) -> None:
        """The line takes no more for now."""
        self._outside.read_on(False)

    def resume_writing(self) -> None:
        self._outside.read_on(True)

    def connection_lost(self, exc: Exception | None) -> None:
        self._transport = None
        self._outside.end()

    def end(self) -> None:
        self._ended = True
        if self._transport is not None:
            self._transport.close()


def _common_name(tls: ssl.SSLObject) -> str:
    certificate: Any = tls.getpeercert() or {}
    subject = {key: value for group in certificate.get("subject", ()) for key, value in group}
    return str(subject.get("commonName", ""))
