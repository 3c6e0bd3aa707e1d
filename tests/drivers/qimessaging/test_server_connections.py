"""Our server seen by a bare connection: who is let in, what it is told, what it may take back."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator

import pytest
from qimessaging import (
    HostedMethod,
    HostedObject,
    HostedSignal,
    NaoqiClient,
    QiServer,
    RefusedError,
    RemoteError,
)
from qimessaging.authentication import error_text
from qimessaging.connection import QiConnection
from qimessaging.decoding import decode
from qimessaging.encoding import encode
from qimessaging.endpoints import ServiceInfo
from qimessaging.errors import ConnectionLostError
from qimessaging.frames import MessageKind, QiMessage
from qimessaging.object_host import ObjectHost
from qimessaging.registering import ServiceListener

from tests.drivers.qimessaging.messaging_rig import MessagingServer, messaging_server, until

INFO = "(sIsI[s]ss)"
DIRECTORY, THING, MAIN = 1, 2, 1
SERVICE = 100


@contextlib.asynccontextmanager
async def bare_connection(port: int) -> AsyncIterator[QiConnection]:
    """A connection that has not greeted anybody."""
    loop = asyncio.get_running_loop()
    _, connection = await loop.create_connection(QiConnection, "127.0.0.1", port)
    yield connection
    connection.end("done")


async def _ask(connection: QiConnection, service: int, action: int, payload: bytes) -> QiMessage:
    return await connection.ask(service, MAIN, action, payload, 20)


async def test_without_a_login_nothing_is_answered() -> None:
    ours = MessagingServer(QiServer(authenticator=lambda _user, token: token == "right"))
    port = (await ours.server.listen("127.0.0.1")).port
    for service, action in [(THING, SERVICE), (DIRECTORY, SERVICE), (0, 7)]:
        async with bare_connection(port) as connection:
            answer = await _ask(connection, service, action, encode("s", "Thing"))
            assert answer.kind == MessageKind.ERROR
            assert "authentication" in error_text(answer)
            await connection.lost
    assert ours.entered == []
    await ours.server.close()


async def test_relative_addresses_are_for_those_who_know_them() -> None:
    async with messaging_server() as (_, port), bare_connection(port) as connection:
        plain = await _ask(connection, DIRECTORY, SERVICE, encode("s", "Thing"))
        client = await NaoqiClient.open("127.0.0.1", port)
        [known] = [each for each in await client.services() if each.name == "Thing"]

        assert ServiceInfo.of(decode(INFO, plain.payload)).endpoints == (f"tcp://127.0.0.1:{port}",)
        assert known.endpoints == ("qi:ServiceDirectory", f"tcp://127.0.0.1:{port}")
        await client.close()


async def test_registrations_are_taken_back_one_by_one() -> None:
    async with messaging_server() as (ours, port), bare_connection(port) as connection:
        fired = ours.service.meta.signal("fired").uid
        for link in (1, 2):
            await _ask(connection, THING, 0, encode("(IIL)", (THING, fired, link)))
        assert ours.service.hearers("fired") == 2
        await _ask(connection, THING, 1, encode("(IIL)", (THING, fired, 1)))
        assert ours.service.hearers("fired") == 1

        again = await _ask(connection, THING, 1, encode("(IIL)", (THING, fired, 1)))
        assert again.kind == MessageKind.ERROR
        connection.end("gone")
        await until(lambda: ours.service.hearers("fired") == 0)


async def test_services_leave_with_the_connection_that_registered_them() -> None:
    async with messaging_server() as (_, port):
        owners = [await NaoqiClient.open("127.0.0.1", port) for _ in range(2)]
        for at, owner in enumerate(owners):
            await owner.register(f"Service{at}", HostedObject([]), listen=False)
        client = await NaoqiClient.open("127.0.0.1", port)
        gone: list[str] = []
        directory = await client.service("ServiceDirectory")
        await directory.listen("serviceRemoved", lambda _, name: gone.append(name))
        await owners[0].close()
        await until(lambda: gone == ["Service0"])

        assert "Service1" in {each.name for each in await client.services()}
        with pytest.raises(RefusedError, match="Cannot find service 'Service0'"):
            await client.service("Service0")
        await owners[1].close()
        await client.close()


async def test_a_service_that_was_withdrawn_answers_no_longer() -> None:
    async with messaging_server() as (_, port):
        owner = await NaoqiClient.open("127.0.0.1", port)
        hosted = HostedObject([HostedMethod("twice", "(i)", "i", lambda value: value * 2)])
        registration = await owner.register("Doubler", hosted)
        client = await NaoqiClient.open("127.0.0.1", port)
        doubler = await client.service("Doubler")
        assert await doubler.call("twice", 4) == 8
        await registration.withdraw()

        with pytest.raises(RemoteError, match="there is no object"):
            await doubler.call("twice", 4)
        await owner.close()
        await registration.withdraw()
        await client.close()


async def test_a_connection_that_was_ended_takes_no_calls() -> None:
    async with messaging_server() as (_, port), bare_connection(port) as connection:
        connection.hang_up("enough")
        with pytest.raises(ConnectionLostError, match="enough"):
            await _ask(connection, THING, 2, encode("I", 1))
        assert await connection.lost == "enough"
        assert connection.pending == 0


async def test_a_service_that_is_announced_too_early_is_waited_for() -> None:
    """As libqi does it: the directory names the service, its connection refuses it still."""
    loop = asyncio.get_running_loop()
    host = ObjectHost()
    late = HostedObject([HostedMethod("twice", "(i)", "i", lambda value: value * 2)])

    def service(name: str) -> tuple[object, ...]:
        if name == "Late":
            loop.call_later(0.05, host.add, 40, late)
        return (name, 40, "pepper", 7, ["qi:ServiceDirectory"], "0", b"")

    host.add(
        DIRECTORY,
        HostedObject(
            [HostedMethod("service", "(s)", INFO, service), HostedSignal("serviceRemoved", "(Is)")]
        ),
    )
    listener = ServiceListener(host)
    port = (await listener.listen("127.0.0.1", 0)).port
    client = await NaoqiClient.open("127.0.0.1", port)

    assert await client.call("Late", "twice", 4, within=20) == 8
    await client.close()
    await listener.close()
