"""The stop over the wire: everything at once, part by part, whatever state the robot is in."""

from __future__ import annotations

import asyncio
from pathlib import Path

import pytest
from woz_drivers.pepper.driver import Pepper
from woz_drivers.pepper.settings import PepperSettings

from tests.drivers.pepper.robot_rig import RobotRig, connected_driver, connected_robot
from tests.drivers.published_messages import PATIENCE_S, PublishedMessages
from tests.fakes.naoqi import stand_in
from woz_tui.bus.bus import Bus
from woz_tui.bus.hub import Hub
from woz_tui.drivers.contract import DeviceLostError, DriverError, Scope
from woz_tui.protocol.messages import (
    Command,
    DriverConnected,
    DriverLost,
    Json,
    Message,
    StopConfirmed,
)

pytestmark = pytest.mark.safety

LONG = "A very long story that nobody wants to hear to its end. " * 60
MUSIC = "/home/nao/sounds/music.mp3"
#: What a stop always ends, whoever began it.
ALWAYS = ("driving", "motion", "sounds", "speech")
#: Slow enough that nothing ends by itself while a test looks.
PACE = 1.0


@pytest.fixture
def unhurried(monkeypatch: pytest.MonkeyPatch) -> None:
    """A busy machine takes its time; that a stop waits no longer is another test's."""
    monkeypatch.setattr("woz_tui.drivers.confirmed_stop.STOP_S", PATIENCE_S)
    monkeypatch.setattr("woz_tui.bus.bus.STOP_WAIT_S", PATIENCE_S)


async def busy(rig: RobotRig) -> None:
    """Let it do everything at once."""
    await rig.do("eyes", color="#102030", animation="intermittent")
    (rig.folder / "film.mp4").write_bytes(b"film" * 1000)
    await rig.robot.set("tablet.video_seconds", 3600)
    await rig.do("screen", file="film.mp4")
    await rig.robot.until(lambda: _film(rig))
    rig.begin("drive", x=5.0)
    await rig.robot.called("ALMotion.moveTo")
    rig.begin("play", move="Waiting/ShowSky_1")
    rig.begin("say", text=LONG)
    rig.begin("sound", file=MUSIC)
    for name in ("ALAnimationPlayer.run", "ALAnimatedSpeech.say", "ALAudioPlayer.play"):
        await rig.robot.called(name)
    await rig.robot.until(lambda: _kinds(rig, {"speech", "animation", "move"}))


async def _film(rig: RobotRig) -> bool:
    return bool((await rig.robot.get("tablet"))["shows"] == "video")


async def _kinds(rig: RobotRig, wanted: set[str]) -> bool:
    return wanted <= {kind for kind, *_ in await rig.robot.get("going")}


async def quiet(rig: RobotRig) -> bool:
    """Whether the robot does nothing any more."""
    kinds = {kind for kind, *_ in await rig.robot.get("going")}
    return not kinds - {"leds", "eyes"} and not any(await rig.robot.get("velocity"))


@pytest.mark.usefixtures("unhurried")
@pytest.mark.naoqi("ALMotion.killAll", "ALMotion.stopMove", "ALTextToSpeech.stopAll")
@pytest.mark.naoqi("ALAudioPlayer.stopAll")
async def test_everything_ends_at_once_and_each_part_confirms(tmp_path: Path) -> None:
    async with connected_robot(tmp_path, pace=PACE) as rig:
        await busy(rig)
        assert not await quiet(rig)
        report = await rig.stop()
        assert report.missing == ()
        assert report.confirmed == tuple(sorted((*ALWAYS, "animations", "eyes", "tablet")))
        assert await quiet(rig)
        assert not await _film(rig)
        await rig.do("say", text="Hello", plain=True)  # and all of it works again
        await rig.do("drive", turn=5)


async def test_parts_are_asked_together_and_none_waits_for_the_answer_of_another(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("woz_tui.drivers.confirmed_stop.STOP_S", 1.0)
    async with connected_robot(tmp_path, pace=PACE) as rig:
        await busy(rig)
        await rig.robot.clear()
        await rig.robot.fault("slow:10000", 5)  # each answer comes long after the stop is over
        report = await rig.stop()
        assert report.confirmed == ()
        ends = {
            "ALMotion.stopMove",
            "ALMotion.killAll",
            "ALTextToSpeech.stopAll",
            "ALAudioPlayer.stopAll",
        }

        async def called() -> bool:
            return {call.name for call in await rig.robot.trace()} >= ends

        await rig.robot.until(called, 8.0)  # no answer has come by then


@pytest.mark.usefixtures("unhurried")
async def test_the_eyes_own_animation_is_covered_by_the_colour_of_before(tmp_path: Path) -> None:
    async with connected_robot(tmp_path) as rig:
        await rig.do("eyes", color="#102030")
        rig.begin("eyes_animation", kind="random", seconds=600)
        await rig.robot.called("ALLeds.randomEyes")
        assert "eyes" in (await rig.stop()).confirmed
        await rig.do("eyes", color="#405060")
        assert await rig.robot.get("eyes.animation") == ""


@pytest.mark.usefixtures("unhurried")
async def test_with_nothing_going_on_the_robots_own_doings_end(tmp_path: Path) -> None:
    async with connected_robot(tmp_path) as rig:
        report = await rig.stop()
        assert (report.confirmed, report.missing) == (ALWAYS, ())


@pytest.mark.usefixtures("unhurried")
async def test_a_part_that_fails_is_named_and_the_others_confirm(tmp_path: Path) -> None:
    async with connected_robot(tmp_path, pace=PACE) as rig:
        rig.begin("say", text=LONG)
        await rig.robot.called("ALAnimatedSpeech.say")
        await rig.robot.fault("refuse:ALTextToSpeech.stopAll=cannot")
        report = await rig.stop()
        assert report.missing == ("speech",)
        assert set(report.confirmed) == {*ALWAYS} - {"speech"}


@pytest.mark.usefixtures("unhurried")
async def test_a_part_that_fails_when_it_is_asked_once_more_has_not_confirmed(
    tmp_path: Path,
) -> None:
    async with connected_robot(tmp_path) as rig:
        await rig.robot.fault("refuse-again:ALTextToSpeech.stopAll=cannot")
        report = await rig.stop()
        assert report.missing == ("speech",)
        assert set(report.confirmed) == {*ALWAYS} - {"speech"}


@pytest.mark.usefixtures("unhurried")
async def test_an_animation_that_has_ended_already_confirms_too(tmp_path: Path) -> None:
    async with connected_robot(tmp_path, pace=PACE) as rig:
        rig.begin("play", move="Waiting/ShowSky_1")
        await rig.robot.until(lambda: _kinds(rig, {"animation"}))
        await rig.robot.fault("refuse:ALBehaviorManager.stopBehavior=it is not running")
        assert "animations" in (await rig.stop()).confirmed
        assert await quiet(rig)


async def test_a_frozen_robot_holds_nobody_up_and_ends_what_it_did_when_it_wakes(
    tmp_path: Path,
) -> None:
    async with connected_robot(tmp_path, pace=PACE) as rig:
        await busy(rig)
        await rig.robot.clear()
        rig.robot.freeze()
        report = await asyncio.wait_for(rig.stop(), PATIENCE_S)
        assert report.confirmed == ()
        assert {*ALWAYS, "animations"} <= set(report.missing)
        rig.robot.thaw()
        for name in ("ALMotion.killAll", "ALMotion.stopMove", "ALTextToSpeech.stopAll"):
            await rig.robot.called(name)
        await rig.robot.until(lambda: quiet(rig))


async def test_a_late_robot_is_named_and_still_stopped(tmp_path: Path) -> None:
    async with connected_robot(tmp_path, pace=PACE) as rig:
        rig.begin("drive", x=5.0)
        await rig.robot.called("ALMotion.moveTo")
        await rig.robot.fault("slow:700", 5)
        report = await rig.stop()
        assert "driving" in report.missing
        await rig.robot.until(lambda: quiet(rig))


async def test_a_lost_robot_confirms_nothing_until_it_is_there_again(tmp_path: Path) -> None:
    async with connected_robot(tmp_path) as rig:
        rig.robot.kill()
        await rig.published.first(DriverLost)
        await rig.tells(lambda settings_shown: set(settings_shown.values) == {"robot"})
        report = await rig.stop()
        assert report.confirmed == ()
        assert set(report.missing) == {"driving", "motion"}
        report = await rig.stop(Scope.DRIVE)
        assert report.missing == ("driving",)


async def test_a_robot_that_was_let_go_or_never_there_has_nothing_to_stop(tmp_path: Path) -> None:
    async with connected_robot(tmp_path) as rig:
        await rig.do("disconnect")
        assert await rig.driver.stop(Scope.ALL) is None
        with pytest.raises(DeviceLostError):
            await rig.do("say", text="Hello")
    settings = PepperSettings(robots=("tcp://127.0.0.1:1",))
    driver = Pepper("it", settings, PublishedMessages(tmp_path).context)
    await driver.open()
    assert await driver.stop(Scope.ALL) is None
    await driver.close()


@pytest.mark.usefixtures("unhurried", "patient")
async def test_the_bus_ends_the_jobs_and_names_the_parts(tmp_path: Path) -> None:
    async with stand_in(pace=PACE) as robot:
        rig = await connected_driver(robot, tmp_path, PepperSettings(robots=(robot.address,)))
        told: list[Message] = []
        hub = Hub(rig.published.clock, lambda message, line: None)
        hub.listen(told.append)
        bus = Bus(hub, {"it": rig.driver}, {"it": Pepper.offer(PepperSettings(robots=())).verbs})
        hub.publish(DriverConnected(driver="it"))
        for verb, value in (("say", LONG), ("drive", 5.0), ("play", "Waiting/ShowSky_1")):
            args: dict[str, Json] = {
                "text" if verb == "say" else "x" if verb == "drive" else "move": value
            }
            command = Command(command=verb, driver="it", verb=verb, args=args, source="key")
            bus.submit(command)
            await robot.until(lambda: _kinds(rig, {"speech"}))
        await robot.until(lambda: _kinds(rig, {"speech", "move", "animation"}))
        await bus.stop("key")
        (confirmed,) = [one for one in told if isinstance(one, StopConfirmed)]
        assert (confirmed.confirmed, confirmed.missing) == (["it"], [])
        assert confirmed.parts == {"it": sorted((*ALWAYS, "animations"))}
        assert await quiet(rig)
        bus.release("key")
        await bus.drain(2)
        await rig.close()


async def test_a_drive_that_a_stop_cut_short_does_not_begin_later(tmp_path: Path) -> None:
    async with connected_robot(tmp_path) as rig:
        job = rig.begin("drive", x=5.0)  # it has not even been sent
        await rig.stop()
        assert job.cancelled()
        with pytest.raises(DriverError):
            await rig.do("pose", joints={"HeadYaw": 500})
        assert await rig.calls("ALMotion.moveTo") == []
