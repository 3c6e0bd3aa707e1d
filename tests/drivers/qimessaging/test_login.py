"""Getting in: servers of before logins, of today, and with a login in two steps."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable
from typing import Any

import pytest
from qimessaging import (
    CallTimeoutError,
    HostedMethod,
    HostedObject,
    LoginError,
    NaoqiClient,
    ProtocolError,
    QiError,
)
from qimessaging.decoding import decode
from qimessaging.encoding import encode
from qimessaging.frames import MessageKind, QiMessage
from qimessaging.hosted_objects import HostedSignal
from qimessaging.object_host import ObjectHost
from qimessaging.registering import ServiceListener

from tests.drivers.qimessaging.messaging_rig import between, frames, messaging_server, script

Greeted = Callable[[QiMessage, asyncio.StreamWriter], None]
STATE = "__qi_auth_state"


def _reply(frame: QiMessage, said: dict[str, Any]) -> bytes:
    return frame.answer(MessageKind.REPLY, encode("{sm}", said)).encoded()


def _error(frame: QiMessage, writer: asyncio.StreamWriter) -> None:
    writer.write(frame.answer(MessageKind.ERROR, encode("m", "no such function")).encoded())


def _capabilities(frame: QiMessage, writer: asyncio.StreamWriter) -> None:
    if frame.kind == MessageKind.CALL:
        said = encode("{sm}", {"ClientServerSocket": True})
        writer.write(QiMessage(MessageKind.CAPABILITY, 77, 0, 0, 0, said).encoded())


@pytest.mark.parametrize("greeted", [_error, _capabilities])
async def test_a_server_of_before_logins_lets_us_in(greeted: Greeted) -> None:
    async with messaging_server() as (_, port), between(port, greeted) as old:
        client = await NaoqiClient.open("127.0.0.1", old)

        assert await client.call("Thing", "say", "x", within=10) == "one x"
        await client.close()
        with pytest.raises(LoginError):
            await NaoqiClient.open("127.0.0.1", old, user="nao", token="x")


async def test_a_server_that_leaves_the_greeting_unanswered_lets_us_in(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("qimessaging.authentication._SILENCE", 0.05)
    async with messaging_server() as (_, port), between(port, lambda _frame, _writer: None) as old:
        client = await NaoqiClient.open("127.0.0.1", old)

        assert await client.call("Thing", "say", "x", within=10) == "one x"
        await client.close()
        with pytest.raises(CallTimeoutError):
            await NaoqiClient.open("127.0.0.1", old, user="nao", token="x", timeout=0.1)


async def test_a_login_in_two_steps_takes_the_new_token() -> None:
    told: list[dict[str, Any]] = []

    def greeted(frame: QiMessage, writer: asyncio.StreamWriter) -> None:
        told.append(decode("{sm}", frame.payload))
        if told[-1]["auth_token"] == "fresh":
            writer.write(_reply(frame, {STATE: 3}))
        else:
            writer.write(_reply(frame, {STATE: 2, "auth_newToken": "fresh"}))

    async with messaging_server() as (_, port), between(port, greeted) as robot:
        client = await NaoqiClient.open("127.0.0.1", robot, user="nao", token="first")
        await client.close()

    assert [(each["auth_user"], each["auth_token"]) for each in told] == [
        ("nao", "first"),
        ("nao", "fresh"),
    ]
    assert told[0]["ClientServerSocket"] is True


@pytest.mark.parametrize(
    ("said", "error", "text"),
    [
        ({STATE: 1}, LoginError, "wrong name or password"),
        ({STATE: 1, "__qi_auth_err_reason": "locked"}, LoginError, "locked"),
        ({STATE: 2}, LoginError, "another step"),
        ({STATE: 2, "auth_newToken": "again"}, LoginError, "third step"),
        ({STATE: 9}, ProtocolError, "state"),
        ({STATE: "x"}, ProtocolError, "state"),
    ],
)
async def test_a_refused_login_is_told_in_words(
    said: dict[str, Any], error: type[QiError], text: str
) -> None:
    def greeted(frame: QiMessage, writer: asyncio.StreamWriter) -> None:
        writer.write(_reply(frame, said))

    async with messaging_server() as (_, port), between(port, greeted) as robot:
        with pytest.raises(error, match=text):
            await NaoqiClient.open("127.0.0.1", robot, user="nao", token="x")


async def test_a_robot_that_does_not_answer_is_given_up() -> None:
    async def play(reader: asyncio.StreamReader, _: asyncio.StreamWriter) -> None:
        await reader.read(-1)

    async with script(play) as port:
        with pytest.raises(CallTimeoutError):
            await NaoqiClient.open("127.0.0.1", port, timeout=0.1)


async def test_opening_takes_no_longer_than_it_may() -> None:
    """Also where the robot greets and is silent from then on, or answers bit by bit."""

    async def play(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        async for frame in frames(reader):
            if frame.service == 0:
                writer.write(_reply(frame, {STATE: 3}))

    async with script(play) as port:
        with pytest.raises(CallTimeoutError, match=f"tcp://127.0.0.1:{port} does not answer"):
            await NaoqiClient.open("127.0.0.1", port, timeout=0.1)


async def test_opening_that_is_given_up_leaves_no_connection() -> None:
    came, ended = asyncio.Event(), asyncio.Event()

    async def play(reader: asyncio.StreamReader, _: asyncio.StreamWriter) -> None:
        came.set()
        with contextlib.suppress(ConnectionError):
            await reader.read(-1)
        ended.set()

    async with script(play) as port:
        opening = asyncio.create_task(NaoqiClient.open("127.0.0.1", port))
        await asyncio.wait_for(came.wait(), 20)
        opening.cancel()
        with pytest.raises(asyncio.CancelledError):
            await opening
        await asyncio.wait_for(ended.wait(), 20)


async def test_a_directory_of_before_identities_takes_our_service() -> None:
    """NAOqi 2.1 to 2.5 describe services by six members; libqi from 1.8 on by seven."""
    old = "(sIsI[s]s)<ServiceInfo,name,serviceId,machineId,processId,endpoints,sessionId>"
    registered: list[Any] = []
    itself: Any = ("ServiceDirectory", 1, "pepper", 7, [], "0")

    def register(info: Any) -> int:
        registered.append(info)
        return 40

    host = ObjectHost()
    host.add(
        1,
        HostedObject(
            [
                HostedMethod("service", "(s)", old, lambda _: itself),
                HostedMethod("services", "()", f"[{old}]", lambda: [itself]),
                HostedMethod("registerService", f"({old})", "I", register),
                HostedMethod("unregisterService", "(I)", "v", lambda _: None),
                HostedMethod("serviceReady", "(I)", "v", registered.append),
                HostedSignal("serviceRemoved", "(Is)"),
            ]
        ),
    )
    listener = ServiceListener(host)
    port = (await listener.listen("127.0.0.1", 0)).port
    client = await NaoqiClient.open("127.0.0.1", port)
    registration = await client.register("WozEars", HostedObject([]))

    assert [each.name for each in await client.services()] == ["ServiceDirectory"]
    assert registered[0][0] == "WozEars"
    assert len(registered[0]) == 6
    assert registered[0][4][0].startswith("tcp://127.0.0.1:")
    assert registered[1] == registration.service == 40
    await client.close()
    await listener.close()
