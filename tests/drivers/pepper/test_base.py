"""Driving over the wire: where it goes, what it does not do, what keeps it from arriving."""

from __future__ import annotations

import math
from collections.abc import AsyncIterator
from pathlib import Path

import pytest
import pytest_asyncio
from woz_drivers.naoqi_robot import base as base_module

from tests.drivers.pepper.robot_rig import RobotRig, connected_robot
from woz_tui.drivers.contract import DeviceLostError, DriverError, RejectedError, Scope

pytestmark = [
    pytest.mark.asyncio(loop_scope="module"),
    pytest.mark.usefixtures("unhurried_stop"),
]


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def rig(tmp_path_factory: pytest.TempPathFactory) -> AsyncIterator[RobotRig]:
    """It drives so slowly that it is still on its way when a busy machine looks."""
    async with connected_robot(tmp_path_factory.mktemp("experiment"), pace=5.0) as robot_rig:
        yield robot_rig


@pytest.mark.naoqi("ALMotion.moveTo")
@pytest.mark.woz4u("default_drive_dist", "default_turn_deg")
async def test_it_drives_and_turns_and_says_how_long_that_takes(robot_rig: RobotRig) -> None:
    _, _, before = await robot_rig.robot.get("pose")
    sent = await robot_rig.do("drive", x=0.7, y=-0.35, turn=90)
    assert sent == {"x": 0.7, "y": -0.35, "turn": 90}
    ((x, y, turn),) = await robot_rig.calls("ALMotion.moveTo")
    assert (x, y, turn) == pytest.approx((0.7, -0.35, math.pi / 2), abs=1e-6)
    _, _, heading = await robot_rig.robot.get("pose")
    assert heading - before == pytest.approx(math.pi / 2, abs=0.01)
    assert robot_rig.jobs[-1].announced == [pytest.approx(math.hypot(0.7, 0.35) / 0.35)]


async def test_a_drive_changes_no_posture_and_begins_with_a_question(robot_rig: RobotRig) -> None:
    before = await robot_rig.robot.get("angles")
    await robot_rig.robot.clear()
    await robot_rig.do("drive", turn=10)
    called = [call.name for call in await robot_rig.robot.trace()]
    assert not [name for name in called if "osture" in name and "get" not in name]
    assert not {"ALMotion.wakeUp", "ALMotion.moveInit", "ALMotion.setStiffnesses"} & set(called)
    assert await robot_rig.robot.get("angles") == before


@pytest.mark.naoqi("ALMotion.moveTo", "ALMotion.getOrthogonalSecurityDistance")
async def test_an_obstacle_is_told_with_a_remedy_and_the_next_drive_works(
    robot_rig: RobotRig,
) -> None:
    await robot_rig.robot.set("front", 0.5)
    with pytest.raises(
        DriverError, match=r"within its security distance \(it keeps 0\.40 m"
    ) as raised:
        await robot_rig.do("drive", x=1.0)
    assert "collision" in raised.value.remedy
    await robot_rig.do("drive", x=-0.2)
    await robot_rig.robot.set("front", None)
    await robot_rig.do("drive", x=0.3)
    assert len(await robot_rig.calls("ALMotion.moveTo")) == 3


@pytest.mark.naoqi("ALMotion.stopMove", "ALMotion.moveTo")
async def test_a_cancelled_drive_ends_on_the_robot(robot_rig: RobotRig) -> None:
    job = robot_rig.begin("drive", x=5.0)
    await robot_rig.robot.until(lambda: _drives(robot_rig))
    await robot_rig.cancel(job)
    await robot_rig.robot.called("ALMotion.stopMove")
    assert not await _drives(robot_rig)
    await robot_rig.do("drive", turn=5)  # waits until the end of the last one has arrived


async def test_a_drive_that_takes_too_long_is_ended_on_the_robot(
    robot_rig: RobotRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(base_module, "SLACK_FACTOR", 0.0)
    monkeypatch.setattr(base_module, "SLACK_S", 0.05)
    with pytest.raises(DeviceLostError, match="did not answer"):
        await robot_rig.do("drive", x=5.0)
    await robot_rig.robot.called("ALMotion.stopMove")
    assert not await _drives(robot_rig)


@pytest.mark.naoqi("ALMotion.stopMove", "ALMotion.getRobotVelocity")
async def test_the_stop_of_driving_ends_driving_alone(robot_rig: RobotRig) -> None:
    saying = robot_rig.begin("say", text="A very long story. " * 100)
    driving = robot_rig.begin("drive", x=5.0)
    await robot_rig.robot.until(lambda: _drives(robot_rig))
    await robot_rig.robot.clear()
    report = await robot_rig.stop(Scope.DRIVE)
    assert (report.confirmed, report.missing) == (("driving",), ())
    assert not await _drives(robot_rig)
    assert await robot_rig.calls("ALMotion.getRobotVelocity")  # it was asked whether it stands
    assert await robot_rig.calls("ALMotion.killAll", "ALTextToSpeech.stopAll") == []
    with pytest.raises(DriverError):
        await driving  # nobody cancelled it here: the robot says that it did not arrive
    assert not saying.done()
    await robot_rig.cancel(saying)


async def test_a_robot_at_rest_does_not_drive_and_says_why(tmp_path: Path) -> None:
    async with connected_robot(tmp_path, life="disabled") as robot_rig:
        with pytest.raises(DriverError, match="at rest") as raised:
            await robot_rig.do("drive", x=1)
        assert "torque" in raised.value.remedy
        assert await robot_rig.calls("ALMotion.moveTo") == []


async def test_to_nowhere_is_refused(robot_rig: RobotRig) -> None:
    with pytest.raises(RejectedError, match="no distance"):
        await robot_rig.do("drive", x=0.0)


async def test_a_silent_robot_is_not_sent_a_drive(tmp_path: Path) -> None:
    async with connected_robot(tmp_path, hurried=True) as robot_rig:
        robot_rig.robot.freeze()
        with pytest.raises(DeviceLostError):
            await robot_rig.do("drive", x=1.0)
        robot_rig.robot.thaw()
        assert await robot_rig.calls("ALMotion.moveTo") == []


async def _drives(robot_rig: RobotRig) -> bool:
    return any(await robot_rig.robot.get("velocity"))
