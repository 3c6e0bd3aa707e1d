"""Ends that do not keep to the protocol: told in words, nothing else is harmed."""

from __future__ import annotations

import asyncio
import gc
import math
import struct
import warnings
from collections.abc import Awaitable, Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st
from qimessaging import (
    CallTimeoutError,
    ConnectionLostError,
    NaoqiClient,
    ProtocolError,
    QiError,
    connection,
)
from qimessaging.authentication import error_text
from qimessaging.encoding import encode
from qimessaging.frames import MessageKind, QiMessage, QiMessageReader

from tests.drivers.qimessaging.messaging_rig import (
    answering,
    between,
    frames,
    messaging_server,
    script,
    until,
)

WELCOME = encode("{sm}", {"__qi_auth_state": 3, "RemoteCancelableCalls": True})


def _raw(data: bytes) -> Callable[[asyncio.StreamReader, asyncio.StreamWriter], Awaitable[None]]:
    async def play(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        writer.write(data)
        await reader.read(-1)

    return play


@pytest.mark.parametrize(
    "data",
    [
        b"HTTP/1.1 400 Bad Request\r\nContent-Length: 0\r\n\r\n",
        b"SSH-2.0-OpenSSH_8.9p1 and more of it to come\r\n",
        struct.pack("<IIIHBBIII", 0x42ADDE42, 1, 0xFFFFFFFF, 0, 2, 0, 0, 0, 8),
        QiMessage(MessageKind.CAPABILITY, 1, 0, 0, 0, b"\xff\xff\xff\xff").encoded(),
    ],
    ids=["web server", "ssh", "endless message", "broken capabilities"],
)
async def test_another_server_is_told_as_such(data: bytes) -> None:
    async with script(_raw(data)) as port:
        with pytest.raises(ConnectionLostError, match="does not keep to the protocol"):
            await NaoqiClient.open("127.0.0.1", port)


async def test_a_broken_greeting_is_a_protocol_error() -> None:
    def greeted(frame: QiMessage, writer: asyncio.StreamWriter) -> None:
        writer.write(frame.answer(MessageKind.REPLY, b"\1").encoded())

    async with messaging_server() as (_, port), between(port, greeted) as robot:
        with pytest.raises(ProtocolError):
            await NaoqiClient.open("127.0.0.1", robot)


async def test_an_answer_that_comes_twice_counts_once() -> None:
    def twice(frame: QiMessage) -> bytes:
        return 2 * frame.encoded()

    async with messaging_server() as (_, port), answering(port, twice) as robot:
        client = await NaoqiClient.open("127.0.0.1", robot)
        for text in ("x", "y"):
            assert await client.call("Thing", "say", text, within=10) == f"one {text}"
        await client.close()


@given(st.lists(st.binary(max_size=80), min_size=1, max_size=4), st.booleans())
def test_garbage_from_a_server_is_one_of_our_errors(pieces: list[bytes], framed: bool) -> None:
    """Garbage as such, and as payloads of well-formed replies to everything that is asked."""

    async def play(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        left = list(pieces)
        async for frame in frames(reader):
            if frame.service == 0:
                writer.write(frame.answer(MessageKind.REPLY, WELCOME).encoded())
            elif framed and left:
                writer.write(frame.answer(MessageKind.REPLY, left.pop()).encoded())
            else:
                writer.write(b"".join(left))
                return

    async def meet() -> None:
        async with script(play) as port:
            with pytest.raises(QiError):
                await NaoqiClient.open("127.0.0.1", port, timeout=5)

    asyncio.run(meet())


@given(st.binary(max_size=120), st.sampled_from(list(MessageKind)), st.integers(0, 12))
def test_garbage_from_a_client_harms_no_other(
    payload: bytes, kind: MessageKind, action: int
) -> None:
    async def meet() -> None:
        async with messaging_server() as (_, port):
            client = await NaoqiClient.open("127.0.0.1", port)
            reader, writer = await asyncio.open_connection("127.0.0.1", port)
            for service in (0, 1, 2, 99):
                for number in (action, action + 98):
                    writer.write(QiMessage(kind, 1, service, 1, number, payload).encoded())
            writer.write(payload)
            writer.write_eof()
            await asyncio.wait_for(reader.read(-1), 20)
            writer.close()

            assert await client.call("Thing", "say", "x", within=20) == "one x"
            await client.close()

    asyncio.run(meet())


async def test_a_call_that_nobody_serves_is_answered() -> None:
    async with messaging_server() as (_, port):
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        puzzle = QiMessageReader()
        for service, obj, action in [(99, 1, 100), (2, 7, 100), (2, 1, 999), (2, 1, 50)]:
            writer.write(QiMessage(MessageKind.CALL, 5, service, obj, action).encoded())
            [answer] = puzzle.feed(await reader.read(1 << 16))
            assert (answer.kind, answer.id) == (MessageKind.ERROR, 5)
        writer.close()


async def test_flags_of_calls_are_understood() -> None:
    """Arguments as one dynamic value, and a wish for the result's type, as libqi may send."""
    async with messaging_server() as (ours, port):
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        puzzle = QiMessageReader()
        uid = next(m.uid for m in ours.service.meta.methods.values() if m.name == "echo")
        for flags, payload, reply in [
            (1, encode("m", ("x",)), encode("m", "x")),
            (2, encode("m", 3) + encode("s", "d"), encode("m", 3.0)),
        ]:
            writer.write(QiMessage(MessageKind.CALL, 5, 2, 1, uid, payload, flags).encoded())
            [answer] = puzzle.feed(await reader.read(1 << 16))
            assert (answer.kind, answer.payload) == (MessageKind.REPLY, reply)
        writer.close()


async def test_a_listeners_own_mistake_is_not_the_lines() -> None:
    async with messaging_server() as (ours, port):
        client = await NaoqiClient.open("127.0.0.1", port)
        troubles: list[object] = []
        asyncio.get_running_loop().set_exception_handler(
            lambda _, context: troubles.append(context["exception"])
        )

        def heard(*_: object) -> None:
            raise ZeroDivisionError

        await client.listen("Thing", "fired", heard)
        ours.server.emit("Thing", "fired", "x", 1)
        await until(lambda: bool(troubles))

        assert isinstance(troubles[0], ZeroDivisionError)
        assert await client.call("Thing", "say", "x", within=10) == "one x"
        await client.close()


@pytest.mark.parametrize(
    ("payload", "text"),
    [
        (encode("m", "stuck"), "stuck"),
        (encode("m", 7), "7"),
        (b"\xff\xfeoh", "oh"),
        (b"", ""),
    ],
)
def test_an_error_has_a_text_whatever_it_holds(payload: bytes, text: str) -> None:
    assert text in error_text(QiMessage(MessageKind.ERROR, 1, 2, 1, 100, payload))


async def test_a_call_that_is_cancelled_before_it_begins_leaves_nothing_behind(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Both come in one piece, as from a client that is cut off at once."""
    monkeypatch.setattr(connection, "_TURN_S", math.inf)  # and are read in one turn of the loop

    async def play(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        answers, calls = await asyncio.open_connection("127.0.0.1", port)
        back = asyncio.create_task(_back(answers, writer))
        async for frame in frames(reader):
            data = frame.encoded()
            if frame.kind == MessageKind.CALL and frame.payload == encode("(f)", (60.0,)):
                number = encode("I", frame.id)
                data += QiMessage(
                    MessageKind.CANCEL, frame.id + 1000, frame.service, frame.object, 0, number
                ).encoded()
            calls.write(data)
        calls.close()
        await back

    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        async with messaging_server() as (ours, port), script(play) as robot:
            client = await NaoqiClient.open("127.0.0.1", robot)
            with pytest.raises(QiError) as raised:
                await client.call("Thing", "slow", 60.0, within=20)
            assert not isinstance(raised.value, CallTimeoutError)
            assert ours.entered == []
            await client.close()
        gc.collect()
    assert [one for one in told if "never awaited" in str(one.message)] == []


async def _back(answers: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    while data := await answers.read(1 << 16):
        writer.write(data)
