"""Tracking modes over the wire: what moves by itself, who ends it, what is left behind."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Mapping
from pathlib import Path

import pytest
import pytest_asyncio
from woz_drivers.naoqi_robot.settings import AutonomySettings
from woz_drivers.pepper.driver import Pepper
from woz_drivers.pepper.settings import PepperSettings

from tests.drivers.pepper.robot_rig import RobotRig, connected_driver, connected_robot, settings_for
from tests.fakes.naoqi import stand_in
from woz_tui.bus.bus import Bus
from woz_tui.bus.hub import Hub
from woz_tui.drivers.contract import DriverError, RejectedError, Scope
from woz_tui.protocol.messages import Command, DriverConnected, Json, Message, Refused, Stopped

pytestmark = [
    pytest.mark.asyncio(loop_scope="module"),
    pytest.mark.usefixtures("unhurried_stop"),
    pytest.mark.safety,
]
#: What moves the base, and would go on after `ALMotion.stopMove`.
DRIVING = ("BodyRotation", "WholeBody", "MoveContextually")


@pytest_asyncio.fixture(scope="module", loop_scope="module", params=["pepper", "nao"])
async def either(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> AsyncIterator[RobotRig]:
    """So slow that it is still turning when a busy machine looks."""
    folder = tmp_path_factory.mktemp(request.param)
    async with connected_robot(folder, kind=request.param, pace=5.0) as rig:
        if request.param == "nao":
            await rig.do("posture", name="Stand")
        yield rig


async def somebody_beside(rig: RobotRig) -> None:
    """Far to the left, so that it has to turn for long."""
    await rig.robot.clear()
    await rig.do("autonomy", awareness=True, heeds_people=True)
    await rig.robot.person({"angle": 3.0, "distance": 2.0})


async def drives(rig: RobotRig) -> bool:
    return any(await rig.robot.get("velocity"))


async def tracking(rig: RobotRig) -> str:
    return str(await rig.robot.get("tracking"))


async def begun(rig: RobotRig, mode: str) -> asyncio.Task[Mapping[str, Json]]:
    """It tracks so, and is on its way."""
    await somebody_beside(rig)
    job = rig.begin("track", mode=mode, seconds=3000)
    await rig.robot.until(lambda: drives(rig))
    await rig.shows(tracking=mode)
    return job


@pytest.mark.parametrize("mode", DRIVING)
@pytest.mark.parametrize("scope", list(Scope))
@pytest.mark.naoqi("ALBasicAwareness.setTrackingMode", "ALBasicAwareness.getTrackingMode")
async def test_the_stop_ends_each_mode_and_leaves_head_behind(
    either: RobotRig, mode: str, scope: Scope
) -> None:
    job = await begun(either, mode)
    report = await either.stop(scope)
    job.cancel()
    assert report.missing == ()
    assert "tracking" in report.confirmed
    assert {"driving", "walking"} & set(report.confirmed)
    assert await tracking(either) == "Head"
    assert not await drives(either)
    await either.driver.resume()
    await either.shows(tracking="Head", awareness=True)
    await asyncio.wait([job])
    assert not await drives(either)


@pytest.mark.parametrize("mode", DRIVING)
async def test_what_is_cut_short_leaves_head_behind(either: RobotRig, mode: str) -> None:
    job = await begun(either, mode)
    await either.cancel(job)
    await either.shows(tracking="Head")
    assert await tracking(either) == "Head"


async def test_head_needs_nothing_and_moves_no_base(either: RobotRig) -> None:
    await somebody_beside(either)
    assert await either.do("track", mode="Head", seconds=5) == {"mode": "Head"}
    report = await either.stop(Scope.ALL)
    await either.driver.resume()
    assert "tracking" not in report.missing
    assert not await drives(either)


async def test_it_ends_by_itself_when_its_time_is_over(tmp_path: Path) -> None:
    async with connected_robot(tmp_path) as rig:
        await rig.do("autonomy", awareness=True)
        assert await rig.do("track", mode="BodyRotation", seconds=1) == {
            "mode": "BodyRotation",
            "seconds": 1,
        }
        assert await tracking(rig) == "Head"


async def test_stopping_the_base_alone_would_end_nothing(either: RobotRig) -> None:
    """Why the stop has to change the mode: the robot sets off again."""
    job = await begun(either, "BodyRotation")
    await either.do("naoqi", call="ALMotion.stopMove")
    await either.robot.until(lambda: drives(either))
    await either.cancel(job)


async def test_a_mode_that_others_have_set_is_warned_of_and_ended_by_the_stop(
    tmp_path: Path,
) -> None:
    async with connected_robot(tmp_path, pace=5.0) as rig:
        await somebody_beside(rig)
        await rig.robot.order(do="set", name="tracking", value="BodyRotation")
        shown = await rig.shows(tracking="BodyRotation")
        shown = await rig.tells(lambda shown: bool(shown.conflicts))
        assert any("moves the base by itself" in text for text in shown.conflicts)
        assert "tracking" in (await rig.stop()).confirmed
        assert await tracking(rig) == "Head"


@pytest.mark.naoqi("ALBasicAwareness.pauseAwareness", "ALBasicAwareness.resumeAwareness")
async def test_a_robot_that_refuses_head_is_paused_until_the_release(either: RobotRig) -> None:
    job = await begun(either, "MoveContextually")
    await either.robot.fault("refuse:ALBasicAwareness.setTrackingMode=busy")
    report = await either.stop()
    assert "tracking" in report.confirmed
    assert await either.robot.get("awareness.paused") is True
    assert not await drives(either)
    await either.robot.fault("none")
    await either.do("track", mode="Head")
    await either.driver.resume()
    await either.robot.called("ALBasicAwareness.resumeAwareness")
    assert job.done()


async def test_a_mode_that_the_robot_does_not_take_is_told(either: RobotRig) -> None:
    await somebody_beside(either)
    await either.robot.fault("refuse:ALBasicAwareness.setTrackingMode=not now")
    with pytest.raises(DriverError, match="not now"):
        await either.do("track", mode="BodyRotation")
    await either.robot.fault("none")
    await either.do("track", mode="Head")


async def test_without_awareness_nothing_would_track(either: RobotRig) -> None:
    await either.do("autonomy", awareness=False)
    with pytest.raises(RejectedError, match="awareness is off"):
        await either.do("track", mode="BodyRotation")


async def test_it_drives_so_that_nobody_is_moved_at_unwatched() -> None:
    offered = Pepper.offer(settings_for("pepper", "127.0.0.1")).verbs
    assert [verb.name for verb in offered if verb.drives] == ["drive", "track", "naoqi_drive"]
    [verb] = [one for one in offered if one.name == "track"]
    assert verb.drives
    assert verb.arguments[0].choices == ("Head", *DRIVING)


@pytest.mark.naoqi(
    "ALBasicAwareness.setStimulusDetectionEnabled", "ALBasicAwareness.isStimulusDetectionEnabled"
)
async def test_what_awareness_heeds_is_set_and_read_back(either: RobotRig) -> None:
    for name in ("heeds_people", "heeds_touch", "heeds_sound", "heeds_movement"):
        for on in (False, True):
            await either.do("autonomy", **{name: on})
            await either.shows(**{name: on})
    assert await either.calls("ALBasicAwareness.setStimulusDetectionEnabled")


@pytest.mark.parametrize(
    ("call", "args", "instead"),
    [
        ("ALBasicAwareness.setTrackingMode", '["MoveContextually"]', "play `track`"),
        ("albasicawareness.settrackingmode", '["BodyRotation"]', "play `track`"),
        ("ALTracker.setMode", '["Move"]', "play `track`"),
        ("ALMotion.moveToward", "[0.5, 0.0, 0.0]", "play `drive`"),
        ("ALBehaviorManager.startBehavior", '["dance"]', "runBehavior"),
        ("ALMotion.moveTo", "[1.0, 0.0, 0.0]", "play `naoqi_drive`"),
        ("ALNavigation.navigateTo", "[1.0, 0.0]", "play `naoqi_drive`"),
        ("ALRecharge.goToStation", "[]", "play `naoqi_drive`"),
        ("ALLocalization.goToHome", "[]", "play `naoqi_drive`"),
        ("ALAutonomousLife.switchFocus", '["dance/behavior"]', "runBehavior"),
    ],
)
async def test_no_raw_call_goes_round_who_watches(
    either: RobotRig, call: str, args: str, instead: str
) -> None:
    """Driving is driving by whatever name it is called."""
    await somebody_beside(either)
    with pytest.raises(RejectedError, match="may drive") as error:
        await either.do("naoqi", call=call, args=args)
    assert instead in error.value.remedy
    assert not await drives(either)
    await either.do("naoqi", call="ALBasicAwareness.setTrackingMode", args='["Head"]')
    assert await tracking(either) == "Head"


@pytest.mark.parametrize("scope", list(Scope))
async def test_a_raw_call_that_drives_ends_with_the_stop(either: RobotRig, scope: Scope) -> None:
    await either.robot.clear()
    await either.do("autonomy", awareness=False)
    job = either.begin("naoqi_drive", call="ALMotion.moveTo", args="[3.0, 0.0, 0.0]")
    await either.robot.until(lambda: drives(either))
    report = await either.stop(scope)
    job.cancel()
    assert {"driving", "walking"} & set(report.confirmed)
    await asyncio.wait([job])
    assert not await drives(either)
    await either.driver.resume()


@pytest.mark.parametrize("scope", list(Scope))
async def test_a_behavior_run_by_its_name_ends_with_the_stop(tmp_path: Path, scope: Scope) -> None:
    async with connected_robot(tmp_path, pace=2.0) as rig:
        job = rig.begin(
            "naoqi_drive",
            call="ALBehaviorManager.runBehavior",
            args='["animations/Stand/Gestures/Hey_1"]',
        )
        await rig.robot.called("ALBehaviorManager.runBehavior")
        assert "calls" in (await rig.stop(scope)).confirmed
        job.cancel()
        await asyncio.wait([job])


async def test_the_file_may_ask_for_head_on_connect(tmp_path: Path) -> None:
    async with connected_robot(tmp_path, autonomy=AutonomySettings(tracking="Head")) as rig:
        await rig.robot.called("ALBasicAwareness.setTrackingMode")
        assert (await rig.shows(tracking="Head")).wanted == {}


async def test_who_does_not_watch_begins_none_and_ends_it_by_going(tmp_path: Path) -> None:
    async with stand_in(pace=5.0) as robot:
        rig = await connected_driver(robot, tmp_path, PepperSettings(robots=(robot.address,)))
        await somebody_beside(rig)
        told: list[Message] = []
        hub = Hub(rig.published.clock, lambda message, line: None)
        hub.listen(told.append)
        bus = Bus(hub, {"it": rig.driver}, {"it": Pepper.offer(PepperSettings(robots=())).verbs})
        hub.publish(DriverConnected(driver="it"))

        def ask(number: str) -> None:
            args: dict[str, Json] = {"mode": "MoveContextually", "seconds": 3000}
            bus.submit(Command(command=number, driver="it", verb="track", args=args, source="key"))

        bus.unwatched = "nobody is here"
        ask("c1")
        [refused] = [one for one in told if isinstance(one, Refused)]
        assert (refused.command, refused.code) == ("c1", "unwatched")
        bus.unwatched = ""
        ask("c2")
        await robot.until(lambda: drives(rig))
        bus.halt_driving("the wizard has left")
        await robot.until(lambda: stands_with_head(rig))
        [stopped] = [one for one in told if isinstance(one, Stopped)]
        assert stopped.command == "c2"
        await bus.drain(2)
        await rig.close()


async def stands_with_head(rig: RobotRig) -> bool:
    return await tracking(rig) == "Head" and not await drives(rig)
