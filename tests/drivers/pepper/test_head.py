"""Head and hip over the wire: directions, steps, limits, slack motors."""

from __future__ import annotations

import math
from collections.abc import AsyncIterator

import pytest
import pytest_asyncio

from tests.drivers.pepper.robot_rig import RobotRig, connected_robot
from tests.drivers.published_messages import PATIENCE_S
from woz_tui.drivers.contract import DriverError
from woz_tui.protocol.messages import Json

pytestmark = pytest.mark.asyncio(loop_scope="module")


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def rig(tmp_path_factory: pytest.TempPathFactory) -> AsyncIterator[RobotRig]:
    # Awareness would turn the head by itself.
    async with connected_robot(
        tmp_path_factory.mktemp("experiment"), life="safeguard"
    ) as robot_rig:
        await robot_rig.do("torque", on=True)
        yield robot_rig


@pytest.fixture(autouse=True)
def unhurried(monkeypatch: pytest.MonkeyPatch) -> None:
    """A busy machine takes its time; that a stop waits no longer is another test's. Steps belong
    together even so.
    """
    monkeypatch.setattr("woz_tui.drivers.confirmed_stop.STOP_S", PATIENCE_S)
    monkeypatch.setattr("woz_drivers.naoqi_robot.head.RECENT_US", PATIENCE_S * 1e6)


async def angle(robot_rig: RobotRig, joint: str) -> float:
    """Degrees."""
    return round(math.degrees((await robot_rig.robot.get("angles"))[joint]), 1)


async def reaches(robot_rig: RobotRig, joint: str, degrees: float) -> None:
    async def there() -> bool:
        return abs(await angle(robot_rig, joint) - degrees) <= 0.1

    await robot_rig.robot.until(there)


async def test_a_gaze_is_absolute_and_returns_at_once(robot_rig: RobotRig) -> None:
    assert await robot_rig.do("gaze", yaw=40, pitch=10) == {"yaw": 40, "pitch": 10}
    await reaches(robot_rig, "HeadYaw", 40)
    await reaches(robot_rig, "HeadPitch", 10)
    await robot_rig.do("gaze", yaw=-20, pitch=0)
    await reaches(robot_rig, "HeadYaw", -20)


async def test_a_gaze_beyond_the_range_goes_to_the_nearest_and_says_so(robot_rig: RobotRig) -> None:
    sent = await robot_rig.do("gaze", yaw=170, pitch=-10)
    assert sent == {"yaw": 119.5, "pitch": -10, "clamped": {"yaw": 170}}
    sent = await robot_rig.do("gaze", yaw=100, pitch=25)
    assert sent == {"yaw": 100, "pitch": 13.5, "clamped": {"pitch": 25}}


@pytest.mark.woz4u("default_head_turn_deg")
async def test_every_step_of_a_held_key_counts(robot_rig: RobotRig) -> None:
    await robot_rig.do("gaze", yaw=0, pitch=0)
    for _ in range(20):
        sent = await robot_rig.do("nudge", yaw=2.5)
    assert sent["yaw"] == 50
    await reaches(robot_rig, "HeadYaw", 50)


async def test_steps_go_on_from_where_something_else_has_turned_the_head(
    robot_rig: RobotRig,
) -> None:
    await robot_rig.stop()
    await robot_rig.do("pose", joints={"HeadYaw": 30, "HeadPitch": 0}, seconds=0.5)
    assert (await robot_rig.do("nudge", yaw=-10))["yaw"] == pytest.approx(20, abs=0.2)


async def test_steps_end_at_the_range_and_come_back_from_there_at_once(robot_rig: RobotRig) -> None:
    await robot_rig.do("gaze", yaw=110, pitch=0)
    assert (await robot_rig.do("nudge", yaw=30))["yaw"] == 119.5
    assert (await robot_rig.do("nudge", yaw=-10))["yaw"] == 109.5
    assert (await robot_rig.do("nudge", pitch=40))["pitch"] == 13.5


@pytest.mark.naoqi("ALMotion.setStiffnesses")
async def test_a_slack_head_is_stiffened_first_and_a_stiff_one_is_not_asked_again(
    robot_rig: RobotRig,
) -> None:
    await robot_rig.do("gaze", yaw=0, pitch=0)
    await reaches(robot_rig, "HeadYaw", 0)
    await robot_rig.stop()  # where it looks is asked anew after a stop
    await robot_rig.do("naoqi", call="ALMotion.setStiffnesses", args='["Head", 0.0]')
    await robot_rig.robot.clear()
    await robot_rig.do("nudge", yaw=20)
    await robot_rig.do("nudge", yaw=1)
    assert await robot_rig.calls("ALMotion.setStiffnesses") == [(["Head"], 1.0)]
    await reaches(robot_rig, "HeadYaw", 21)


def lacks(*methods: str) -> str:
    """The fault of a robot without these."""
    return f"refuse:{','.join(f'ALMotion.{one}' for one in methods)}=Can't find method"


@pytest.mark.parametrize(
    "lacking", [(), ("getAngles",), ("setAngles",), ("getAngles", "setAngles")]
)
@pytest.mark.naoqi("ALMotion.angleInterpolation")
async def test_head_and_hip_move_on_a_naoqi_that_lacks_getStiffnesses(  # noqa: N802 - its name
    robot_rig: RobotRig, lacking: tuple[str, ...]
) -> None:
    await robot_rig.do("gaze", yaw=0, pitch=0)
    await robot_rig.do("pose", joints={"HeadYaw": 0, "HipPitch": 0}, seconds=0.5)
    await robot_rig.stop()
    await robot_rig.robot.clear()
    await robot_rig.robot.fault(lacks("getStiffnesses", *lacking))
    await robot_rig.do("nudge", yaw=20)
    assert await robot_rig.calls("ALMotion.setStiffnesses") == [(["Head"], 1.0)]
    await reaches(robot_rig, "HeadYaw", 20)
    await robot_rig.do("hip", pitch=10)
    await reaches(robot_rig, "HipPitch", -10)
    await robot_rig.stop()
    await robot_rig.do("nudge", yaw=-5)
    await reaches(robot_rig, "HeadYaw", 15)
    await robot_rig.stop()


async def test_without_getStiffnesses_the_hip_of_a_robot_at_rest_is_left_alone(  # noqa: N802
    robot_rig: RobotRig,
) -> None:
    await robot_rig.do("torque", on=False)
    await robot_rig.stop()
    await robot_rig.robot.clear()
    await robot_rig.robot.fault(lacks("getStiffnesses"))
    with pytest.raises(DriverError, match="at rest") as raised:
        await robot_rig.do("hip", pitch=5)
    assert "torque" in raised.value.remedy
    assert await robot_rig.calls("ALMotion.setStiffnesses", "ALMotion.setAngles") == []
    await robot_rig.robot.clear()
    await robot_rig.do("torque", on=True)


async def test_the_hip_bends_in_steps_within_its_range(robot_rig: RobotRig) -> None:
    await robot_rig.stop()
    await robot_rig.do("pose", joints={"HipPitch": 0, "HipRoll": 0}, seconds=0.5)
    assert (await robot_rig.do("hip", pitch=5, roll=-3))["pitch"] == pytest.approx(5, abs=0.1)
    assert (await robot_rig.do("hip", roll=-40))["roll"] == -29.5
    await reaches(robot_rig, "HipRoll", -29.5)


@pytest.mark.parametrize(
    ("step", "joint", "radians"),
    [
        # What WoZ4U's keys send: shift with up, down, left, right.
        ({"pitch": 11.46}, "HipPitch", -0.2),
        ({"pitch": -11.46}, "HipPitch", 0.2),
        ({"roll": 11.46}, "HipRoll", 0.2),
        ({"roll": -11.46}, "HipRoll", -0.2),
    ],
)
async def test_the_hip_bends_to_the_side_that_is_asked_for(
    robot_rig: RobotRig, step: dict[str, Json], joint: str, radians: float
) -> None:
    await robot_rig.stop()
    await robot_rig.do("pose", joints={"HipPitch": 0, "HipRoll": 0}, seconds=0.5)
    sent = await robot_rig.do("hip", **step)
    assert {name: sent[name] for name in step} == pytest.approx(step, abs=0.01)
    joints, angles, _ = (await robot_rig.last("ALMotion.setAngles")).args
    assert dict(zip(joints, angles, strict=True))[joint] == pytest.approx(radians, abs=1e-3)


async def test_a_burst_of_steps_is_quick_and_leaves_nothing_out(robot_rig: RobotRig) -> None:
    await robot_rig.do("gaze", yaw=0, pitch=0)
    steps = [await robot_rig.do("nudge", yaw=1) for _ in range(60)]
    assert steps[-1]["yaw"] == 60
    assert len(await robot_rig.calls("ALMotion.setAngles")) == 61


async def test_after_a_stop_a_step_begins_where_the_head_stands(robot_rig: RobotRig) -> None:
    await robot_rig.do("gaze", yaw=0, pitch=0)
    await reaches(robot_rig, "HeadYaw", 0)
    await robot_rig.do("gaze", yaw=100, pitch=0)
    report = await robot_rig.stop()
    assert "motion" in report.confirmed
    stood = await angle(robot_rig, "HeadYaw")
    assert (await robot_rig.do("nudge", yaw=1))["yaw"] == pytest.approx(stood + 1, abs=0.3)
