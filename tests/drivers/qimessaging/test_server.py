"""Our server against the qi package as a client in another process."""

from __future__ import annotations

import ssl
from typing import Any

import pytest
from qimessaging import QiServer

from tests.drivers.qimessaging.messaging_rig import (
    MessagingServer,
    QiCaller,
    messaging_server,
    until,
)


async def test_services_methods_and_overloads(qi_caller: QiCaller) -> None:
    async with messaging_server() as (_, port):
        await qi_caller.do("connect", f"tcp://127.0.0.1:{port}")

        assert await qi_caller.do("services") == ["ServiceDirectory", "Thing"]
        assert await qi_caller.do("call", "Thing", "say", ["hé"]) == "one hé"
        assert await qi_caller.do("call", "Thing", "say", ["a", "b"]) == "two a b"
        assert await qi_caller.do("call", "Thing", "kind", [3]) == "number"
        assert await qi_caller.do("call", "Thing", "kind", ["3"]) == "text"
        assert await qi_caller.do("call", "Thing", "scaled", [[1, 2.5], 2]) == [2.0, 5.0]
        assert await qi_caller.do("send_bytes", "Thing", "raw", [0, 255]) == [0, 255]


async def test_any_value_goes_there_and_back(qi_caller: QiCaller) -> None:
    values: list[Any] = [
        None,
        True,
        -7,
        2.5,
        "Grüße",
        [1, ["x", None]],
        {"a": [1]},
        "x" * (1 << 20),
    ]
    async with messaging_server() as (_, port):
        await qi_caller.do("connect", f"tcp://127.0.0.1:{port}")

        for value in values:
            assert await qi_caller.do("call", "Thing", "echo", [value]) == value


async def test_an_exception_comes_with_its_text(qi_caller: QiCaller) -> None:
    async with messaging_server() as (_, port):
        await qi_caller.do("connect", f"tcp://127.0.0.1:{port}")

        with pytest.raises(RuntimeError, match=r"^the joint ZörgYaw does not exist$"):
            await qi_caller.do("call", "Thing", "fail", [])
        with pytest.raises(RuntimeError, match="Cannot find service 'Nothing'"):
            await qi_caller.do("call", "Nothing", "say", [])


async def test_signals_and_properties(qi_caller: QiCaller) -> None:
    async with messaging_server() as (ours, port):
        await qi_caller.do("connect", f"tcp://127.0.0.1:{port}")
        await qi_caller.do("listen", "Thing", "fired")
        await until(lambda: ours.service.hearers("fired") == 1)
        ours.server.emit("Thing", "fired", "é", 1.5)
        # One after the other: the package calls back in threads of a pool, in no order.
        assert await qi_caller.do("heard", "fired", 1) == [["é", 1.5]]
        await qi_caller.do("call", "Thing", "fire", ["again", 2])

        assert await qi_caller.do("heard", "fired", 2) == [["é", 1.5], ["again", 2.0]]
        assert await qi_caller.do("property", "Thing", "level") == 3
        await qi_caller.do("set_property", "Thing", "level", 9)
        assert ours.service.get("level") == 9


async def test_objects_that_are_returned_can_be_used(qi_caller: QiCaller) -> None:
    async with messaging_server() as (ours, port):
        await qi_caller.do("connect", f"tcp://127.0.0.1:{port}")

        answer = await qi_caller.do("call_child", "Thing", "child", "say", ["x"])
        assert answer == "child x"
        # The package lets go of the object as soon as its proxy is collected.
        await until(lambda: ours.children[0].place is None)


async def test_a_call_can_be_cancelled(qi_caller: QiCaller) -> None:
    async with messaging_server() as (ours, port):
        await qi_caller.do("connect", f"tcp://127.0.0.1:{port}")

        outcome = await qi_caller.do("cancel", "Thing", "slow", [60], ["entered"])
        assert outcome == "cancelled"
        assert ours.cancelled == ["slow"]


async def test_a_clients_service_is_called(qi_caller: QiCaller) -> None:
    async with messaging_server() as (ours, port):
        await qi_caller.do("connect", f"tcp://127.0.0.1:{port}")
        await qi_caller.do("register", "Doubler")

        assert await ours.server.call("Doubler", "twice", "ab") == "abab"
        assert "Doubler" in await qi_caller.do("services")


@pytest.mark.parametrize("secure", [False, True], ids=["tcp", "tcps"])
async def test_login(qi_caller: QiCaller, server_tls: ssl.SSLContext, secure: bool) -> None:
    asked: list[tuple[str, str]] = []

    def allowed(user: str, token: str) -> bool:
        asked.append((user, token))
        return token == "right"

    ours = MessagingServer(QiServer(authenticator=allowed))
    url = str(await ours.server.listen("127.0.0.1", tls=server_tls if secure else None))
    assert url.startswith("tcps:" if secure else "tcp:")
    with pytest.raises(RuntimeError):
        await qi_caller.do("connect", url, "nao", "wrong")
    await qi_caller.do("connect", url, "nao", "right")

    assert await qi_caller.do("call", "Thing", "say", ["x"]) == "one x"
    assert ("nao", "right") in asked
    await ours.server.close()
