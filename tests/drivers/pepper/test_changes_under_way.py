"""Changing the robot while things happen: a stop in between, a mistyped address, what failed."""

from __future__ import annotations

import asyncio
import gc
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from naoqi_simulator.robot import NaoqiSimulator as Standing
from naoqi_simulator.robot_time import PacedTime
from naoqi_simulator.service_table import Service, ServiceMethod
from naoqi_simulator.simulator_process import start
from naoqi_simulator.world import SimulatedWorld, SimulatorOptions
from woz_drivers.naoqi_robot.address import parse
from woz_drivers.naoqi_robot.link import open_link
from woz_drivers.naoqi_robot.settings import AutonomySettings
from woz_drivers.pepper.driver import Pepper
from woz_drivers.pepper.settings import PepperSettings
from woz_drivers.sound.live_talk import TalkSettings

from tests.drivers.pepper.connection_rig import started_connection
from tests.drivers.pepper.robot_rig import connected_robot
from tests.drivers.published_messages import BusJob, PublishedMessages, until
from tests.fakes.naoqi import stand_in, stand_in_here
from woz_tui.drivers.contract import DeviceLostError, DriverError, Health, RejectedError, Scope
from woz_tui.drivers.sound_feeds import VOICE, VOICE_STATE, SoundWindow, VoiceState
from woz_tui.protocol.messages import DriverConnected, Notice


@pytest.mark.parametrize("turns", range(8))
async def test_a_stop_while_a_robot_is_let_go_leaves_no_driver_without_one(
    tmp_path: Path, turns: int
) -> None:
    async with (
        stand_in_here() as one,
        stand_in_here() as other,
        started_connection(tmp_path, one.address) as rig,
    ):
        await rig.is_so(Health.CONNECTED)
        taking = asyncio.create_task(rig.connection.connect(other.address))
        for _ in range(turns):
            await asyncio.sleep(0)
        taking.cancel()
        await asyncio.wait([taking])
        if turns:  # else it had not begun
            await rig.is_so(Health.CONNECTED, parse(other.address).shown)
        assert await rig.connection.call("ALSystem", "robotName") == "Pepper"


async def test_a_change_that_a_stop_cut_short_does_not_outlive_the_session(tmp_path: Path) -> None:
    async with stand_in_here() as one, started_connection(tmp_path, one.address) as rig:
        await rig.is_so(Health.CONNECTED)
        tasks = [asyncio.create_task(rig.connection.connect()) for _ in range(3)]
        await asyncio.sleep(0)
        for task in tasks:
            task.cancel()
        await rig.connection.close()
        await asyncio.gather(*tasks, return_exceptions=True)
        with pytest.raises(DeviceLostError, match="session is over"):
            await rig.connection.connect()


async def test_what_is_no_address_costs_nobody_the_stop(tmp_path: Path) -> None:
    async with connected_robot(tmp_path, pace=2.0) as rig:
        with pytest.raises(RejectedError):
            await rig.do("connect", robot="tcp://nao:secret@10.0.0.1")
        rig.begin("naoqi_drive", call="ALMotion.moveTo", args="[3.0, 0.0, 0.0]")
        await rig.robot.called("ALMotion.moveTo")
        report = await rig.stop()
        assert "driving" in (*report.confirmed, *report.missing)
        await rig.robot.called("ALMotion.killAll")


@pytest.mark.usefixtures("unhurried_stop")
async def test_a_robot_that_is_let_go_begins_nothing_more(tmp_path: Path) -> None:
    async with connected_robot(tmp_path, pace=2.0) as rig:
        (rig.folder / "long.txt").write_text("\n\n".join(["word " * 40] * 9))
        rig.begin("read", file="long.txt")
        await rig.robot.called("ALAnimatedSpeech.say")
        leaving = rig.begin("disconnect")
        driving = rig.begin("drive", x=3.0)
        with pytest.raises(DeviceLostError):
            await driving
        await leaving
        assert len(await rig.calls("ALAnimatedSpeech.say")) == 1
        assert not await rig.calls("ALMotion.moveTo")

        async def is_idle() -> bool:
            return not await rig.robot.get("going")

        await rig.robot.until(is_idle)


async def test_a_robot_that_is_let_go_without_confirming_is_told_of(tmp_path: Path) -> None:
    async with connected_robot(tmp_path) as rig:
        rig.robot.freeze()
        await rig.do("disconnect")
        assert [text for text in rig.notices if "did not confirm its stop: driving" in text]


@pytest.mark.usefixtures("unhurried_stop")
@pytest.mark.parametrize("kind", ["pepper", "nao"])
async def test_a_robot_that_is_let_go_ends_whatever_it_does(tmp_path: Path, kind: str) -> None:
    async with connected_robot(tmp_path, kind=kind, pace=2.0, talk=TalkSettings()) as rig:
        rig.begin("eyes_animation", kind="random", seconds=40.0)
        rig.begin("drive", x=3.0)
        rig.begin("say", text="word " * 40)
        rig.begin("talk")
        feed = rig.published.context.feed(VOICE_STATE)
        await until(lambda: isinstance(s := feed.latest().value, VoiceState) and s.on)
        window = SoundWindow(rig.published.context.feed(VOICE), 16_000)
        window.add(b"\1\2" * 320, rig.published.clock.now_us(), "con7")
        await rig.robot.called("ALAudioDevice.sendRemoteBufferToOutput")
        await rig.robot.called("ALLeds.randomEyes")
        await rig.robot.called("ALMotion.moveTo")
        await rig.do("disconnect")
        assert not [text for text in rig.notices if "did not confirm" in text]
        assert (await rig.robot.get("sound.output"))["flushed"] > 0


@pytest.mark.usefixtures("patient", "unhurried_stop")
async def test_letting_go_while_settings_are_applied_is_no_trouble(tmp_path: Path) -> None:
    async with stand_in() as robot:
        published = PublishedMessages(tmp_path)
        one_by_one = AutonomySettings(awareness=True, blinking=True, head_breathing=True)
        settings = PepperSettings(robots=(robot.address,), autonomy=one_by_one)
        driver = Pepper("it", settings, published.context)
        await robot.fault("slow:100")
        await driver.open()
        await robot.called("ALBasicAwareness.setEnabled")
        await driver.perform(BusJob("disconnect", {}))
        await driver.close()
        told = [notice.text for notice in published.all(Notice) if notice.level != "info"]
        assert not [text for text in told if "autonomous life is" not in text]  # which it was


async def test_a_change_that_a_stop_ends_at_once_leaves_the_robot_playable(tmp_path: Path) -> None:
    async with connected_robot(tmp_path, pace=2.0) as rig:
        rig.begin("naoqi_drive", call="ALMotion.moveTo", args="[3.0, 0.0, 0.0]")
        await rig.robot.called("ALMotion.moveTo")
        leaving = rig.begin("disconnect")
        await asyncio.sleep(0)
        await rig.cancel(leaving)
        await rig.do("say", text="Still here")


async def test_a_colour_that_failed_is_not_shown_at_the_next_connection(tmp_path: Path) -> None:
    async with connected_robot(tmp_path) as rig:
        await rig.do("eyes", color="#008000")
        await rig.robot.fault("refuse:ALLeds.fadeRGB=not now")
        with pytest.raises(DriverError):
            await rig.do("eyes", color="red")
        await rig.robot.clear()
        await rig.do("connect", robot="")
        faded = await rig.calls("ALLeds.fadeRGB")
        assert faded
        assert not [call for call in faded if call[1] > 0], "red came after all"


async def test_a_robot_that_wakes_takes_connections_again() -> None:
    settings = PepperSettings(robots=())
    async with stand_in() as robot:
        robot.freeze()
        for _ in range(2):
            with pytest.raises(DeviceLostError):
                await open_link(parse(robot.address), settings, within=0.2)
        robot.thaw()
        link = await open_link(parse(robot.address), settings, within=20.0)
        assert "ALMotion" in await link.services(20.0)
        await link.close()


@pytest.mark.usefixtures("unhurried_stop")
async def test_what_begins_behind_the_stop_that_overtook_it_is_ended_too(tmp_path: Path) -> None:
    pepper = Standing(SimulatedWorld(PacedTime(1.0), SimulatorOptions(visitors=False)))
    entered, asked, overtaken = pepper.world.desk.enter, asyncio.Event(), asyncio.Event()

    async def enter(service: Service, method: ServiceMethod, args: Sequence[Any]) -> Any:
        if method.name == "goToPosture":
            asked.set()
            await overtaken.wait()
        value = await entered(service, method, args)
        if method.name == "killAll":
            overtaken.set()
        return value

    pepper.world.desk.enter = enter  # type: ignore[method-assign]
    host, address = await start(pepper)
    published = PublishedMessages(tmp_path)
    driver = Pepper("it", PepperSettings(robots=(address,)), published.context)
    await driver.open()
    await published.first(DriverConnected)
    going = asyncio.create_task(driver.perform(BusJob("posture", {"name": "Crouch"})))
    await asked.wait()
    report = await driver.stop(Scope.ALL)
    assert report is not None
    assert "motion" in report.confirmed
    with pytest.raises(DriverError, match="not reached"):
        await asyncio.wait_for(going, 20.0)
    await driver.close()
    await host.close()


async def test_a_robot_without_a_player_confirms_its_stop(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("woz_drivers.naoqi_robot.line._COMES_WITHIN_S", 0.1)
    pepper = Standing(SimulatedWorld(PacedTime(20.0), SimulatorOptions(visitors=False)))
    pepper.services = {
        name: one for name, one in pepper.services.items() if name != "ALAudioPlayer"
    }
    host, address = await start(pepper)
    published = PublishedMessages(tmp_path)
    driver = Pepper("it", PepperSettings(robots=(address,)), published.context)
    await driver.open()
    assert "without ALAudioPlayer" in (await published.first(DriverConnected)).detail
    report = await driver.stop(Scope.ALL)
    assert report is not None
    assert "sounds" not in (*report.confirmed, *report.missing)
    await driver.close()
    await host.close()


async def test_a_stop_that_is_answered_too_late_leaves_nothing_unread(tmp_path: Path) -> None:
    unread: list[dict[str, Any]] = []
    asyncio.get_running_loop().set_exception_handler(lambda _, what: unread.append(what))
    async with connected_robot(tmp_path, hurried=True) as rig:
        rig.robot.freeze()
        report = await rig.stop()
        assert {"driving", "motion", "sounds", "speech"} <= set(report.missing)
        await rig.published.until(lambda: not rig.driver._link.ready)
        await rig.published.until(lambda: not rig.driver._stops)
        gc.collect()
        assert unread == []
