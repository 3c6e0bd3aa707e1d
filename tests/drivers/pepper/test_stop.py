"""The stop over the wire: everything at once, part by part, whatever state the robot is in."""

from __future__ import annotations

import asyncio
from pathlib import Path

import pytest
from woz_drivers.pepper.driver import Pepper
from woz_drivers.pepper.settings import PepperSettings

from tests.drivers.heard import PATIENCE_S, Heard
from tests.drivers.pepper.played import Played, joined, played
from tests.fakes.naoqi import stand_in
from woz_tui.bus.bus import Bus
from woz_tui.bus.hub import Hub
from woz_tui.drivers.contract import DeviceLostError, DriverError, Scope
from woz_tui.protocol.messages import (
    AnyMessage,
    Command,
    DriverConnected,
    DriverLost,
    Json,
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
    monkeypatch.setattr("woz_drivers.confirmed_stop.STOP_S", PATIENCE_S)
    monkeypatch.setattr("woz_tui.bus.bus.STOP_WAIT_S", PATIENCE_S)


async def busy(it: Played) -> None:
    """Let it do everything at once."""
    await it.do("eyes", color="#102030", animation="intermittent")
    (it.folder / "film.mp4").write_bytes(b"film" * 1000)
    await it.robot.set("tablet.video_seconds", 3600)
    await it.do("screen", file="film.mp4")
    await it.robot.until(lambda: _film(it))
    it.begin("drive", x=5.0)
    await it.robot.called("ALMotion.moveTo")
    it.begin("play", move="Waiting/ShowSky_1")
    it.begin("say", text=LONG)
    it.begin("sound", file=MUSIC)
    for name in ("ALAnimationPlayer.run", "ALAnimatedSpeech.say", "ALAudioPlayer.play"):
        await it.robot.called(name)
    await it.robot.until(lambda: _kinds(it, {"speech", "animation", "move"}))


async def _film(it: Played) -> bool:
    return bool((await it.robot.get("tablet"))["shows"] == "video")


async def _kinds(it: Played, wanted: set[str]) -> bool:
    return wanted <= {kind for kind, *_ in await it.robot.get("going")}


async def quiet(it: Played) -> bool:
    """Whether the robot does nothing any more."""
    kinds = {kind for kind, *_ in await it.robot.get("going")}
    return not kinds - {"leds", "eyes"} and not any(await it.robot.get("velocity"))


@pytest.mark.usefixtures("unhurried")
@pytest.mark.naoqi("ALMotion.killAll", "ALMotion.stopMove", "ALTextToSpeech.stopAll")
@pytest.mark.naoqi("ALAudioPlayer.stopAll")
async def test_everything_ends_at_once_and_each_part_confirms(tmp_path: Path) -> None:
    async with played(tmp_path, pace=PACE) as it:
        await busy(it)
        assert not await quiet(it)
        report = await it.stop()
        assert report.missing == ()
        assert report.confirmed == tuple(sorted((*ALWAYS, "animations", "eyes", "tablet")))
        assert await quiet(it)
        assert not await _film(it)
        await it.do("say", text="Hello", plain=True)  # and all of it works again
        await it.do("drive", turn=5)


async def test_parts_are_asked_together_and_none_waits_for_the_answer_of_another(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("woz_drivers.confirmed_stop.STOP_S", 1.0)
    async with played(tmp_path, pace=PACE) as it:
        await busy(it)
        await it.robot.clear()
        await it.robot.fault("slow:10000", 5)  # each answer comes long after the stop is over
        report = await it.stop()
        assert report.confirmed == ()
        ends = {
            "ALMotion.stopMove",
            "ALMotion.killAll",
            "ALTextToSpeech.stopAll",
            "ALAudioPlayer.stopAll",
        }

        async def called() -> bool:
            return {call.name for call in await it.robot.trace()} >= ends

        await it.robot.until(called, 8.0)  # no answer has come by then


@pytest.mark.usefixtures("unhurried")
async def test_the_eyes_own_animation_is_covered_by_the_colour_of_before(tmp_path: Path) -> None:
    async with played(tmp_path) as it:
        await it.do("eyes", color="#102030")
        it.begin("eyes_animation", kind="random", seconds=600)
        await it.robot.called("ALLeds.randomEyes")
        assert "eyes" in (await it.stop()).confirmed
        await it.do("eyes", color="#405060")
        assert await it.robot.get("eyes.animation") == ""


@pytest.mark.usefixtures("unhurried")
async def test_with_nothing_going_on_the_robots_own_doings_end(tmp_path: Path) -> None:
    async with played(tmp_path) as it:
        report = await it.stop()
        assert (report.confirmed, report.missing) == (ALWAYS, ())


@pytest.mark.usefixtures("unhurried")
async def test_a_part_that_fails_is_named_and_the_others_confirm(tmp_path: Path) -> None:
    async with played(tmp_path, pace=PACE) as it:
        it.begin("say", text=LONG)
        await it.robot.called("ALAnimatedSpeech.say")
        await it.robot.fault("refuse:ALTextToSpeech.stopAll=cannot")
        report = await it.stop()
        assert report.missing == ("speech",)
        assert set(report.confirmed) == {*ALWAYS} - {"speech"}


@pytest.mark.usefixtures("unhurried")
async def test_a_part_that_fails_when_it_is_asked_once_more_has_not_confirmed(
    tmp_path: Path,
) -> None:
    async with played(tmp_path) as it:
        await it.robot.fault("refuse-again:ALTextToSpeech.stopAll=cannot")
        report = await it.stop()
        assert report.missing == ("speech",)
        assert set(report.confirmed) == {*ALWAYS} - {"speech"}


@pytest.mark.usefixtures("unhurried")
async def test_an_animation_that_has_ended_already_confirms_too(tmp_path: Path) -> None:
    async with played(tmp_path, pace=PACE) as it:
        it.begin("play", move="Waiting/ShowSky_1")
        await it.robot.until(lambda: _kinds(it, {"animation"}))
        await it.robot.fault("refuse:ALBehaviorManager.stopBehavior=it is not running")
        assert "animations" in (await it.stop()).confirmed
        assert await quiet(it)


async def test_a_frozen_robot_holds_nobody_up_and_ends_what_it_did_when_it_wakes(
    tmp_path: Path,
) -> None:
    async with played(tmp_path, pace=PACE) as it:
        await busy(it)
        await it.robot.clear()
        it.robot.freeze()
        report = await asyncio.wait_for(it.stop(), PATIENCE_S)
        assert report.confirmed == ()
        assert {*ALWAYS, "animations"} <= set(report.missing)
        it.robot.thaw()
        for name in ("ALMotion.killAll", "ALMotion.stopMove", "ALTextToSpeech.stopAll"):
            await it.robot.called(name)
        await it.robot.until(lambda: quiet(it))


async def test_a_late_robot_is_named_and_still_stopped(tmp_path: Path) -> None:
    async with played(tmp_path, pace=PACE) as it:
        it.begin("drive", x=5.0)
        await it.robot.called("ALMotion.moveTo")
        await it.robot.fault("slow:700", 5)
        report = await it.stop()
        assert "driving" in report.missing
        await it.robot.until(lambda: quiet(it))


async def test_a_lost_robot_confirms_nothing_until_it_is_there_again(tmp_path: Path) -> None:
    async with played(tmp_path) as it:
        it.robot.kill()
        await it.heard.first(DriverLost)
        await it.tells(lambda shown: set(shown.values) == {"robot"})
        report = await it.stop()
        assert report.confirmed == ()
        assert set(report.missing) == {"driving", "motion"}
        report = await it.stop(Scope.DRIVE)
        assert report.missing == ("driving",)


async def test_a_robot_that_was_let_go_or_never_there_has_nothing_to_stop(tmp_path: Path) -> None:
    async with played(tmp_path) as it:
        await it.do("disconnect")
        assert await it.driver.stop(Scope.ALL) is None
        with pytest.raises(DeviceLostError):
            await it.do("say", text="Hello")
    settings = PepperSettings(robots=("tcp://127.0.0.1:1",))
    driver = Pepper("it", settings, Heard(tmp_path).context)
    await driver.open()
    assert await driver.stop(Scope.ALL) is None
    await driver.close()


@pytest.mark.usefixtures("unhurried", "patient")
async def test_the_bus_ends_the_jobs_and_names_the_parts(tmp_path: Path) -> None:
    async with stand_in(pace=PACE) as robot:
        it = await joined(robot, tmp_path, PepperSettings(robots=(robot.address,)))
        told: list[AnyMessage] = []
        hub = Hub(it.heard.clock, lambda message, line: None)
        hub.listen(told.append)
        bus = Bus(hub, {"it": it.driver}, {"it": Pepper.verbs(PepperSettings(robots=()))})
        hub.publish(DriverConnected(driver="it"))
        for verb, value in (("say", LONG), ("drive", 5.0), ("play", "Waiting/ShowSky_1")):
            args: dict[str, Json] = {
                "text" if verb == "say" else "x" if verb == "drive" else "move": value
            }
            command = Command(command=verb, driver="it", verb=verb, args=args, source="key")
            bus.submit(command)
            await robot.until(lambda: _kinds(it, {"speech"}))
        await robot.until(lambda: _kinds(it, {"speech", "move", "animation"}))
        await bus.stop("key")
        (confirmed,) = [one for one in told if isinstance(one, StopConfirmed)]
        assert (confirmed.confirmed, confirmed.missing) == (["it"], [])
        assert confirmed.parts == {"it": sorted((*ALWAYS, "animations"))}
        assert await quiet(it)
        bus.release("key")
        await bus.drain(2)
        await it.close()


async def test_a_drive_that_a_stop_cut_short_does_not_begin_later(tmp_path: Path) -> None:
    async with played(tmp_path) as it:
        job = it.begin("drive", x=5.0)  # it has not even been sent
        await it.stop()
        assert job.cancelled()
        with pytest.raises(DriverError):
            await it.do("pose", joints={"HeadYaw": 500})
        assert await it.calls("ALMotion.moveTo") == []
