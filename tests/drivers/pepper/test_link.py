"""A link over the wire: values, errors, signals, ends, with both clients."""

from __future__ import annotations

import asyncio
import os
import socket
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from pathlib import Path
from typing import Any

import pytest
from qimessaging.hosted_objects import HostedMethod, HostedSignal
from qimessaging.server import QiServer
from woz_drivers.naoqi_robot.address import Address, parse
from woz_drivers.naoqi_robot.link import (
    UNCONFIRMED_MS,
    LinkClosedError,
    NaoqiLink,
    RobotRefusedError,
    ServiceMissingError,
    UnansweredError,
    binary,
    open_link,
)
from woz_drivers.pepper.settings import PepperSettings

from tests.drivers.pepper.connection_rig import threads_now
from woz_tui.drivers.contract import DeviceLostError

SETTINGS = PepperSettings(robots=())
WITHIN_S = 10.0


class ServiceRig:
    """A robot with one service, in the test's own loop."""

    def __init__(self) -> None:
        self.server = QiServer()
        self.cancelled = asyncio.Event()
        self.entered = asyncio.Event()
        self.host = ""
        self.offer()

    def offer(self) -> None:
        self.server.add(
            "Desk",
            methods=[
                HostedMethod("echo", "(m)", "m", lambda value: value),
                HostedMethod("picture", "()", "m", lambda: [2, 1, b"\xff\x00"]),
                HostedMethod("fails", "()", "v", self._fails),
                HostedMethod("waits", "()", "v", self._waits),
            ],
            signals=[HostedSignal("touched", "(fs)")],
        )

    def _fails(self) -> None:
        raise RuntimeError("Desk::fails\n\tno such animation")

    async def _waits(self) -> None:
        self.entered.set()
        try:
            await asyncio.sleep(3600)
        except asyncio.CancelledError:
            self.cancelled.set()
            raise


@pytest.fixture
async def rig() -> AsyncIterator[ServiceRig]:
    service_rig = ServiceRig()
    endpoint = await service_rig.server.listen("127.0.0.1")
    service_rig.host = str(endpoint)
    yield service_rig
    await service_rig.server.close()


@asynccontextmanager
async def opened_link(service_rig: ServiceRig) -> AsyncIterator[NaoqiLink]:
    settings = PepperSettings(robots=())
    link = await open_link(parse(service_rig.host), settings, within=WITHIN_S)
    try:
        yield link
    finally:
        await link.close()


async def happens(event: asyncio.Event) -> None:
    await asyncio.wait_for(event.wait(), WITHIN_S)


@pytest.mark.parametrize(
    "value",
    [True, 0, -3, 1 << 40, 2.5, "", "Grüße, 世界", [1, "a", [2.5, None]], {"a": [1]}, b"\xff\x00"],
)
async def test_values_go_there_and_back(rig: ServiceRig, value: Any) -> None:
    async with opened_link(rig) as link:
        found = await link.call("Desk", "echo", value, within=WITHIN_S)
        assert found == value
        assert isinstance(found, bool) == isinstance(value, bool)


@pytest.mark.parametrize("data", [b"\xff\x00\x80", b"\x00\x00", b"plain"])
async def test_bytes_are_bytes_even_where_they_could_be_text(rig: ServiceRig, data: bytes) -> None:
    async with opened_link(rig) as link:
        assert binary(await link.call("Desk", "echo", data, within=WITHIN_S)) == data
        assert binary((await link.call("Desk", "picture", within=WITHIN_S))[2]) == b"\xff\x00"


async def test_a_text_that_looks_like_bytes_stays_a_text(rig: ServiceRig) -> None:
    async with opened_link(rig) as link:
        assert await link.call("Desk", "echo", "b'hello'", within=WITHIN_S) == "b'hello'"


def test_a_number_is_no_picture() -> None:
    with pytest.raises(RobotRefusedError, match="int"):
        binary(3)


async def test_what_the_robot_refuses_is_said_in_one_line(rig: ServiceRig) -> None:
    async with opened_link(rig) as link:
        with pytest.raises(RobotRefusedError, match=r"Desk\.fails: .*no such animation") as raised:
            await link.call("Desk", "fails", within=WITHIN_S)
        assert "\n" not in str(raised.value)
        with pytest.raises(RobotRefusedError, match="nothing"):
            await link.call("Desk", "nothing", within=WITHIN_S)
        with pytest.raises(RobotRefusedError, match=r"Desk\.echo"):
            await link.call("Desk", "echo", within=WITHIN_S)
        with pytest.raises(RobotRefusedError, match="nothing"):
            await link.listen("Desk", "nothing", print)


async def test_a_missing_service_is_found_once_it_is_there(rig: ServiceRig) -> None:
    async with opened_link(rig) as link:
        with pytest.raises(ServiceMissingError, match="Late"):
            await link.call("Late", "echo", 1, within=WITHIN_S)
        assert await link.services(WITHIN_S) == {"ServiceDirectory", "Desk"}
        rig.server.add("Late", methods=[HostedMethod("echo", "(m)", "m", lambda value: value)])
        assert await link.call("Late", "echo", 1, within=WITHIN_S) == 1
        assert "Late" in await link.services(WITHIN_S)


async def test_no_answer_in_time_is_no_loss(rig: ServiceRig) -> None:
    async with opened_link(rig) as link:
        within = 0.05
        while not rig.entered.is_set():  # a busy machine may not even have sent it by then
            with pytest.raises(UnansweredError, match=r"Desk\.waits"):
                await link.call("Desk", "waits", within=within)
            within *= 2
        await happens(rig.cancelled)
        assert not link.lost.done()
        await link.ask(WITHIN_S)


async def test_a_cancelled_call_is_cancelled_on_the_robot(rig: ServiceRig) -> None:
    async with opened_link(rig) as link:
        calling = asyncio.create_task(link.call("Desk", "waits", within=WITHIN_S))
        await happens(rig.entered)
        calling.cancel()
        await happens(rig.cancelled)
        with pytest.raises(asyncio.CancelledError):
            await calling


async def test_signals_are_heard_until_they_are_not_wanted(rig: ServiceRig) -> None:
    async with opened_link(rig) as link:
        touches: asyncio.Queue[tuple[float, str]] = asyncio.Queue()

        def touch(x: float, what: str) -> None:
            touches.put_nowait((x, what))

        forget = await link.listen("Desk", "touched", touch)
        rig.server.emit("Desk", "touched", 0.5, "ä")
        assert await asyncio.wait_for(touches.get(), WITHIN_S) == (0.5, "ä")
        await forget()
        rig.server.emit("Desk", "touched", 0.7, "b")
        await link.ask(WITHIN_S)
        assert touches.empty()


async def test_closing_ends_the_calls_under_way(rig: ServiceRig) -> None:
    async with opened_link(rig) as link:
        calls = [asyncio.create_task(link.call("Desk", "waits", within=WITHIN_S)) for _ in range(3)]
        looking = asyncio.create_task(link.call("Other", "echo", within=WITHIN_S))
        await happens(rig.entered)
        await link.close()
        ends = await asyncio.wait_for(
            asyncio.gather(*calls, looking, return_exceptions=True), WITHIN_S
        )
        assert {type(end) for end in ends} <= {LinkClosedError, ServiceMissingError}
        assert all(isinstance(end, LinkClosedError) for end in ends[:3])
        assert link.lost.done()
        with pytest.raises(LinkClosedError):
            await link.call("Desk", "echo", 1, within=WITHIN_S)
        await link.close()


async def test_a_robot_that_hangs_up_is_known_at_once(rig: ServiceRig) -> None:
    async with opened_link(rig) as link:
        calling = asyncio.create_task(link.call("Desk", "waits", within=WITHIN_S))
        await happens(rig.entered)
        await rig.server.close()
        with pytest.raises(LinkClosedError):
            await calling
        assert await asyncio.wait_for(link.lost, WITHIN_S)


async def test_a_service_that_comes_again_is_looked_up_again(rig: ServiceRig) -> None:
    async with opened_link(rig) as link:
        assert await link.call("Desk", "echo", 1, within=WITHIN_S) == 1
        rig.server.remove("Desk")
        with pytest.raises(RobotRefusedError):
            await link.call("Desk", "echo", 2, within=WITHIN_S)
        rig.offer()

        async def again() -> int:
            while True:
                try:
                    return int(await link.call("Desk", "echo", 3, within=WITHIN_S))
                except RobotRefusedError:
                    await asyncio.sleep(0.01)

        assert await asyncio.wait_for(again(), WITHIN_S) == 3


async def test_it_says_who_carries_it_and_where_from(rig: ServiceRig) -> None:
    async with opened_link(rig) as link:
        assert link.local_host == "127.0.0.1"
        assert link.certificate == ""


async def test_links_leave_no_threads_and_tasks(rig: ServiceRig) -> None:
    async def once() -> None:
        async with opened_link(rig) as link:
            await link.call("Desk", "echo", 1, within=WITHIN_S)

    for _ in range(3):
        await once()
    threads, tasks = threads_now(), len(asyncio.all_tasks())
    for _ in range(10):
        await once()
    async with asyncio.timeout(WITHIN_S):
        while threads_now() > threads or len(asyncio.all_tasks()) > tasks:  # noqa: ASYNC110
            await asyncio.sleep(0.01)


async def test_what_is_not_confirmed_is_given_up_on_our_own_sockets_only(rig: ServiceRig) -> None:
    place = ("127.0.0.1", parse(rig.host).port)

    def limits() -> list[int]:
        """How long each connection to the robot waits for a confirmation, in milliseconds."""
        found = []
        for entry in Path("/proc/self/fd").iterdir():
            with suppress(OSError), socket.socket(fileno=os.dup(int(entry.name))) as held:
                if held.type == socket.SOCK_STREAM and held.getpeername() == place:
                    found.append(held.getsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT))
        return sorted(found)

    with socket.create_connection(place):
        async with opened_link(rig) as link:
            await link.call("Desk", "echo", 1, within=WITHIN_S)
            assert limits() == [0, UNCONFIRMED_MS]
        assert limits() == [0]


@pytest.mark.parametrize(
    ("text", "what", "remedy"),
    [
        ("127.0.0.1:1", "nothing listens on port 1", "NAOqi has started"),
        ("no.such.host.invalid", "no host is called", "chest button"),
        ("p" * 64 + ".local", "no host is called", "chest button"),
    ],
)
async def test_why_a_robot_is_not_reached(text: str, what: str, remedy: str) -> None:
    with pytest.raises(DeviceLostError) as lost:
        await open_link(parse(text), PepperSettings(robots=()))
    assert what in lost.value.what
    assert remedy in lost.value.remedy


async def test_somebody_else_on_the_port_is_no_robot() -> None:
    async def talk(_: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        writer.write(b"SSH-2.0-OpenSSH_9.6\r\n" * 5)
        await writer.drain()

    async with await asyncio.start_server(talk, "127.0.0.1", 0) as server:
        port = server.sockets[0].getsockname()[1]
        with pytest.raises(DeviceLostError) as lost:
            await open_link(Address("127.0.0.1", port), PepperSettings(robots=()), within=1.0)
        assert f"127.0.0.1:{port}" in lost.value.what
        server.close()
