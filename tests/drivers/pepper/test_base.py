"""Driving over the wire: where it goes, what it does not do, what keeps it from arriving."""

from __future__ import annotations

import math
from collections.abc import AsyncIterator
from pathlib import Path

import pytest
import pytest_asyncio
from woz_drivers.naoqi_robot import base as base_module

from tests.drivers.pepper.played import Played, played
from woz_tui.drivers.contract import DeviceLostError, DriverError, RejectedError, Scope

pytestmark = [
    pytest.mark.asyncio(loop_scope="module"),
    pytest.mark.usefixtures("unhurried_stop"),
]


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def shared(tmp_path_factory: pytest.TempPathFactory) -> AsyncIterator[Played]:
    """It drives so slowly that it is still on its way when a busy machine looks."""
    async with played(tmp_path_factory.mktemp("experiment"), pace=5.0) as made:
        yield made


@pytest.mark.naoqi("ALMotion.moveTo")
@pytest.mark.woz4u("default_drive_dist", "default_turn_deg")
async def test_it_drives_and_turns_and_says_how_long_that_takes(it: Played) -> None:
    _, _, before = await it.robot.get("pose")
    sent = await it.do("drive", x=0.7, y=-0.35, turn=90)
    assert sent == {"x": 0.7, "y": -0.35, "turn": 90}
    ((x, y, turn),) = await it.calls("ALMotion.moveTo")
    assert (x, y, turn) == pytest.approx((0.7, -0.35, math.pi / 2), abs=1e-6)
    _, _, heading = await it.robot.get("pose")
    assert heading - before == pytest.approx(math.pi / 2, abs=0.01)
    assert it.jobs[-1].announced == [pytest.approx(math.hypot(0.7, 0.35) / 0.35)]


async def test_a_drive_changes_no_posture_and_begins_with_a_question(it: Played) -> None:
    before = await it.robot.get("angles")
    await it.robot.clear()
    await it.do("drive", turn=10)
    called = [call.name for call in await it.robot.trace()]
    assert not [name for name in called if "osture" in name and "get" not in name]
    assert not {"ALMotion.wakeUp", "ALMotion.moveInit", "ALMotion.setStiffnesses"} & set(called)
    assert await it.robot.get("angles") == before


@pytest.mark.naoqi("ALMotion.moveTo", "ALMotion.getOrthogonalSecurityDistance")
async def test_an_obstacle_is_told_with_a_remedy_and_the_next_drive_works(it: Played) -> None:
    await it.robot.set("front", 0.5)
    with pytest.raises(
        DriverError, match=r"within its security distance \(it keeps 0\.40 m"
    ) as told:
        await it.do("drive", x=1.0)
    assert "collision" in told.value.remedy
    await it.do("drive", x=-0.2)
    await it.robot.set("front", None)
    await it.do("drive", x=0.3)
    assert len(await it.calls("ALMotion.moveTo")) == 3


@pytest.mark.naoqi("ALMotion.stopMove", "ALMotion.moveTo")
async def test_a_cancelled_drive_ends_on_the_robot(it: Played) -> None:
    job = it.begin("drive", x=5.0)
    await it.robot.until(lambda: _drives(it))
    await it.cancel(job)
    await it.robot.called("ALMotion.stopMove")
    assert not await _drives(it)
    await it.do("drive", turn=5)  # waits until the end of the last one has arrived


async def test_a_drive_that_takes_too_long_is_ended_on_the_robot(
    it: Played, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(base_module, "SLACK_FACTOR", 0.0)
    monkeypatch.setattr(base_module, "SLACK_S", 0.05)
    with pytest.raises(DeviceLostError, match="did not answer"):
        await it.do("drive", x=5.0)
    await it.robot.called("ALMotion.stopMove")
    assert not await _drives(it)


@pytest.mark.naoqi("ALMotion.stopMove", "ALMotion.getRobotVelocity")
async def test_the_stop_of_driving_ends_driving_alone(it: Played) -> None:
    saying = it.begin("say", text="A very long story. " * 100)
    driving = it.begin("drive", x=5.0)
    await it.robot.until(lambda: _drives(it))
    await it.robot.clear()
    report = await it.stop(Scope.DRIVE)
    assert (report.confirmed, report.missing) == (("driving",), ())
    assert not await _drives(it)
    assert await it.calls("ALMotion.getRobotVelocity")  # it was asked whether it stands
    assert await it.calls("ALMotion.killAll", "ALTextToSpeech.stopAll") == []
    with pytest.raises(DriverError):
        await driving  # nobody cancelled it here: the robot says that it did not arrive
    assert not saying.done()
    await it.cancel(saying)


async def test_a_robot_at_rest_does_not_drive_and_says_why(tmp_path: Path) -> None:
    async with played(tmp_path, life="disabled") as it:
        with pytest.raises(DriverError, match="at rest") as told:
            await it.do("drive", x=1)
        assert "torque" in told.value.remedy
        assert await it.calls("ALMotion.moveTo") == []


async def test_to_nowhere_is_refused(it: Played) -> None:
    with pytest.raises(RejectedError, match="no distance"):
        await it.do("drive", x=0.0)


async def test_a_silent_robot_is_not_sent_a_drive(tmp_path: Path) -> None:
    async with played(tmp_path, hurried=True) as it:
        it.robot.freeze()
        with pytest.raises(DeviceLostError):
            await it.do("drive", x=1.0)
        it.robot.thaw()
        assert await it.calls("ALMotion.moveTo") == []


async def _drives(it: Played) -> bool:
    return any(await it.robot.get("velocity"))
