"""Registering a service of ours at a robot, which then calls it.

The robot's processes reach it in two ways. The one that holds the directory calls over the
connection which registered it. All others connect to an address of ours, so a service that is
for them has to listen.
"""

from __future__ import annotations

import asyncio
import contextlib
import os
import ssl
import uuid
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import Final

from qimessaging import authentication
from qimessaging.connection import CAPABILITIES, QiConnection
from qimessaging.decoding import decode
from qimessaging.directory import MACHINE
from qimessaging.encoding import encode
from qimessaging.endpoints import Endpoint, ServiceInfo
from qimessaging.errors import ConnectionLostError, ProtocolError, QiError, RefusedError
from qimessaging.frames import LONGEST, MessageKind, QiMessage
from qimessaging.hosted_objects import HostedObject
from qimessaging.object_host import ObjectHost
from qimessaging.remote import RemoteObject
from qimessaging.signature import parse_members

_SESSION = str(uuid.uuid4())


@dataclass(frozen=True, slots=True)
class Registration:
    """A service of ours that is known at a robot's directory.

    Attributes:
        name: Its name there.
        service: Its number there.
        withdraw: Takes it back; never raises.
    """

    name: str
    service: int
    withdraw: Callable[[], Awaitable[None]]


def describe(name: str, endpoints: list[Endpoint], machine: str = MACHINE) -> ServiceInfo:
    """Return what a directory is told of a service of ours, which it will number."""
    addresses = tuple(map(str, endpoints))
    return ServiceInfo(name, 0, machine, os.getpid(), addresses, _SESSION, os.urandom(20))


async def register(
    directory: RemoteObject,
    host: ObjectHost,
    info: ServiceInfo,
    hosted: HostedObject,
    within: float,
) -> Registration:
    """Make a service known. Raises as `RemoteObject.call`."""
    methods = directory.meta.overloads("registerService")
    wanted = parse_members(methods[0].parameters) if len(methods) == 1 else ()
    if len(wanted) != 1:
        raise RefusedError("the directory takes no services as it should")
    # Directories from before libqi 1.8 know nothing of an identity.
    members = info.members()[: len(wanted[0].inner)]
    number = await directory.call("registerService", members, within=within)
    if not isinstance(number, int):
        raise ProtocolError("the directory gives a service no number")

    async def withdraw() -> None:
        host.remove(number)
        with contextlib.suppress(QiError):  # it is forgotten at the latest with the connection
            await directory.call("unregisterService", number, within=within)

    host.add(number, hosted)
    try:
        await directory.call("serviceReady", number, within=within)
    except BaseException:
        host.remove(number)
        raise
    return Registration(info.name, number, withdraw)


# -- listening: who comes in shows who they are, and may then call what `ObjectHost` offers
# --------------

#: Tells whether a name and a token are let in.
Authenticator = Callable[[str, str], bool]

_SERVER: Final = 0

#: Connections at once.
MOST: Final = 256


class ServiceListener:
    """Accepts connections for one host, on as many addresses as wanted."""

    def __init__(
        self,
        host: ObjectHost,
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
        self._entered: set[QiConnection] = set()
        self._connections: dict[QiConnection, None] = {}
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

    def _accept(self) -> QiConnection:
        connection = QiConnection(self._incoming, self._longest)
        self._connections[connection] = None
        if len(self._connections) > self._most:
            silent = (each for each in self._connections if each not in self._entered)
            over = next(silent)
            del self._connections[over]
            over.end("too many connections")
        connection.when_lost(self._forget)
        return connection

    def _forget(self, connection: QiConnection) -> None:
        self._connections.pop(connection, None)
        self._entered.discard(connection)

    def _incoming(self, connection: QiConnection, frame: QiMessage) -> None:
        with contextlib.suppress(ConnectionLostError):
            if frame.service == _SERVER:
                self._greet(connection, frame)
            elif self._authenticator is None or connection in self._entered:
                self._host.handle(connection, frame)
            else:
                self._turn_away(connection, frame, "Expected authentication")

    def _greet(self, connection: QiConnection, frame: QiMessage) -> None:
        if frame.kind != MessageKind.CALL or frame.action != authentication.AUTHENTICATE:
            self._turn_away(connection, frame, "Expected authentication")
            return
        try:
            said = decode("{sm}", frame.payload)
        except ProtocolError as error:
            self._turn_away(connection, frame, f"Authentication failed: {error}")
            return
        connection.learn(said)
        if connection not in self._entered and self._authenticator is not None:
            user, token = said.get(authentication.USER, ""), said.get(authentication.TOKEN, "")
            if not self._authenticator(str(user), str(token)):
                self._turn_away(connection, frame, "Authentication failed: wrong name or token")
                return
        self._entered.add(connection)
        connection.send(frame.answer(MessageKind.REPLY, _welcome()))

    def _turn_away(self, connection: QiConnection, frame: QiMessage, text: str) -> None:
        """Answer with an error and hang up, as libqi does."""
        connection.send(frame.answer(MessageKind.ERROR, encode("m", text)))
        connection.hang_up(text)


def _welcome() -> bytes:
    """Return our capabilities and that the login is done; the state is an `I`, as libqi's."""
    parts = [encode("s", name) + encode("m", value) for name, value in CAPABILITIES.items()]
    parts.append(
        encode("s", authentication.STATE) + encode("s", "I") + encode("I", authentication.DONE)
    )
    return encode("I", len(parts)) + b"".join(parts)
