"""Listening: connections come in, show who they are, and may then call what `Host` offers."""

from __future__ import annotations

import asyncio
import contextlib
import ssl
from collections.abc import Callable
from typing import Final

from qimessaging import handshake
from qimessaging.connection import CAPABILITIES, Connection
from qimessaging.decoding import decode
from qimessaging.encoding import encode
from qimessaging.endpoints import Endpoint
from qimessaging.errors import ConnectionLost, ProtocolError
from qimessaging.frames import LONGEST, Frame, Kind
from qimessaging.host import Host

#: Tells whether a name and a token are let in.
Authenticator = Callable[[str, str], bool]

_SERVER: Final = 0

#: Connections at once.
MOST: Final = 256


class Listener:
    """Accepts connections for one host, on as many addresses as wanted."""

    def __init__(
        self,
        host: Host,
        authenticator: Authenticator | None = None,
        longest: int = LONGEST,
        most: int = MOST,
    ) -> None:
        """Listen for nobody yet; without an authenticator everybody is let in.

        Of more than `most` connections the oldest that has not greeted has to go.
        """
        self._most = most
        self._host = host
        self._authenticator = authenticator
        self._longest = longest
        self._servers: list[asyncio.Server] = []
        self._entered: set[Connection] = set()
        self._connections: dict[Connection, None] = {}
        self.endpoints: list[Endpoint] = []

    async def listen(self, host: str, port: int, tls: ssl.SSLContext | None = None) -> Endpoint:
        """Listen on an address; port 0 takes a free one, which is returned.

        Raises:
            OSError: The address is taken or is none of this machine's.
        """
        loop = asyncio.get_running_loop()
        server = await loop.create_server(self._accept, host, port, ssl=tls)
        self._servers.append(server)
        endpoint = Endpoint(host, int(server.sockets[0].getsockname()[1]), tls is not None)
        self.endpoints.append(endpoint)
        return endpoint

    async def close(self) -> None:
        """Listen no more and end all connections."""
        for server in self._servers:
            server.close()
        for connection in tuple(self._connections):
            connection.end("closed")
        self._servers.clear()
        self.endpoints.clear()

    def _accept(self) -> Connection:
        connection = Connection(self._incoming, self._longest)
        self._connections[connection] = None
        if len(self._connections) > self._most:
            silent = (each for each in self._connections if each not in self._entered)
            over = next(silent)
            del self._connections[over]
            over.end("too many connections")
        connection.lost.add_done_callback(lambda _: self._forget(connection))
        return connection

    def _forget(self, connection: Connection) -> None:
        self._connections.pop(connection, None)
        self._entered.discard(connection)

    def _incoming(self, connection: Connection, frame: Frame) -> None:
        with contextlib.suppress(ConnectionLost):
            if frame.service == _SERVER:
                self._greet(connection, frame)
            elif self._authenticator is None or connection in self._entered:
                self._host.handle(connection, frame)
            else:
                self._turn_away(connection, frame, "Expected authentication")

    def _greet(self, connection: Connection, frame: Frame) -> None:
        if frame.kind != Kind.CALL or frame.action != handshake.AUTHENTICATE:
            self._turn_away(connection, frame, "Expected authentication")
            return
        try:
            said = decode("{sm}", frame.payload)
        except ProtocolError as error:
            self._turn_away(connection, frame, f"Authentication failed: {error}")
            return
        connection.learn(said)
        if connection not in self._entered and self._authenticator is not None:
            user, token = said.get(handshake.USER, ""), said.get(handshake.TOKEN, "")
            if not self._authenticator(str(user), str(token)):
                self._turn_away(connection, frame, "Authentication failed: wrong name or token")
                return
        self._entered.add(connection)
        connection.send(frame.answer(Kind.REPLY, _welcome()))

    def _turn_away(self, connection: Connection, frame: Frame, text: str) -> None:
        """Answer with an error and hang up, as libqi does."""
        connection.send(frame.answer(Kind.ERROR, encode("m", text)))
        connection.hang_up(text)


def _welcome() -> bytes:
    """Return our capabilities and that the login is done; the state is an `I`, as libqi's."""
    parts = [encode("s", name) + encode("m", value) for name, value in CAPABILITIES.items()]
    parts.append(encode("s", handshake.STATE) + encode("s", "I") + encode("I", handshake.DONE))
    return encode("I", len(parts)) + b"".join(parts)
