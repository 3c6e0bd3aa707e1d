"""The simulated robot stopped, cancelled and broken on purpose."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from pathlib import Path

import pytest
from woz_drivers.simulated import ScheduledFault, SimulatedRobot, SimulatedSettings

from tests.fakes.simulated_rig import Rig, rig
from woz_tui.drivers.contract import (
    DeviceLostError,
    DriverError,
    Health,
    Probe,
    RejectedError,
    Scope,
)
from woz_tui.protocol.messages import Json
from woz_tui.testing import PlainJob


@pytest.fixture
async def robot(tmp_path: Path) -> AsyncIterator[Rig]:
    async with rig(tmp_path) as simulated_rig:
        yield simulated_rig


# -- the stop -------------------------------------------------------------------------------------


async def test_the_stop_freezes_joints_and_base_at_once(robot: Rig) -> None:
    dance = robot.begin("play", move="dance")
    drive = robot.begin("drive", x=3.0)
    await robot.pace.advance(0.7)
    await robot.robot.stop(Scope.ALL)
    await robot.pace.advance(0.2)
    still = {name: robot.context.latest(name) for name in ("joint.pan", "base.x")}
    for task in (dance, drive):
        with pytest.raises(DriverError, match="cut short"):
            task.result()
    await robot.pace.advance(5.0)
    assert {name: robot.context.latest(name) for name in still} == still
    assert 0 < still["base.x"] < 0.3


async def test_a_drive_stop_leaves_speech_and_gestures_alone(robot: Rig) -> None:
    nod = robot.begin("play", move="nod")
    drive = robot.begin("drive", x=3.0)
    await robot.pace.advance(0.5)
    await robot.robot.stop(Scope.DRIVE)
    await robot.pace.advance(3.0)
    assert nod.result()["move"] == "nod"
    with pytest.raises(DriverError):
        drive.result()
    assert robot.context.latest("base.x") < 0.2


@pytest.mark.parametrize(("verb", "sensor"), [("play", "joint.pan"), ("drive", "base.x")])
async def test_a_cancelled_motion_stands_still(robot: Rig, verb: str, sensor: str) -> None:
    args: dict[str, Json] = {"move": "dance"} if verb == "play" else {"x": 2.0}
    task = robot.begin(verb, **args)
    await robot.pace.advance(0.5)
    task.cancel()
    await robot.pace.advance(0.2)
    assert task.cancelled()
    stopped = robot.context.latest(sensor)
    await robot.pace.advance(2.0)
    assert robot.context.latest(sensor) == stopped != 0


async def test_rest_takes_the_home_pose(robot: Rig) -> None:
    await robot.do("pose", joints={"pan": 40, "hip": 20})
    resting = asyncio.create_task(robot.robot.rest())
    await robot.pace.advance(3.0)
    assert resting.done()
    assert robot.context.latest("joint.pan") == pytest.approx(0, abs=0.1)


# -- break-downs ----------------------------------------------------------------------------------


async def test_unplugged_it_is_lost_and_comes_back(robot: Rig) -> None:
    running = robot.begin("play", move="dance")
    await robot.pace.advance(0.5)
    await robot.do("fault", kind="disconnect", seconds=3.0)
    assert robot.health() is Health.LOST
    await robot.pace.advance(0.2)
    with pytest.raises(DeviceLostError):
        running.result()
    with pytest.raises(DeviceLostError):
        await robot.do("say", text="Is anybody there?")
    before = len(robot.context.readings)
    await robot.pace.advance(2.0)
    assert len(robot.context.readings) == before
    await robot.pace.advance(1.0)
    assert robot.health() is Health.CONNECTED
    await robot.do("say", text="Here I am.")


async def test_a_lost_part_leaves_the_others_alone(robot: Rig) -> None:
    await robot.do("fault", kind="disconnect", seconds=3.0, part="voice")
    assert robot.context.healths[-1][:2] == (Health.FAULTED, "voice does not answer")
    with pytest.raises(DeviceLostError):
        await robot.do("say", text="Hello")
    await robot.do("play", move="nod")
    report = await robot.robot.stop(Scope.ALL)
    assert report is not None
    assert report.missing == ("voice",)


async def test_slow_takes_four_times_as_long_and_says_so(robot: Rig) -> None:
    await robot.do("fault", kind="slow", seconds=60.0)
    job = PlainJob("say", {"text": "x" * 14})
    task = asyncio.create_task(robot.perform(job))
    await robot.pace.advance(3.8)
    assert not task.done()
    assert job.expected == [pytest.approx(4.0)]
    await robot.pace.advance(0.4)
    assert task.done()


async def test_the_next_command_fails_and_only_that(robot: Rig) -> None:
    await robot.do("fault", kind="fail", part="voice")
    await robot.do("play", move="nod")
    with pytest.raises(DriverError, match="half-way"):
        await robot.do("say", text="Hello there")
    await robot.do("say", text="Hello there")


async def test_refusals_end_by_themselves_or_by_clear(robot: Rig) -> None:
    await robot.do("fault", kind="refuse", seconds=100.0)
    with pytest.raises(RejectedError, match="simulated fault"):
        await robot.do("play", move="nod")
    await robot.do("fault", kind="clear")
    await robot.do("play", move="nod")


async def test_a_hanging_command_ignores_its_cancellation_until_its_time(robot: Rig) -> None:
    await robot.do("fault", kind="hang", seconds=3.0)
    await robot.pace.advance(60.0)
    task = robot.begin("say", text="Hello")
    await robot.pace.advance(0.5)
    task.cancel()
    await robot.pace.advance(2.0)
    assert not task.done()
    task.cancel()
    await robot.pace.advance(0.6)
    assert task.cancelled()


async def test_a_deaf_robot_freezes_but_confirms_late(robot: Rig) -> None:
    await robot.do("fault", kind="deaf", seconds=2.0)
    robot.begin("drive", x=2.0).add_done_callback(lambda task: task.exception())
    await robot.pace.advance(0.5)
    stopping = asyncio.create_task(robot.robot.stop(Scope.ALL))
    await robot.pace.advance(1.0)
    assert not stopping.done()
    assert robot.context.latest("base.x") < 0.2
    await robot.pace.advance(1.0)
    assert stopping.done()


async def test_a_hot_motor_shows_and_everything_goes_on(robot: Rig) -> None:
    await robot.do("fault", kind="overheat", seconds=2.0, part="tilt")
    assert robot.context.healths[-1] == (Health.FAULTED, "tilt is too hot", "let it rest")
    await robot.do("play", move="nod")
    await robot.pace.advance(2.0)
    assert robot.health() is Health.CONNECTED


async def test_sensors_break_in_three_ways(tmp_path: Path) -> None:
    async with rig(tmp_path, SimulatedSettings(visitor=True)) as simulated_rig:
        await simulated_rig.pace.advance(1.0)
        await simulated_rig.do("fault", kind="stuck", seconds=5.0, part="loudness")
        stuck = simulated_rig.context.latest("loudness")
        await simulated_rig.do("fault", kind="nan", seconds=5.0, part="distance")
        await simulated_rig.do("fault", kind="silent", seconds=5.0, part="presence")
        simulated_rig.context.readings.clear()
        await simulated_rig.pace.advance(4.5)
        assert {reading.value for reading in simulated_rig.context.of("loudness")} == {stuck}
        assert {tuple(reading.bad) for reading in simulated_rig.context.of("distance")} == {
            ("value",)
        }
        assert not simulated_rig.context.of("presence")
        assert simulated_rig.context.of("gaze")


async def test_scheduled_faults_come_by_themselves(tmp_path: Path) -> None:
    planned = SimulatedSettings(faults=(ScheduledFault("disconnect", after=2.0, seconds=1.0),))
    async with rig(tmp_path, planned) as simulated_rig:
        await simulated_rig.pace.advance(4.0)
    assert [health for health, _, _ in simulated_rig.context.healths] == [
        Health.CONNECTING,
        Health.CONNECTED,
        Health.LOST,
        Health.CONNECTED,
    ]
    findings = await SimulatedRobot.examine(Probe("robot", planned))
    assert [finding.level for finding in findings] == ["ok", "warning"]


async def test_a_planned_fault_of_a_part_that_is_not_there_is_found() -> None:
    planned = SimulatedSettings(faults=(ScheduledFault("fail", part="vioce"),))
    findings = await SimulatedRobot.examine(Probe("robot", planned))
    assert findings[-1].level == "error"
    assert "voice" in findings[-1].remedy


async def test_it_may_take_a_while_to_be_found(tmp_path: Path) -> None:
    async with rig(tmp_path, SimulatedSettings(connect_after=2.0)) as simulated_rig:
        with pytest.raises(DeviceLostError, match="not connected yet"):
            await simulated_rig.do("say", text="Hello")
        await simulated_rig.pace.advance(2.1)
        assert simulated_rig.health() is Health.CONNECTED
        await simulated_rig.do("say", text="Hello")
