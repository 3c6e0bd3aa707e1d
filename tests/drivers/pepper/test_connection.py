"""The connection over the wire: taken, changed, let go, found again, with both clients."""

from __future__ import annotations

import asyncio
import os
from collections.abc import AsyncIterator
from pathlib import Path

import pytest
from qimessaging.server import QiServer
from woz_drivers.naoqi_robot import connection as module
from woz_drivers.naoqi_robot.connection import RobotConnection
from woz_drivers.naoqi_robot.line import ESSENTIAL
from woz_drivers.pepper.model import PEPPER

from tests.drivers.pepper.connection_rig import (
    SETTINGS,
    WITHIN_S,
    is_lost,
    started_connection,
    threads_now,
)
from tests.drivers.published_messages import PublishedMessages
from tests.fakes.naoqi import StandIn, stand_in
from woz_tui.drivers.contract import DeviceLostError, DriverError, Health, RejectedError
from woz_tui.protocol.messages import DriverFaulted, Notice

pytestmark = pytest.mark.usefixtures("patient")


@pytest.fixture
async def bare() -> AsyncIterator[str]:
    """The address of a robot in this loop that has all services, and nothing in them."""
    server = QiServer()
    endpoint = await server.listen("127.0.0.1")
    for name in sorted(PEPPER.services):
        server.add(name)
    yield str(endpoint)
    await server.close()


async def test_it_begins_with_the_first_robot(robot: StandIn, tmp_path: Path) -> None:
    async with started_connection(tmp_path, robot.address, "127.0.0.1:1") as rig:
        await rig.is_so(Health.CONNECTED, f"127.0.0.1:{robot.port}")
        assert rig.connection.ready
        assert rig.connection.robot == f"127.0.0.1:{robot.port}"
        assert rig.connection.local_host == "127.0.0.1"
        assert rig.came == 1
        await rig.connection.probe()
        assert await rig.connection.call("ALSystem", "robotName") == "Pepper"
        with pytest.raises(DriverError, match=r"ALMotion\.moveTo") as raised:
            await rig.connection.call("ALMotion", "moveTo", "x")
        assert not isinstance(raised.value, DeviceLostError)
        with pytest.raises(DriverError, match="no service ALNothing") as missing:
            await rig.connection.call("ALNothing", "say")
        assert missing.value.remedy
        # The very first connection leaves the robot as it is.
        assert not await robot.trace("ALMotion.stopMove", "ALTextToSpeech.stopAll")


async def test_a_robot_hosted_by_our_own_server(tmp_path: Path) -> None:
    async with stand_in("own") as robot, started_connection(tmp_path, robot.address) as rig:
        await rig.is_so(Health.CONNECTED)
        assert await rig.connection.call("ALSystem", "robotName") == "Pepper"
        saying = rig.begin("ALTextToSpeech", "say", "word " * 500, within=60)
        await robot.called("ALTextToSpeech.say")
        robot.kill()
        assert is_lost(await saying)


async def test_signals_are_heard(robot: StandIn, tmp_path: Path) -> None:
    async with started_connection(tmp_path, robot.address) as rig:
        await rig.is_so(Health.CONNECTED)
        touches: list[tuple[float, float]] = []
        forget = await rig.connection.listen(
            "ALTabletService", "onTouchDownRatio", lambda x, y, _: touches.append((x, y))
        )
        await robot.touch(0.25, 0.5)
        await rig.until(lambda: touches == [(0.25, 0.5)])
        await forget()


async def test_it_waits_for_the_wizard_where_the_file_says_so(bare: str, tmp_path: Path) -> None:
    async with started_connection(tmp_path, bare, connect=False) as rig:
        await rig.is_so(Health.LOST, "no robot", "connect")
        with pytest.raises(DeviceLostError):
            await rig.connection.call("ALSystem", "robotName")
        await rig.connection.connect()
        await rig.is_so(Health.CONNECTED)
        assert rig.connection.ready


async def test_another_robot_is_taken(robot: StandIn, tmp_path: Path) -> None:
    async with stand_in() as other, started_connection(tmp_path, robot.address) as rig:
        await rig.is_so(Health.CONNECTED)
        saying = rig.begin("ALTextToSpeech", "say", "word " * 500, within=60)
        await robot.called("ALTextToSpeech.say")
        await rig.connection.connect(other.address)
        said = await saying
        assert is_lost(said)
        assert f"127.0.0.1:{other.port} is being connected" in str(said.error)
        await rig.is_so(Health.CONNECTED, f"127.0.0.1:{other.port}")
        assert (rig.came, rig.went) == (2, 1)
        await rig.connection.call("ALSystem", "systemVersion")
        assert await other.trace("ALSystem.systemVersion")
        assert not await robot.trace("ALSystem.systemVersion")
        # Back again: this one may still be doing what it did.
        await rig.connection.connect(robot.address)
        assert await robot.trace("ALTextToSpeech.stopAll")


async def test_let_go_it_stays_away(bare: str, tmp_path: Path) -> None:
    async with started_connection(tmp_path, bare) as rig:
        await rig.is_so(Health.CONNECTED)
        await rig.connection.disconnect("the wizard")
        await rig.is_so(Health.LOST, "disconnected by the wizard", "connect")
        assert rig.went == 1
        assert rig.connection.robot == ""
        with pytest.raises(DeviceLostError, match="disconnected by the wizard"):
            await rig.connection.call("ALSystem", "robotName")
        assert not [task for task in asyncio.all_tasks() if "keeping" in repr(task.get_coro())]
        await rig.connection.connect(bare)
        assert rig.came == 2


async def test_who_waits_for_a_robot_that_is_let_go_is_told(tmp_path: Path) -> None:
    async with await asyncio.start_server(lambda *_: None, "127.0.0.1", 0) as mute:
        port = mute.sockets[0].getsockname()[1]
        async with started_connection(tmp_path) as rig:
            waiting = asyncio.create_task(rig.connection.connect(f"127.0.0.1:{port}"))
            await rig.is_so(Health.CONNECTING)
            await rig.connection.disconnect("the wizard")
            with pytest.raises(DeviceLostError, match="disconnected by the wizard"):
                await waiting


async def test_a_mistake_of_this_program_does_not_end_it_in_silence(
    bare: str, tmp_path: Path
) -> None:
    published = PublishedMessages(tmp_path)

    async def applied() -> None: ...

    def mistaken() -> None:
        raise ZeroDivisionError

    connection = RobotConnection(
        SETTINGS, published.context, on_connected=applied, on_lost=mistaken
    )
    await connection.connect(bare)
    await connection.disconnect("the wizard")
    driver_faulted = await published.first(DriverFaulted)
    assert "ZeroDivisionError" in driver_faulted.detail
    assert driver_faulted.remedy
    await connection.close()


async def test_what_is_no_address_changes_nothing(bare: str, tmp_path: Path) -> None:
    async with started_connection(tmp_path, bare) as rig:
        await rig.is_so(Health.CONNECTED)
        with pytest.raises(RejectedError):
            await rig.connection.connect("http://pepper")
        assert rig.connection.ready


async def test_a_file_with_a_wrong_address_is_told_of(tmp_path: Path) -> None:
    async with started_connection(tmp_path, "nao:Hush@pepper") as rig:
        await rig.is_so(Health.FAULTED, "password must not stand", "WOZ_PEPPER_PASSWORD")
        assert "Hush" not in str(rig.published.messages)


async def test_a_robot_that_is_not_there_is_looked_for(tmp_path: Path, port: int) -> None:
    async with started_connection(tmp_path) as rig:
        with pytest.raises(DeviceLostError, match=f"nothing listens on port {port}"):
            await rig.connection.connect(f"127.0.0.1:{port}")
        await rig.is_so(Health.LOST, "nothing listens")
        async with stand_in(port=port):
            await rig.is_so(Health.CONNECTED)


async def test_services_that_come_one_by_one_are_waited_for(tmp_path: Path) -> None:
    server = QiServer()
    endpoint = await server.listen("127.0.0.1")
    server.add("ALMemory")
    async with started_connection(tmp_path, str(endpoint)) as rig:
        await rig.is_so(Health.CONNECTING, "is starting: waiting for", "ALMotion")
        with pytest.raises(DeviceLostError, match="is starting"):
            await rig.connection.call("ALMemory", "getData", "x")
        for name in sorted(PEPPER.services - {"ALMemory"}):
            server.add(name)
        await rig.is_so(Health.CONNECTED)
        assert "without" not in rig.health()[1]
    await server.close()


async def test_a_robot_that_goes_while_it_starts_was_never_there(tmp_path: Path) -> None:
    server = QiServer()
    endpoint = await server.listen("127.0.0.1")
    server.add("ALMemory")
    async with started_connection(tmp_path, str(endpoint)) as rig:
        await rig.is_so(Health.CONNECTING, "is starting")
        await server.close()
        await rig.is_so(Health.LOST)
        assert (rig.came, rig.went) == (0, 0)


async def test_a_robot_without_some_services_is_played_even_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("woz_drivers.naoqi_robot.line._COMES_WITHIN_S", 0.3)
    server = QiServer()
    endpoint = await server.listen("127.0.0.1")
    for name in sorted(ESSENTIAL):
        server.add(name)
    async with started_connection(tmp_path, str(endpoint)) as rig:
        await rig.is_so(Health.CONNECTED, "without", "ALTabletService")
        # The next time nobody waits for what was not there.
        monkeypatch.setattr("woz_drivers.naoqi_robot.line._COMES_WITHIN_S", 3600.0)
        await rig.connection.connect(str(endpoint))
        assert rig.came == 2
    await server.close()


async def test_a_wrong_password_is_not_tried_again_and_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROBOT_PASSWORD", "Hush!42")
    asked: list[str] = []

    def refuse(user: str, _: str) -> bool:
        asked.append(user)
        return False

    server = QiServer(authenticator=refuse)
    endpoint = await server.listen("127.0.0.1")
    async with started_connection(
        tmp_path, str(endpoint), password="ROBOT_PASSWORD", connect=False
    ) as rig:
        with pytest.raises(DeviceLostError):
            await rig.connection.connect()
        await rig.is_so(Health.FAULTED, "password", "ROBOT_PASSWORD")
        await rig.until(lambda: len(asyncio.all_tasks()) == 1)
        assert len(asked) == 1
        assert "Hush" not in str(rig.published.messages)
    await server.close()


@pytest.mark.parametrize("failure", [DriverError("no colour", "give one"), TimeoutError()])
async def test_parts_that_fail_to_apply_are_told_of(
    bare: str, tmp_path: Path, failure: Exception, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "_APPLIED_WITHIN_S", 0.05)
    published = PublishedMessages(tmp_path)

    async def apply() -> None:
        if isinstance(failure, DriverError):
            raise failure
        await asyncio.sleep(3600)

    connection = RobotConnection(
        SETTINGS, published.context, on_connected=apply, on_lost=lambda: None
    )
    await connection.connect(bare)
    notice = await published.first(Notice)
    assert notice.level == "warning"
    assert notice.remedy
    assert connection.ready
    await connection.close()


def open_files() -> int:
    return len(list(Path("/proc/self/fd").iterdir()))


async def test_nothing_is_left_after_the_end(robot: StandIn, tmp_path: Path) -> None:
    async with started_connection(tmp_path, robot.address) as rig:
        await rig.is_so(Health.CONNECTED)
    threads, files = threads_now(), open_files()
    async with started_connection(tmp_path, robot.address) as rig:
        await rig.is_so(Health.CONNECTED)
        saying = rig.begin("ALTextToSpeech", "say", "word " * 500, within=60)
        await robot.called("ALTextToSpeech.say")
        robot.freeze()
        # Closing asks nothing of the robot: this would wait for ever otherwise.
        await asyncio.wait_for(rig.connection.close(), WITHIN_S)
        assert is_lost(await saying)
        assert len(asyncio.all_tasks()) == 1
        await rig.connection.close()
    await rig.until(lambda: threads_now() <= threads)
    await rig.until(lambda: open_files() <= files)


async def test_the_simulated_robot_lives_as_long_as_it_is_played(tmp_path: Path) -> None:
    def children() -> set[int]:
        found = Path(f"/proc/{os.getpid()}/task/{os.getpid()}/children").read_text().split()
        lines = {number: Path(f"/proc/{number}/cmdline").read_bytes() for number in found}
        return {int(number) for number, line in lines.items() if b"naoqi_simulator" in line}

    before = children()
    async with started_connection(tmp_path, "simulated", pace=20.0) as rig:
        await rig.is_so(Health.CONNECTED, "simulated")
        (first,) = children() - before
        os.kill(first, 9)
        await rig.is_so(Health.LOST, "simulated")
        await rig.is_so(Health.CONNECTED, "simulated")
        (second,) = children() - before
        assert second != first
    assert children() == before
