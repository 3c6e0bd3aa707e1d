"""The login: what a client sends first, and what the other end may answer.

libqi's client calls action 8 of service 0 with its capabilities, and with `auth_user` and
`auth_token` where it has them. A server of that time replies with its own capabilities and
`__qi_auth_state`: 1 refused, 2 go on (with a token to use from now on), 3 done. Servers from
before logins answer with an error, with a message of capabilities, or not at all; they let
everybody in.
"""

from __future__ import annotations

import asyncio
import contextlib
import socket
import ssl
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final

from qimessaging.connection import CAPABILITIES, Incoming, QiConnection
from qimessaging.decoding import ValueDecoder, decode
from qimessaging.encoding import encode
from qimessaging.endpoints import Endpoint
from qimessaging.errors import (
    CallTimeoutError,
    ConnectionLostError,
    LoginError,
    ProtocolError,
    QiError,
)
from qimessaging.frames import LONGEST, MessageKind, QiMessage

AUTHENTICATE: Final = 8
STATE: Final = "__qi_auth_state"
REASON: Final = "__qi_auth_err_reason"
USER: Final = "auth_user"
TOKEN: Final = "auth_token"
NEW_TOKEN: Final = "auth_newToken"
REFUSED, GO_ON, DONE = 1, 2, 3

#: How long a server of before logins is waited for, in seconds: those that do not know the call
#: may leave it without an answer.
_SILENCE: Final = 2.0


@dataclass(frozen=True, slots=True)
class Authenticated:
    """How it went.

    Attributes:
        token: What to come back with: the same, or a new one.
        objection: What the other end said against our greeting without hanging up so far: one
            of before logins does not know the call, one with logins is about to hang up.
    """

    token: str
    objection: str = ""


async def enter(connection: QiConnection, user: str, token: str, within: float) -> Authenticated:
    """Say who we are.

    Raises:
        LoginError: The other end does not let us in.
        CallTimeoutError: A name and a token were given, and no answer came.
        ConnectionLostError: It hung up.
        ProtocolError: What came is no answer to this.
    """
    silence = within if user or token else min(_SILENCE, within)
    answer = await _first(connection, _greeting(user, token), silence)
    if answer is None or answer.kind != MessageKind.REPLY:
        return _without_login(connection, answer, user, token)
    state, answer_fields = _read(connection, answer)
    if state == GO_ON:
        new_token = answer_fields.get(NEW_TOKEN)
        if not isinstance(new_token, str) or not new_token:
            raise LoginError("the robot wants another step of the login, which is not known here")
        token = new_token
        answer = await _call(connection, _greeting(user, token), within)
        if answer.kind != MessageKind.REPLY:
            raise LoginError(f"the robot refuses the login: {error_text(answer)}")
        state, answer_fields = _read(connection, answer)
    if state == GO_ON:
        raise LoginError("the robot wants a third step of the login, which is not known here")
    if state != DONE:
        reason = answer_fields.get(REASON) or "wrong name or password"
        raise LoginError(f"the robot refuses the login: {reason}")
    return Authenticated(token)


async def _first(
    connection: QiConnection, greeting: Mapping[str, Any], within: float
) -> QiMessage | None:
    """Return the answer to the greeting; None where capabilities came unasked, or nothing."""
    asking = asyncio.ensure_future(_call(connection, greeting, within))
    unasked = asyncio.ensure_future(connection.capabilities_known())
    try:
        await asyncio.wait({asking, unasked}, return_when=asyncio.FIRST_COMPLETED)
        if asking.done():
            return asking.result()
        return None
    except CallTimeoutError:
        if USER in greeting:
            raise
        return None
    finally:
        for task in (asking, unasked):
            task.cancel()


async def _call(connection: QiConnection, greeting: Mapping[str, Any], within: float) -> QiMessage:
    return await connection.ask(0, 0, AUTHENTICATE, encode("{sm}", greeting), within)


def _greeting(user: str, token: str) -> dict[str, Any]:
    who = {USER: user, TOKEN: token} if user or token else {}
    return {**CAPABILITIES, **who}


def _without_login(
    connection: QiConnection, answer: QiMessage | None, user: str, token: str
) -> Authenticated:
    if user or token:
        answer_fields = error_text(answer) if answer is not None else "it does not ask for one"
        raise LoginError(f"the robot refuses the login: {answer_fields}")
    with contextlib.suppress(
        ConnectionLostError
    ):  # the next call finds it, and knows the objection
        connection.send(
            QiMessage(MessageKind.CAPABILITY, 0, 0, 0, 0, encode("{sm}", dict(CAPABILITIES)))
        )
    return Authenticated(token, error_text(answer) if answer is not None else "")


def _read(connection: QiConnection, answer: QiMessage) -> tuple[int, Mapping[Any, Any]]:
    answer_fields = decode("{sm}", answer.payload)
    connection.learn(answer_fields)
    state = answer_fields.get(STATE, DONE)
    if not isinstance(state, int) or state not in (REFUSED, GO_ON, DONE):
        raise ProtocolError("the answer to the login has no state that is known")
    return state, answer_fields


def error_text(frame: QiMessage) -> str:
    """Return what an error message says."""
    try:
        found = ValueDecoder(frame.payload).value("m")
    except ProtocolError:
        found = frame.payload
    if isinstance(found, bytes):
        found = found.decode(errors="replace")
    return str(found).strip()


# -- opening a connection: TCP, TLS where it is wanted, and getting in -----------------------------


@dataclass(slots=True)
class Authenticator:
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

    async def connect(self, endpoint: Endpoint, within: float) -> QiConnection:
        """Open a connection and log in.

        Raises:
            ConnectionLostError: Nobody listens there, or TLS does not come about.
            CallTimeoutError: Nothing came within that many seconds.
            LoginError: We are not let in.
            ProtocolError: Something else than qi messaging listens there.
        """
        try:
            async with asyncio.timeout(within):
                connection = await self._connect(endpoint)
                return await self._enter(connection, within)
        except TimeoutError:
            raise CallTimeoutError(f"{endpoint} does not answer within {within:g} s") from None

    async def _connect(self, endpoint: Endpoint) -> QiConnection:
        loop = asyncio.get_running_loop()
        try:
            _, connection = await loop.create_connection(
                lambda: QiConnection(self.incoming, self.longest),
                endpoint.host,
                endpoint.port,
                ssl=self.tls if endpoint.tls else None,
            )
        except ssl.SSLError as error:
            raise ConnectionLostError(f"no TLS with {endpoint}: {error.reason or error}") from error
        except OSError as error:
            reason = error.strerror or str(error) or type(error).__name__
            raise ConnectionLostError(f"cannot connect to {endpoint}: {reason}") from error
        except ValueError as error:  # a name that no machine can have; UnicodeError is one, too
            raise ConnectionLostError(f"cannot connect to {endpoint.host!r}: {error}") from error
        return connection

    async def _enter(self, connection: QiConnection, within: float) -> QiConnection:
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
