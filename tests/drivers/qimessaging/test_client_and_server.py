"""Our client against our server: what machines without libqi have."""

from __future__ import annotations

import asyncio
import ssl
from typing import Any

import psutil
import pytest
from qimessaging import (
    CallCancelledError,
    CallTimeoutError,
    ConnectionLostError,
    HostedMethod,
    HostedObject,
    HostedSignal,
    LoginError,
    NaoqiClient,
    ProtocolError,
    QiServer,
    RefusedError,
    RemoteError,
    RemoteObject,
    ServiceLostError,
)
from qimessaging.connection import QiConnection
from qimessaging.encoding import encode

from tests.drivers.qimessaging.messaging_rig import MessagingServer, messaging_server, until

W = 10.0  # seconds within which a call is answered, generously


async def test_calls_signals_properties_and_objects() -> None:
    async with messaging_server() as (ours, port):
        client = await NaoqiClient.open("localhost", port)
        heard: list[Any] = []
        stop = await client.listen("Thing", "fired", lambda *values: heard.append(values))
        thing = await client.service("Thing")
        await thing.set_property("level", 5)
        child = await client.call("Thing", "child", within=W)
        assert isinstance(child, RemoteObject)
        await child.listen("signal", heard.append)
        await child.call("fire", "x")
        ours.server.emit("Thing", "fired", "é", 1)
        await until(lambda: len(heard) == 2)
        child.release()
        await until(lambda: ours.children[0].place is None)
        await stop()

        assert heard == ["x", ("é", 1.0)]
        assert await client.property("Thing", "level") == 5
        assert await client.call("Thing", "raw", b"\0\xff", within=W) == b"\0\xff"
        assert await client.call("Thing", "say", "a", "b", within=W) == "two a b"
        assert ours.service.hearers("fired") == 0
        with pytest.raises(RemoteError, match=r"^the joint ZörgYaw does not exist"):
            await client.call("Thing", "fail", within=W)
        await client.close()


async def test_a_slow_call_holds_up_nobody_and_can_be_cancelled() -> None:
    async with messaging_server() as (ours, port):
        client = await NaoqiClient.open("127.0.0.1", port)
        slow = asyncio.create_task(client.call("Thing", "slow", 60, within=60))
        await until(lambda: ours.entered == ["slow"])
        assert await client.call("Thing", "say", "x", within=W) == "one x"

        slow.cancel()
        await until(lambda: ours.cancelled == ["slow"])
        with pytest.raises(asyncio.CancelledError):
            await slow
        assert client.pending == 0
        await client.close()


async def test_a_thousand_calls_at_once_each_get_their_own_reply() -> None:
    async with messaging_server() as (_, port):
        client = await NaoqiClient.open("127.0.0.1", port)
        calls = [
            client.call("Thing", "echo", [each, "x" * each], within=60) for each in range(1000)
        ]

        assert await asyncio.gather(*calls) == [[each, "x" * each] for each in range(1000)]
        await client.close()


async def test_tls(server_tls: ssl.SSLContext, client_tls: ssl.SSLContext) -> None:
    ours = MessagingServer()
    port = (await ours.server.listen("127.0.0.1", tls=server_tls)).port
    client = await NaoqiClient.open("127.0.0.1", port, tls=client_tls)

    assert await client.call("Thing", "echo", "x" * (1 << 20), within=W) == "x" * (1 << 20)
    await client.close()
    with pytest.raises(ConnectionLostError, match="no TLS"):
        await NaoqiClient.open("127.0.0.1", port, tls=ssl.create_default_context())
    with pytest.raises((ConnectionLostError, ProtocolError)):
        await NaoqiClient.open("127.0.0.1", port)
    await ours.server.close()


async def test_login() -> None:
    ours = MessagingServer(
        QiServer(authenticator=lambda user, token: (user, token) == ("nao", "right"))
    )
    port = (await ours.server.listen("127.0.0.1")).port

    for user, token in [("nao", "wrong"), ("", "")]:
        with pytest.raises(LoginError, match=r"refuses the login: .*wrong name"):
            await NaoqiClient.open("127.0.0.1", port, user=user, token=token)
    client = await NaoqiClient.open("127.0.0.1", port, user="nao", token="right")
    assert await client.call("Thing", "say", "x", within=W) == "one x"
    await client.close()
    await ours.server.close()


async def test_a_server_that_goes_is_told_and_one_that_comes_is_found() -> None:
    async with messaging_server() as (ours, port):
        client = await NaoqiClient.open("127.0.0.1", port)
        slow = asyncio.create_task(client.call("Thing", "slow", 60, within=60))
        await until(lambda: ours.entered == ["slow"])
    with pytest.raises(ConnectionLostError):
        await slow
    assert "closed" in await client.lost
    with pytest.raises(ConnectionLostError):
        await client.listen("Thing", "fired", print)
    await client.close()

    with pytest.raises(ConnectionLostError, match="cannot connect"):
        await NaoqiClient.open("127.0.0.1", port)


async def test_closing_ends_calls_and_is_told() -> None:
    async with messaging_server() as (ours, port):
        client = await NaoqiClient.open("127.0.0.1", port)
        slow = asyncio.create_task(client.call("Thing", "slow", 60, within=60))
        await until(lambda: ours.entered == ["slow"])
        await client.close()
        await client.close()

        with pytest.raises(ConnectionLostError, match="closed"):
            await slow
        assert client.lost.result() == "closed"


async def test_a_service_that_comes_back_elsewhere_is_looked_up_again() -> None:
    async with messaging_server() as (ours, port):
        client = await NaoqiClient.open("127.0.0.1", port)
        assert await client.call("Thing", "say", "x", within=W) == "one x"
        ours.server.remove("Thing")
        ours.server.add(
            "Thing", methods=[HostedMethod("say", "(s)", "s", lambda text: f"new {text}")]
        )

        async def new() -> bool:
            try:
                return bool(await client.call("Thing", "say", "x", within=W) == "new x")
            except RefusedError:
                return False

        async with asyncio.timeout(W):
            while not await new():
                pass
        await client.close()


async def test_a_service_in_another_process_is_reached_and_its_loss_is_told() -> None:
    async with messaging_server() as (_, port):
        owner = await NaoqiClient.open("127.0.0.1", port)
        tablet = HostedObject(
            [HostedMethod("show", "(s)", "b", lambda _: True), HostedSignal("touched", "(ff)")],
        )
        await owner.register("ALTabletService", tablet)
        client = await NaoqiClient.open("127.0.0.1", port)
        touches: list[Any] = []
        await client.listen("ALTabletService", "touched", lambda *at: touches.append(at))
        tablet.emit("touched", 0.25, 0.5)
        assert await client.call("ALTabletService", "show", "x", within=W) is True
        await until(lambda: touches == [(0.25, 0.5)])
        found = await client.service("ALTabletService")

        await owner.close()
        await until(found.connection.lost.done)
        with pytest.raises(RefusedError) as lost:
            await client.call("ALTabletService", "show", "x", within=W)
        assert not isinstance(lost.value, RemoteError) or "find" in str(lost.value)
        assert not client.lost.done()
        assert await client.call("Thing", "say", "x", within=W) == "one x"
        await client.close()


def _connections_to(port: int) -> int:
    found = psutil.Process().net_connections("tcp")
    return sum(each.status == psutil.CONN_ESTABLISHED and each.laddr.port == port for each in found)


async def test_two_services_of_one_process_share_a_connection() -> None:
    async with messaging_server() as (_, port):
        owner = await NaoqiClient.open("127.0.0.1", port)
        services = [HostedObject([HostedSignal("news", "(s)")]) for _ in range(2)]
        for name, hosted in zip(("One", "Two"), services, strict=True):
            await owner.register(name, hosted)
        client = await NaoqiClient.open("127.0.0.1", port)
        await asyncio.gather(*[client.listen(name, "news", print) for name in ("One", "Two")])
        one, two = await client.service("One"), await client.service("Two")

        assert one.connection is two.connection
        _, ours = one.connection.address("peername")
        await until(lambda: _connections_to(ours) == 1)
        await client.close()
        await until(lambda: [each.hearers("news") for each in services] == [0, 0])
        await owner.close()


async def test_a_call_in_flight_tells_that_its_process_has_gone() -> None:
    async with messaging_server() as (_, port):
        owner = await NaoqiClient.open("127.0.0.1", port)
        entered = asyncio.Event()

        async def hang() -> None:
            entered.set()
            await asyncio.sleep(60)

        await owner.register("Slow", HostedObject([HostedMethod("hang", "()", "v", hang)]))
        client = await NaoqiClient.open("127.0.0.1", port)
        hanging = asyncio.create_task(client.call("Slow", "hang", within=60))
        await entered.wait()
        await owner.close()

        with pytest.raises((ServiceLostError, CallCancelledError)):
            await hanging
        await client.close()


async def test_the_server_calls_a_clients_service() -> None:
    async with messaging_server() as (ours, port):
        client = await NaoqiClient.open("127.0.0.1", port)
        blocks: list[Any] = []
        listener = HostedObject(
            [HostedMethod("processRemote", "(iimm)", "v", lambda *block: blocks.append(block))]
        )
        registration = await client.register("WozEars", listener, listen=False)
        await ours.server.call("WozEars", "processRemote", 1, 170, [1, 2], b"\1\2")

        assert blocks == [(1, 170, [1, 2], b"\1\2")]
        await registration.withdraw()
        with pytest.raises(RefusedError, match="WozEars"):
            await ours.server.call("WozEars", "processRemote", 1, 170, [1, 2], b"")
        with pytest.raises(RefusedError, match="no service of a client"):
            await ours.server.call("Thing", "say", "x")
        await client.close()


async def test_a_service_that_hangs_is_not_waited_for() -> None:
    async with messaging_server() as (ours, port):
        client = await NaoqiClient.open("127.0.0.1", port)
        await client.service("Thing")  # else it is looked for within the same time
        with pytest.raises(CallTimeoutError, match=r"Thing\.slow"):
            await client.call("Thing", "slow", 60, within=0.05)

        assert client.pending == 0
        assert ours.cancelled == []  # the robot may still carry it out
        await client.close()


async def test_values_that_do_not_fit_are_said() -> None:
    async with messaging_server() as (ours, port):
        client = await NaoqiClient.open("127.0.0.1", port)
        with pytest.raises(RefusedError, match="argument 1"):
            await client.call("Thing", "scaled", "x", 1, within=W)
        with pytest.raises(RefusedError, match="no signal nothing"):
            await client.listen("Thing", "nothing", print)
        with pytest.raises(RefusedError, match="no property nothing"):
            await client.property("Thing", "nothing")
        with pytest.raises(ProtocolError):
            ours.server.emit("Thing", "fired", 1, 2)
        with pytest.raises(RefusedError):
            ours.server.emit("Thing", "nothing")
        with pytest.raises(ProtocolError):
            ours.server.add("Wrong", methods=[HostedMethod("x", "s", "v", print)])
        with pytest.raises(RefusedError, match="already registered"):
            ours.server.add("Thing")
        await client.close()


async def test_an_object_that_is_handed_out_twice_is_one() -> None:
    async with messaging_server() as (ours, port):
        only = ours.service_of_children()
        client = await NaoqiClient.open("127.0.0.1", port)
        heard: list[str] = []
        one, two = [await client.call("Family", "child", within=W) for _ in range(2)]
        await one.listen("signal", lambda text: heard.append(f"one {text}"))
        await two.listen("signal", lambda text: heard.append(f"two {text}"))
        only.emit("signal", "x")
        await until(lambda: len(heard) == 2)
        one.release()

        assert await two.call("say", "x") == "child x"
        assert heard == ["one x", "two x"]
        assert only.hearers("signal") == 1
        two.release()
        await until(lambda: only.place is None)
        await client.close()


async def test_listening_that_is_given_up_is_taken_back() -> None:
    async with messaging_server() as (ours, port):
        client = await NaoqiClient.open("127.0.0.1", port)
        await client.service("Thing")
        listening = asyncio.create_task(client.listen("Thing", "fired", print))
        while client.pending == 0:  # noqa: ASYNC110 - the answer is not to come first
            await asyncio.sleep(0)
        listening.cancel()
        with pytest.raises(asyncio.CancelledError):
            await listening
        await client.call("Thing", "say", "x", within=W)

        assert ours.service.hearers("fired") == 0
        await client.close()


async def test_a_search_that_is_under_way_ends_with_the_client() -> None:
    async with messaging_server() as (_, port):
        client = await NaoqiClient.open("127.0.0.1", port)
        searching = asyncio.create_task(client.call("Thing", "say", "x", within=60))
        await asyncio.sleep(0)
        await client.close()

        with pytest.raises(ConnectionLostError, match="closed"):
            await searching


async def test_the_end_of_a_connection_is_told_in_the_same_turn() -> None:
    told: list[bool] = []

    class Watched(QiConnection):
        def connection_lost(self, exc: Exception | None) -> None:
            told.append(self.lost.done())
            super().connection_lost(exc)

    async with messaging_server() as (ours, port):
        loop = asyncio.get_running_loop()
        _, connection = await loop.create_connection(Watched, "127.0.0.1", port)
        await connection.ask(2, 1, 2, encode("I", 1), 60)
        await ours.server.close()
        await connection.lost
        await until(lambda: bool(told))

    assert told == [True]
