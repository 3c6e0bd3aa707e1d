"""A robot that means harm: little work and memory for each byte, one of our errors for all."""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import struct
from collections.abc import AsyncIterator
from typing import Any

import pytest
from qimessaging import ConnectionLostError, NaoqiClient, ProtocolError, QiError, RefusedError
from qimessaging.authentication import Authenticator
from qimessaging.connection import QiConnection
from qimessaging.decoding import MOST_VALUES, ValueDecoder, decode
from qimessaging.encoding import encode
from qimessaging.endpoints import Endpoint, ServiceInfo
from qimessaging.frames import DYNAMIC_PAYLOAD, MAGIC, MessageKind, QiMessage, QiMessageReader
from qimessaging.hosted_objects import HostedObject, HostedSignal
from qimessaging.metaobject import MetaMethod, MetaObject
from qimessaging.object_host import ObjectHost
from qimessaging.registering import ServiceListener, describe, register
from qimessaging.remote import RemoteObject
from qimessaging.signature import parse

from tests.drivers.qimessaging.messaging_rig import answering, messaging_server, until

WHOLE = ("Thing", 2, "pepper", 7, ["tcp://10.0.0.5:9559"], "x", b"id")
#: `service` and `services` of the directory.
_SERVICE, _SERVICES = 100, 101


@pytest.mark.parametrize(
    ("signature", "raw"),
    [
        ("[v]", struct.pack("<I", 5000)),
        ("[(vvvv)]", struct.pack("<I", 2000)),
        ("{v(vv)}", struct.pack("<I", 2000)),
        ("[[()]]", struct.pack("<I", 20) + struct.pack("<I", 200) * 20),
    ],
)
def test_a_few_bytes_hold_no_thousands_of_values(signature: str, raw: bytes) -> None:
    with pytest.raises(ProtocolError, match=r"values"):
        decode(signature, raw)


def test_a_long_list_of_numbers_is_a_short_matter() -> None:
    numbers = 2 * MOST_VALUES
    assert decode("[c]", struct.pack("<I", numbers) + bytes(numbers)) == [0] * numbers


def test_signatures_that_take_long_to_read_are_few_in_a_message() -> None:
    longs = b"".join(
        encode("s", f"({'b' * (8000 + one)})") + bytes(8000 + one) for one in range(50)
    )
    with pytest.raises(ProtocolError, match="more values"):
        ValueDecoder(struct.pack("<I", 50) + longs).value("[m]")


@pytest.mark.parametrize("data", [b"HTTP/1.1", b"\x15\x03\x01\0", b"\x42\xdf"])
def test_a_few_bytes_of_something_else_are_enough(data: bytes) -> None:
    puzzle = QiMessageReader()
    assert puzzle.feed(QiMessage(MessageKind.EVENT, 0, 2, 1, 100).encoded()[:-1]) == []
    with pytest.raises(ProtocolError, match="no qi messaging"):
        puzzle.feed(b"\0" + data)


def test_long_signatures_are_not_kept() -> None:
    assert parse("(sif)") is parse("(sif)")
    assert parse("(" + "i" * 4000 + ")") is not parse("(" + "i" * 4000 + ")")


@pytest.mark.parametrize(
    "members",
    [
        *(None, 5, "Thing", b"", [], {}, WHOLE[:5], (*WHOLE, 1)),
        *((*WHOLE[:at], wrong, *WHOLE[at + 1 :]) for at in range(6) for wrong in (None, [1])),
        *((*WHOLE[:1], wrong, *WHOLE[2:]) for wrong in (-1, 1 << 40, "2")),
        (*WHOLE[:4], [5], *WHOLE[5:]),
    ],
)  # fmt: skip
def test_what_describes_no_service_is_a_protocol_error(members: Any) -> None:
    with pytest.raises(ProtocolError):
        ServiceInfo.of(members)


def test_of_many_addresses_a_few_are_looked_at() -> None:
    many = (*WHOLE[:4], [f"tcp://10.0.0.5:{port}" for port in range(1, 5000)], *WHOLE[5:])
    assert len(ServiceInfo.of(many).endpoints) < 100


@contextlib.asynccontextmanager
async def _liar(says: dict[int, Any]) -> AsyncIterator[int]:
    """A bench whose directory answers what `says` has by its actions; its port."""

    def lie(frame: QiMessage) -> bytes:
        if frame.service == 1 and frame.kind == MessageKind.REPLY and frame.action in says:
            lied = encode("m", says[frame.action])
            return frame.answer(MessageKind.REPLY, lied, DYNAMIC_PAYLOAD).encoded()
        return frame.encoded()

    async with messaging_server() as (_, port), answering(port, lie) as robot:
        yield robot


async def test_a_directory_that_lies_is_one_of_our_errors() -> None:
    says: dict[int, Any] = {_SERVICE: 7}
    async with _liar(says) as robot:
        with pytest.raises(ProtocolError):
            await NaoqiClient.open("127.0.0.1", robot)
        del says[_SERVICE]
        client = await NaoqiClient.open("127.0.0.1", robot)
        lies: tuple[Any, ...] = (7, "text", [7], {})
        for lie in lies:
            says |= {_SERVICE: lie, _SERVICES: lie if lie else 3}
            with pytest.raises(ProtocolError):
                await client.services()
            with pytest.raises(ProtocolError):
                await client.call("Thing", "say", "x", within=10)
        says.clear()
        assert await client.call("Thing", "say", "x", within=10) == "one x"
        await client.close()


async def test_a_removal_that_is_none_breaks_nothing() -> None:
    troubles: list[Any] = []
    asyncio.get_running_loop().set_exception_handler(lambda _, found: troubles.append(found))
    async with messaging_server() as (ours, port):
        client = await NaoqiClient.open("127.0.0.1", port)
        [hearing] = ours.server._directory.hosted._hearing.values()
        for values in ((), (5,), (5, [1]), ("a", "b", "c")):
            payload = encode("m", values)
            removed = 107
            for connection, _ in hearing:
                connection.send(
                    QiMessage(MessageKind.EVENT, 0, 1, 1, removed, payload, DYNAMIC_PAYLOAD)
                )
        assert await client.call("Thing", "say", "x", within=10) == "one x"
        await client.close()
    assert troubles == []


@pytest.mark.parametrize("host", ["a" * 300, "a..b", "\udcff.local", "a\0b"])
async def test_a_name_that_no_machine_has_is_told(host: str) -> None:
    with pytest.raises(ConnectionLostError, match="cannot connect"):
        await Authenticator().connect(Endpoint(host, 9559, False), 5.0)


async def test_what_the_other_end_can_do_is_not_kept_without_end() -> None:
    connection = QiConnection()
    for one in range(50):
        told = encode("{sm}", {f"k{one}": "x", "MessageFlags": True})
        connection.data_received(QiMessage(MessageKind.CAPABILITY, 0, 0, 0, 0, told).encoded())
    assert connection.may("MessageFlags")
    assert len(connection._capabilities) == 1


async def test_calls_that_come_while_a_connection_closes_are_let_be() -> None:
    async with messaging_server() as (_, port):
        loop = asyncio.get_running_loop()
        _, connection = await loop.create_connection(QiConnection, "127.0.0.1", port)
        connection.hang_up("enough")
        connection.data_received(QiMessage(MessageKind.CALL, 1, 2, 1, 100).encoded())
        assert await connection.lost == "enough"


async def test_registrations_have_an_end() -> None:
    hosted, connection = HostedObject([HostedSignal("fired", "(s)")]), QiConnection()
    with pytest.raises(RefusedError, match="too many"):
        for link in range(100_000):
            hosted.register(connection, 100, link)
    assert hosted.hearers("fired") < 10_000


async def test_a_signal_set_off_without_values_leaves_the_line_up() -> None:
    async with messaging_server() as (ours, port):
        uid = next(each.uid for each in ours.service.meta.signals.values())
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        writer.write(
            QiMessage(MessageKind.POST, 1, 2, 1, uid, encode("m", 5), DYNAMIC_PAYLOAD).encoded()
        )
        writer.write(QiMessage(MessageKind.CALL, 2, 2, 1, 2, encode("I", 1)).encoded())
        [answer] = QiMessageReader().feed(await asyncio.wait_for(reader.read(1 << 16), 20))
        assert (answer.kind, answer.id) == (MessageKind.REPLY, 2)
        writer.close()


class _Ear:
    """Takes events, and says which other things of the loop had happened before."""

    def __init__(self) -> None:
        self.took: list[str] = []

    def take(self, frame: QiMessage) -> None:
        self.took.append(f"event {frame.id}")


def _hearing(monkeypatch: pytest.MonkeyPatch) -> tuple[QiConnection, _Ear]:
    """A connection for which every message takes a second."""
    connection, ear = QiConnection(), _Ear()
    connection.add_listener((2, 1, 100), ear)
    seconds = itertools.count()
    monkeypatch.setattr(asyncio.get_running_loop(), "time", lambda: float(next(seconds)))
    return connection, ear


_EVENTS = b"".join(QiMessage(MessageKind.EVENT, number, 2, 1, 100).encoded() for number in range(3))


async def test_thousands_of_messages_hold_up_nobody(monkeypatch: pytest.MonkeyPatch) -> None:
    connection, ear = _hearing(monkeypatch)
    connection.data_received(_EVENTS)
    connection.data_received(b"no message" * 9)
    for _ in range(4):
        asyncio.get_running_loop().call_soon(ear.took.append, "another")
        await asyncio.sleep(0)
    assert ear.took[:5] == ["event 0", "event 1", "another", "event 2", "another"]
    assert "no qi messaging" in await connection.lost


async def test_what_came_before_the_end_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    connection, ear = _hearing(monkeypatch)
    connection.data_received(QiMessage(MessageKind.CALL, 1, 2, 1, 100).encoded() + _EVENTS)
    connection.eof_received()
    assert ear.took == ["event 0", "event 1", "event 2"]
    assert connection.lost.done()
    await asyncio.sleep(0)
    assert len(ear.took) == 3


async def test_an_event_with_other_values_is_left_out() -> None:
    async with messaging_server() as (ours, port):
        client = await NaoqiClient.open("127.0.0.1", port)
        heard: list[Any] = []
        await client.listen("Thing", "fired", lambda *values: heard.append(values))
        uid = next(each.uid for each in ours.service.meta.signals.values())
        [(connection, _)] = ours.service._hearing[uid]
        for payload in (b"", b"\xff\xff\xff\xff"):
            connection.send(QiMessage(MessageKind.EVENT, 0, 2, 1, uid, payload))
        ours.server.emit("Thing", "fired", "x", 1)
        await until(lambda: bool(heard))
        assert heard == [("x", 1.0)]
        assert not client.lost.done()
        await client.close()


async def test_a_directory_that_takes_no_services_is_told() -> None:
    meta = MetaObject()
    directory = RemoteObject(QiConnection(), 1, 1, meta)
    info = describe("Mine", [])
    for wrong in ("()", "(ss)", "s", "(q)"):
        with pytest.raises(QiError):
            await register(directory, ObjectHost(), info, HostedObject([]), 1.0)
        meta.methods[102] = MetaMethod(102, "registerService", wrong, "I")
        meta = directory.meta = MetaObject(dict(meta.methods))
    says: dict[int, Any] = {102: [5]}
    async with _liar(says) as robot:
        client = await NaoqiClient.open("127.0.0.1", robot)
        with pytest.raises(ProtocolError, match="no number"):
            await client.register("Mine", HostedObject([]))
        await client.close()


async def test_those_who_say_nothing_make_room_for_those_who_do() -> None:
    listener = ServiceListener(ObjectHost(), most=2)
    port = (await listener.listen("127.0.0.1", 0)).port
    hello = QiMessage(MessageKind.CALL, 1, 0, 0, 8, encode("{sm}", {})).encoded()

    async def comes(says: bytes) -> asyncio.StreamReader:
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        writers.append(writer)
        writer.write(says)
        if says:
            assert await asyncio.wait_for(reader.read(100), 20)
        return reader

    writers: list[asyncio.StreamWriter] = []
    silent = await comes(b"")
    greeted = await comes(hello)
    await comes(hello)
    assert await asyncio.wait_for(silent.read(), 20) == b""
    late = await comes(b"")
    with contextlib.suppress(ConnectionError):
        assert await asyncio.wait_for(late.read(), 20) == b""
    writers[1].write(hello)
    assert await asyncio.wait_for(greeted.read(100), 20)
    for writer in writers:
        writer.close()
    await listener.close()


async def test_what_our_service_is_sent_is_short() -> None:
    async with messaging_server() as (_, port):
        client = await NaoqiClient.open("127.0.0.1", port)
        await client.register("Mine", HostedObject([]))
        own = client._listener.endpoints[0].port
        reader, writer = await asyncio.open_connection("127.0.0.1", own)
        writer.write(struct.pack("<IIIHBBIII", MAGIC, 1, 2 << 20, 0, 1, 0, 5, 1, 100))
        with contextlib.suppress(ConnectionError):
            assert await asyncio.wait_for(reader.read(), 20) == b""
        writer.close()
        await client.close()
