"""Getting in: what the client says first, and what the other end may answer.

libqi's client calls action 8 of service 0 with its capabilities, and with `auth_user` and
`auth_token` where it has them. A server of that time replies with its own capabilities and
`__qi_auth_state`: 1 refused, 2 go on (with a token to use from now on), 3 done. Servers from
before logins answer with an error, with a message of capabilities, or not at all; they let
everybody in.
"""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

from qimessaging.connection import CAPABILITIES, Connection
from qimessaging.decoding import Decoder, decode
from qimessaging.encoding import encode
from qimessaging.errors import ConnectionLost, LoginError, ProtocolError, TimedOut
from qimessaging.frames import Frame, Kind

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
class Entered:
    """How it went.

    Attributes:
        token: What to come back with: the same, or a new one.
        objection: What the other end said against our greeting without hanging up so far: one
            of before logins does not know the call, one with logins is about to hang up.
    """

    token: str
    objection: str = ""


async def enter(connection: Connection, user: str, token: str, within: float) -> Entered:
    """Say who we are.

    Raises:
        LoginError: The other end does not let us in.
        TimedOut: A name and a token were given, and no answer came.
        ConnectionLost: It hung up.
        ProtocolError: What came is no answer to this.
    """
    silence = within if user or token else min(_SILENCE, within)
    answer = await _first(connection, _greeting(user, token), silence)
    if answer is None or answer.kind != Kind.REPLY:
        return _without_login(connection, answer, user, token)
    state, said = _read(connection, answer)
    if state == GO_ON:
        token = _new_token(said)
        answer = await _ask(connection, _greeting(user, token), within)
        if answer.kind != Kind.REPLY:
            raise LoginError(f"the robot refuses the login: {error_text(answer)}")
        state, said = _read(connection, answer)
    if state != DONE:
        raise LoginError(_why_refused(state, said))
    return Entered(token)


async def _first(
    connection: Connection, greeting: Mapping[str, Any], within: float
) -> Frame | None:
    """Return the answer to the greeting; None where capabilities came unasked, or nothing."""
    asked = asyncio.ensure_future(_ask(connection, greeting, within))
    told = asyncio.ensure_future(connection.capabilities_told())
    try:
        await asyncio.wait({asked, told}, return_when=asyncio.FIRST_COMPLETED)
        if asked.done():
            return asked.result()
        return None
    except TimedOut:
        if USER in greeting:
            raise
        return None
    finally:
        for task in (asked, told):
            task.cancel()


async def _ask(connection: Connection, greeting: Mapping[str, Any], within: float) -> Frame:
    return await connection.ask(0, 0, AUTHENTICATE, encode("{sm}", greeting), within)


def _greeting(user: str, token: str) -> dict[str, Any]:
    who = {USER: user, TOKEN: token} if user or token else {}
    return {**CAPABILITIES, **who}


def _without_login(connection: Connection, answer: Frame | None, user: str, token: str) -> Entered:
    if user or token:
        said = error_text(answer) if answer is not None else "it does not ask for one"
        raise LoginError(f"the robot refuses the login: {said}")
    with contextlib.suppress(ConnectionLost):  # the next call finds it, and knows the objection
        connection.send(Frame(Kind.CAPABILITY, 0, 0, 0, 0, encode("{sm}", dict(CAPABILITIES))))
    return Entered(token, error_text(answer) if answer is not None else "")


def _read(connection: Connection, answer: Frame) -> tuple[int, Mapping[Any, Any]]:
    said = decode("{sm}", answer.payload)
    connection.learn(said)
    state = said.get(STATE, DONE)
    if not isinstance(state, int) or state not in (REFUSED, GO_ON, DONE):
        raise ProtocolError("the answer to the login has no state that is known")
    return state, said


def _new_token(said: Mapping[Any, Any]) -> str:
    token = said.get(NEW_TOKEN)
    if not isinstance(token, str) or not token:
        raise LoginError("the robot wants another step of the login, which is not known here")
    return token


def _why_refused(state: int, said: Mapping[Any, Any]) -> str:
    if state == GO_ON:
        return "the robot wants a third step of the login, which is not known here"
    reason = said.get(REASON)
    return f"the robot refuses the login: {reason or 'wrong name or password'}"


def error_text(frame: Frame) -> str:
    """Return what an error message says."""
    try:
        found = Decoder(frame.payload).value("m")
    except ProtocolError:
        found = frame.payload
    if isinstance(found, bytes):
        found = found.decode(errors="replace")
    return str(found).strip()
