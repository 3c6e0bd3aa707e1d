"""Opening a connection: TCP, TLS where it is wanted, and getting in."""

from __future__ import annotations

import asyncio
import socket
import ssl
from collections.abc import Callable
from dataclasses import dataclass

from qimessaging.connection import Connection, Incoming
from qimessaging.endpoints import Endpoint
from qimessaging.errors import ConnectionLost, QiError, TimedOut
from qimessaging.frames import LONGEST
from qimessaging.handshake import enter


@dataclass(slots=True)
class WayIn:
    """How to open connections to one robot.

    Attributes:
        tls: For addresses that begin with `tcps`; None where they cannot be used.
        user: The name to log in with; empty without login.
        token: The password, or what the robot has given instead at the first login.
        incoming: Takes the calls which the other end makes to services of ours.
        longest: The longest message accepted, in bytes.
        objection: What the robot said against our greeting, last time.
        prepare: Called with the socket of each connection once we are let in.
    """

    tls: ssl.SSLContext | None = None
    user: str = ""
    token: str = ""
    incoming: Incoming | None = None
    longest: int = LONGEST
    objection: str = ""
    prepare: Callable[[socket.socket], None] | None = None

    async def connect(self, endpoint: Endpoint, within: float) -> Connection:
        """Open a connection and log in.

        Raises:
            ConnectionLost: Nobody listens there, or TLS does not come about.
            TimedOut: Nothing came within that many seconds.
            LoginError: We are not let in.
            ProtocolError: Something else than qi messaging listens there.
        """
        try:
            async with asyncio.timeout(within):
                connection = await self._connect(endpoint)
                return await self._enter(connection, within)
        except TimeoutError:
            raise TimedOut(f"{endpoint} does not answer within {within:g} s") from None

    async def _connect(self, endpoint: Endpoint) -> Connection:
        loop = asyncio.get_running_loop()
        try:
            _, connection = await loop.create_connection(
                lambda: Connection(self.incoming, self.longest),
                endpoint.host,
                endpoint.port,
                ssl=self.tls if endpoint.tls else None,
            )
        except ssl.SSLError as error:
            raise ConnectionLost(f"no TLS with {endpoint}: {error.reason or error}") from error
        except OSError as error:
            raise ConnectionLost(f"cannot connect to {endpoint}: {_told(error)}") from error
        except ValueError as error:  # a name that no machine can have; UnicodeError is one, too
            raise ConnectionLost(f"cannot connect to {endpoint.host!r}: {error}") from error
        return connection

    async def _enter(self, connection: Connection, within: float) -> Connection:
        try:
            entered = await enter(connection, self.user, self.token, within)
        except QiError as error:
            connection.end(str(error))
            raise
        except BaseException:
            connection.end("opening the connection was given up")
            raise
        self.token, self.objection = entered.token, entered.objection
        if self.prepare is not None and not connection.lost.done():
            self.prepare(connection.socket)
        return connection


def _told(error: OSError) -> str:
    return error.strerror or str(error) or type(error).__name__
