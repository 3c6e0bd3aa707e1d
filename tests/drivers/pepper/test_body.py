"""Animations, postures, poses and motors over the wire."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from naoqi_simulator.motion import MotionService
from naoqi_simulator.service_table import offers
from woz_drivers.naoqi_robot.body import BodyPart
from woz_drivers.pepper.model import PEPPER

from tests.drivers.pepper.part_rig import connected_part
from tests.drivers.pepper.robot_rig import QUIET, RobotRig, connected_robot
from tests.fakes.naoqi import stand_in_here
from woz_tui.drivers.contract import DriverError, RejectedError
from woz_tui.protocol.messages import Json

HEY = "animations/Stand/Gestures/Hey_1"
LONG = "animations/Stand/Waiting/ShowSky_1"
#: So slow that nothing has come to its end by itself when a busy machine ends it.
SLOW = 0.5


pytestmark = pytest.mark.asyncio(loop_scope="module")


async def moves(rig: RobotRig) -> list[str]:
    """What moves the body now: animation, joints, posture ..."""
    return [kind for kind, *_ in await rig.robot.get("going")]


# -- animations ----------------------------------------------------------------------------------


@pytest.mark.naoqi("ALAnimationPlayer.run")
@pytest.mark.woz4u("gestures")
async def test_an_animation_is_played_to_its_end_by_its_short_name(robot_rig: RobotRig) -> None:
    assert await robot_rig.do("play", move="Hey_1") == {"move": HEY}
    assert (await robot_rig.robot.get("animations"))[-1] == HEY


async def test_an_animation_that_the_robot_has_not_is_told_in_its_words(
    robot_rig: RobotRig,
) -> None:
    with pytest.raises(DriverError, match=r"my_lab/wave was not played: .*not installed") as raised:
        await robot_rig.do("play", move="my_lab/wave")
    assert "getInstalledBehaviors" in raised.value.remedy
    with pytest.raises(RejectedError, match="no animation 'nonsense'"):
        await robot_rig.do("play", move="nonsense")


async def test_a_cancelled_animation_ends_on_the_robot_and_the_next_one_plays(
    tmp_path: Path,
) -> None:
    async with connected_robot(tmp_path, pace=SLOW) as rig:
        job = rig.begin("play", move=LONG)
        await rig.robot.until(lambda: _plays(rig))
        await rig.cancel(job)
        await rig.robot.called("ALBehaviorManager.stopBehavior")
        await rig.do("play", move="Yes_1")
        done = await rig.robot.get("animations")
        assert done == ["animations/Stand/Gestures/Yes_1"]


# -- postures ------------------------------------------------------------------------------------


@pytest.mark.naoqi("ALRobotPosture.goToPosture", "ALRobotPosture.getPosture")
async def test_postures_are_taken_and_home_is_upright(robot_rig: RobotRig) -> None:
    assert await robot_rig.do("posture", name="StandInit", speed=0.8) == {
        "name": "StandInit",
        "speed": 0.8,
    }
    await robot_rig.shows(posture="StandInit")
    assert (await robot_rig.do("home", seconds=1))["name"] == "Stand"
    assert (await robot_rig.do("home", seconds=2))["speed"] == 0.25
    assert await robot_rig.calls("ALRobotPosture.goToPosture") == [
        ("StandInit", pytest.approx(0.8)),
        ("Stand", 0.5),
        ("Stand", 0.25),
    ]


async def test_a_posture_that_is_not_reached_is_a_failure_with_a_remedy(
    robot_rig: RobotRig,
) -> None:
    await robot_rig.robot.fault("says-no")
    with pytest.raises(DriverError, match="Stand was not reached") as raised:
        await robot_rig.do("posture", name="Stand")
    assert "torque" in raised.value.remedy


async def test_a_cancelled_posture_ends_on_the_robot(tmp_path: Path) -> None:
    async with connected_robot(tmp_path, pace=SLOW) as rig:
        job = rig.begin("posture", name="Crouch", speed=0.05)
        await rig.robot.called("ALRobotPosture.goToPosture")
        await rig.cancel(job)
        await rig.robot.called("ALRobotPosture.stopMove")
        assert "posture" not in await moves(rig)


# -- poses ---------------------------------------------------------------------------------------


@pytest.mark.naoqi("ALMotion.angleInterpolation")
async def test_a_pose_is_absolute_in_degrees_and_ends_when_it_is_there(robot_rig: RobotRig) -> None:
    pose = {"HeadYaw": 30, "RShoulderPitch": 10, "RHand": 1}
    assert (await robot_rig.do("pose", joints=pose, seconds=2))["joints"] == pose
    names, angles, times, absolute = (await robot_rig.calls("ALMotion.angleInterpolation"))[0]
    assert (names, times, absolute) == (list(pose), [2, 2, 2], True)
    assert angles == pytest.approx([math.radians(30), math.radians(10), 1])
    has = await robot_rig.robot.get("angles")
    assert has["HeadYaw"] == pytest.approx(math.radians(30), abs=1e-3)
    assert robot_rig.jobs[-1].announced == [2]
    # A second one goes to the same place, not further.
    await robot_rig.do("pose", joints={"HeadYaw": 30}, seconds=0.2)
    assert (await robot_rig.robot.get("angles"))["HeadYaw"] == pytest.approx(
        math.radians(30), abs=1e-3
    )


async def test_an_impossible_pose_never_reaches_the_robot(robot_rig: RobotRig) -> None:
    with pytest.raises(RejectedError, match=r"-119\.5 to 119\.5"):
        await robot_rig.do("pose", joints={"HeadYaw": 130})
    assert await robot_rig.calls("ALMotion.angleInterpolation") == []


@pytest.mark.naoqi("ALMotion.setStiffnesses")
async def test_only_slack_limbs_are_stiffened(robot_rig: RobotRig) -> None:
    await robot_rig.do("naoqi", call="ALMotion.setStiffnesses", args='["RArm", 0.0]')
    await robot_rig.robot.clear()
    await robot_rig.do("pose", joints={"HeadYaw": 5, "RShoulderPitch": 5}, seconds=0.2)
    assert await robot_rig.calls("ALMotion.setStiffnesses") == [(["RArm"], 1.0)]
    assert (await robot_rig.robot.get("angles"))["RShoulderPitch"] == pytest.approx(
        math.radians(5), abs=1e-3
    )


@pytest.mark.naoqi("ALMotion.setStiffnesses")
@pytest.mark.parametrize(
    ("verb", "args"), [("hip", {"pitch": 5}), ("pose", {"joints": {"KneePitch": 5, "HeadYaw": 5}})]
)
async def test_hip_and_knee_of_a_robot_at_rest_are_left_alone(
    robot_rig: RobotRig, verb: str, args: dict[str, Json]
) -> None:
    await robot_rig.do("torque", on=False)
    await robot_rig.robot.clear()
    with pytest.raises(DriverError, match="at rest") as raised:
        await robot_rig.do(verb, **args)
    assert "torque" in raised.value.remedy
    moving = ("setStiffnesses", "setAngles", "angleInterpolation")
    assert await robot_rig.calls(*(f"ALMotion.{one}" for one in moving)) == []
    await robot_rig.do("torque", on=True)


@pytest.mark.parametrize("name", PEPPER.joints.ranges)
async def test_the_head_arms_and_hands_are_stiffened_and_nothing_else(name: str) -> None:
    limb = PEPPER.joints.limb(name)
    assert limb in {"Head", "LArm", "RArm", "LHand", "RHand", None}
    assert (limb is None) is (name in {"HipPitch", "HipRoll", "KneePitch"})


@pytest.mark.parametrize("fault", ["none", "refuse:ALMotion.killTasksUsingResources"])
async def test_a_cancelled_pose_holds_its_joints(tmp_path: Path, fault: str) -> None:
    async with connected_robot(tmp_path, pace=SLOW) as rig:
        await rig.robot.fault(fault)
        job = rig.begin("pose", joints={"HeadYaw": 100}, seconds=60)
        await rig.robot.called("ALMotion.angleInterpolation")
        await rig.cancel(job)

        async def ended() -> bool:
            return "joints" not in await moves(rig)

        await rig.robot.until(ended)
        assert (await rig.robot.get("angles"))["HeadYaw"] < math.radians(100)


# -- motors --------------------------------------------------------------------------------------


@pytest.mark.naoqi("ALMotion.wakeUp", "ALMotion.rest", "ALMotion.robotIsWakeUp")
async def test_motors_go_off_and_on_and_are_read_back(robot_rig: RobotRig) -> None:
    await robot_rig.do("torque", on=False)
    assert not await robot_rig.robot.get("awake")
    await robot_rig.shows(awake=False)
    await robot_rig.do("torque", on=True)
    assert await robot_rig.robot.get("awake")
    await robot_rig.shows(awake=True)


@pytest.mark.naoqi("ALMotion.rest")
async def test_left_alone_it_rests_and_autonomous_life_stays_as_it_is(robot_rig: RobotRig) -> None:
    await robot_rig.driver.rest()
    assert not await robot_rig.robot.get("awake")
    assert await robot_rig.calls("ALAutonomousLife.setState") == []


async def test_left_alone_it_takes_the_files_posture(tmp_path: Path) -> None:
    async with connected_robot(tmp_path, posture="StandInit") as rig:
        await rig.driver.rest()
        assert await rig.robot.get("awake")
        assert await rig.robot.get("posture") == "StandInit"
        assert await rig.calls("ALMotion.rest") == []


async def _plays(rig: RobotRig) -> bool:
    return "animation" in await moves(rig)


async def test_motors_that_stay_as_they_are_are_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuses(_: MotionService) -> bool:
        return False

    monkeypatch.setattr(MotionService, "wake_up", offers("wakeUp()b")(refuses))
    async with (
        stand_in_here() as robot,
        connected_part(BodyPart, tmp_path, robot, senses=QUIET) as rig,
    ):
        with pytest.raises(DriverError, match="did not wake up") as raised:
            await rig.do("torque", on=True)
        assert "emergency stop" in raised.value.remedy
        assert await rig.do("torque", on=False) == {"on": False}


# -- how long it will take ---------------------------------------------------------------------


@pytest.mark.parametrize(
    ("verb", "args"),
    [
        ("say", {"text": "Hello there."}),
        ("pose", {"joints": {"HeadYaw": 10.0}, "seconds": 2.0}),
        ("drive", {"x": 0.4, "turn": 20.0}),
        ("eyes", {"color": "red", "seconds": 1.5}),
    ],
)
async def test_what_is_foretold_is_what_the_wizard_sees_counted_down(
    robot_rig: RobotRig, verb: str, args: dict[str, Json]
) -> None:
    await robot_rig.do("torque", on=True)
    foretold = await robot_rig.driver.predict(verb, args)
    await robot_rig.do(verb, **args)
    assert foretold.seconds == pytest.approx(robot_rig.jobs[-1].announced[0])


async def test_of_what_the_robot_decides_nothing_is_foretold(robot_rig: RobotRig) -> None:
    assert (await robot_rig.driver.predict("play", {"move": "Hey_1"})).seconds is None
    assert (await robot_rig.driver.predict("posture", {"name": "Stand"})).seconds is None
    with pytest.raises(RejectedError):
        await robot_rig.driver.predict("drive", {})
