"""Our client against a `qi.Session` that listens in another process."""

from __future__ import annotations

import asyncio
import subprocess
from typing import Any

import pytest
from qimessaging import (
    CallTimeoutError,
    ConnectionLostError,
    HostedMethod,
    HostedObject,
    NaoqiClient,
    RefusedError,
    RemoteError,
    RemoteObject,
)

from tests.drivers.qimessaging.messaging_rig import until

W = 10.0  # seconds within which a call is answered, generously


async def test_services_are_found(client: NaoqiClient) -> None:
    assert {"ServiceDirectory", "Thing"} <= {each.name for each in await client.services()}
    assert client.local_host == "127.0.0.1"


async def test_overloads_by_number_and_type(client: NaoqiClient) -> None:
    assert await client.call("Thing", "say", "hé", within=W) == "one hé"
    assert await client.call("Thing", "say", "a", "b", within=W) == "two a b"
    assert await client.call("Thing", "kind", 3, within=W) == "number"
    assert await client.call("Thing", "kind", "3", within=W) == "text"
    assert await client.call("Thing", "kind", [3], within=W) == "list"


async def test_arguments_are_made_to_fit(client: NaoqiClient) -> None:
    assert await client.call("Thing", "scaled", (1, 2.5), 2, within=W) == [2.0, 5.0]
    assert await client.call("Thing", "counted", {"a": 1}, within=W) == {"a": 2}
    assert await client.call("Thing", "negated", False, within=W) is True


@pytest.mark.parametrize(
    "value",
    [
        None,
        True,
        -7,
        2.5,
        "Grüße, 世界",
        [],
        [1, 2.5, "x", [True, None]],
        (1, "a"),
        {"a": 1, "b": [2]},
        {},
        b"\x00\xff\xfe",
        "x" * (1 << 20),
        [[[["deep"]]]],
    ],
    ids=lambda value: repr(value)[:20],
)
async def test_any_value_goes_there_and_back(client: NaoqiClient, value: Any) -> None:
    assert await client.call("Thing", "echo", value, within=W) == value


async def test_an_exception_comes_with_its_text(client: NaoqiClient) -> None:
    with pytest.raises(RemoteError, match="the joint ZörgYaw does not exist"):
        await client.call("Thing", "fail", within=W)


@pytest.mark.parametrize(
    ("service", "method", "args", "says"),
    [
        ("Nothing", "say", ("x",), "Nothing"),
        ("Thing", "nothing", (), "no method nothing"),
        ("Thing", "say", (1,), r"say does not take \(int\); there is say\(s\), say\(ss\)"),
        ("Thing", "scaled", (["x"], 1), "argument 1 of scaled"),
    ],
)
async def test_what_is_not_there_is_said(
    client: NaoqiClient, service: str, method: str, args: tuple[Any, ...], says: str
) -> None:
    with pytest.raises(RefusedError, match=says):
        await client.call(service, method, *args, within=W)


async def test_a_late_reply_is_dropped(client: NaoqiClient) -> None:
    await client.service("Thing")  # else it is looked for within the same time
    with pytest.raises(CallTimeoutError, match=r"Thing\.slow gave no answer within 0\.05 s"):
        await client.call("Thing", "slow", 0.3, within=0.05)
    assert client.pending == 0

    # The service has one thread: this answer comes after the late one.
    assert await client.call("Thing", "say", "x", within=W) == "one x"


async def test_a_thousand_calls_at_once(client: NaoqiClient) -> None:
    calls = [client.call("Thing", "echo", each, within=60) for each in range(1000)]

    assert await asyncio.gather(*calls) == list(range(1000))
    assert client.pending == 0


async def test_signals_are_heard_until_unsubscribed(client: NaoqiClient) -> None:
    first: list[Any] = []
    second: list[Any] = []
    stop_first = await client.listen("Thing", "fired", lambda *values: first.append(values))
    stop_second = await client.listen("Thing", "fired", lambda *values: second.append(values))
    await client.call("Thing", "fire", "é", 1.5, within=W)
    await until(lambda: bool(second))
    await stop_first()
    await client.call("Thing", "fire", "again", 2, within=W)
    await until(lambda: len(second) == 2)
    await stop_second()
    await client.call("Thing", "fire", "unheard", 3, within=W)
    await client.call("Thing", "say", "x", within=W)

    assert first == [("é", 1.5)]
    assert second == [("é", 1.5), ("again", 2.0)]


async def test_a_property_is_read_set_and_heard(client: NaoqiClient) -> None:
    heard: list[int] = []
    stop = await client.listen("Thing", "level", heard.append)
    thing = await client.service("Thing")
    await thing.set_property("level", 41)
    await until(lambda: heard == [41])

    assert await client.property("Thing", "level") == 41
    await stop()


async def test_objects_that_are_returned_can_be_used(client: NaoqiClient) -> None:
    child = await client.call("Thing", "child", within=W)
    assert isinstance(child, RemoteObject)
    heard: list[Any] = []
    await child.listen("fired", lambda *values: heard.append(values))
    await child.call("fire", "x", 1)
    await until(lambda: heard == [("x", 1.0)])
    assert await child.call("say", "x") == "one x"

    child.release()
    with pytest.raises(RemoteError):
        await child.call("say", "x")


async def test_a_service_of_ours_is_called_by_the_other_process(client: NaoqiClient) -> None:
    async def twice(value: Any) -> Any:
        return value * 2

    for listen in (False, True):
        doubler = HostedObject([HostedMethod("twice", "(m)", "m", twice)])
        registration = await client.register("Doubler", doubler, listen=listen)

        assert await client.call("Thing", "ask_back", "Doubler", "ab", within=W) == "abab"
        await registration.withdraw()
        assert "Doubler" not in {each.name for each in await client.services()}


async def test_a_service_of_ours_is_found_by_third_parties(
    client: NaoqiClient, qi_port: int
) -> None:
    doubler = HostedObject([HostedMethod("twice", "(m)", "m", lambda value: value * 2)])
    registration = await client.register("Threefold", doubler)
    third = await NaoqiClient.open("127.0.0.1", qi_port)

    assert await third.call("Threefold", "twice", 4, within=W) == 8
    await third.close()
    await registration.withdraw()


async def test_a_name_that_is_taken_is_refused(client: NaoqiClient) -> None:
    with pytest.raises(RemoteError, match="already registered"):
        await client.register("Thing", HostedObject([]))


async def test_a_killed_server_is_told_in_mid_call(
    mortal_qi_service: tuple[subprocess.Popen[str], int],
) -> None:
    process, port = mortal_qi_service
    client = await NaoqiClient.open("127.0.0.1", port)
    turns: list[str] = []
    client.lost.add_done_callback(lambda _: turns.append("lost"))
    running = asyncio.create_task(client.call("Thing", "slow", 60, within=60))
    await client.call("Thing", "say", "x", within=W)
    process.kill()

    with pytest.raises(ConnectionLostError):
        await running
    assert client.lost.done()
    assert client.pending == 0
    with pytest.raises(ConnectionLostError):
        await client.call("Thing", "say", "x", within=W)
    await client.close()


async def test_nothing_is_printed(client: NaoqiClient, capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(RemoteError):
        await client.call("Thing", "fail", within=W)
    await client.close()

    assert capfd.readouterr() == ("", "")
