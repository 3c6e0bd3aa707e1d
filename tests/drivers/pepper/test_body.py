"""Animations, postures, poses and motors over the wire."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from naoqi_simulator.motion import MotionService
from naoqi_simulator.service_table import offers
from woz_drivers.naoqi_robot.body import BodyPart
from woz_drivers.pepper.pepper_model import PEPPER

from tests.drivers.pepper.played import QUIET, Played, played
from tests.drivers.pepper.wired import wired
from tests.fakes.naoqi import stand_in_here
from woz_tui.drivers.contract import DriverError, RejectedError
from woz_tui.protocol.messages import Json

HEY = "animations/Stand/Gestures/Hey_1"
LONG = "animations/Stand/Waiting/ShowSky_1"
#: So slow that nothing has come to its end by itself when a busy machine ends it.
SLOW = 0.5


pytestmark = pytest.mark.asyncio(loop_scope="module")


async def moves(it: Played) -> list[str]:
    """What moves the body now: animation, joints, posture ..."""
    return [kind for kind, *_ in await it.robot.get("going")]


# -- animations ----------------------------------------------------------------------------------


@pytest.mark.naoqi("ALAnimationPlayer.run")
@pytest.mark.woz4u("gestures")
async def test_an_animation_is_played_to_its_end_by_its_short_name(it: Played) -> None:
    assert await it.do("play", move="Hey_1") == {"move": HEY}
    assert (await it.robot.get("animations"))[-1] == HEY


async def test_an_animation_that_the_robot_has_not_is_told_in_its_words(it: Played) -> None:
    with pytest.raises(DriverError, match=r"my_lab/wave was not played: .*not installed") as told:
        await it.do("play", move="my_lab/wave")
    assert "getInstalledBehaviors" in told.value.remedy
    with pytest.raises(RejectedError, match="no animation 'nonsense'"):
        await it.do("play", move="nonsense")


async def test_a_cancelled_animation_ends_on_the_robot_and_the_next_one_plays(
    tmp_path: Path,
) -> None:
    async with played(tmp_path, pace=SLOW) as it:
        job = it.begin("play", move=LONG)
        await it.robot.until(lambda: _plays(it))
        await it.cancel(job)
        await it.robot.called("ALBehaviorManager.stopBehavior")
        await it.do("play", move="Yes_1")
        done = await it.robot.get("animations")
        assert done == ["animations/Stand/Gestures/Yes_1"]


# -- postures ------------------------------------------------------------------------------------


@pytest.mark.naoqi("ALRobotPosture.goToPosture", "ALRobotPosture.getPosture")
async def test_postures_are_taken_and_home_is_upright(it: Played) -> None:
    assert await it.do("posture", name="StandInit", speed=0.8) == {
        "name": "StandInit",
        "speed": 0.8,
    }
    await it.shows(posture="StandInit")
    assert (await it.do("home", seconds=1))["name"] == "Stand"
    assert (await it.do("home", seconds=2))["speed"] == 0.25
    assert await it.calls("ALRobotPosture.goToPosture") == [
        ("StandInit", pytest.approx(0.8)),
        ("Stand", 0.5),
        ("Stand", 0.25),
    ]


async def test_a_posture_that_is_not_reached_is_a_failure_with_a_remedy(it: Played) -> None:
    await it.robot.fault("says-no")
    with pytest.raises(DriverError, match="Stand was not reached") as told:
        await it.do("posture", name="Stand")
    assert "torque" in told.value.remedy


async def test_a_cancelled_posture_ends_on_the_robot(tmp_path: Path) -> None:
    async with played(tmp_path, pace=SLOW) as it:
        job = it.begin("posture", name="Crouch", speed=0.05)
        await it.robot.called("ALRobotPosture.goToPosture")
        await it.cancel(job)
        await it.robot.called("ALRobotPosture.stopMove")
        assert "posture" not in await moves(it)


# -- poses ---------------------------------------------------------------------------------------


@pytest.mark.naoqi("ALMotion.angleInterpolation")
async def test_a_pose_is_absolute_in_degrees_and_ends_when_it_is_there(it: Played) -> None:
    pose = {"HeadYaw": 30, "RShoulderPitch": 10, "RHand": 1}
    assert (await it.do("pose", joints=pose, seconds=2))["joints"] == pose
    names, angles, times, absolute = (await it.calls("ALMotion.angleInterpolation"))[0]
    assert (names, times, absolute) == (list(pose), [2, 2, 2], True)
    assert angles == pytest.approx([math.radians(30), math.radians(10), 1])
    has = await it.robot.get("angles")
    assert has["HeadYaw"] == pytest.approx(math.radians(30), abs=1e-3)
    assert it.jobs[-1].announced == [2]
    # A second one goes to the same place, not further.
    await it.do("pose", joints={"HeadYaw": 30}, seconds=0.2)
    assert (await it.robot.get("angles"))["HeadYaw"] == pytest.approx(math.radians(30), abs=1e-3)


async def test_an_impossible_pose_never_reaches_the_robot(it: Played) -> None:
    with pytest.raises(RejectedError, match=r"-119\.5 to 119\.5"):
        await it.do("pose", joints={"HeadYaw": 130})
    assert await it.calls("ALMotion.angleInterpolation") == []


@pytest.mark.naoqi("ALMotion.setStiffnesses")
async def test_only_slack_limbs_are_stiffened(it: Played) -> None:
    await it.do("naoqi", call="ALMotion.setStiffnesses", args='["RArm", 0.0]')
    await it.robot.clear()
    await it.do("pose", joints={"HeadYaw": 5, "RShoulderPitch": 5}, seconds=0.2)
    assert await it.calls("ALMotion.setStiffnesses") == [(["RArm"], 1.0)]
    assert (await it.robot.get("angles"))["RShoulderPitch"] == pytest.approx(
        math.radians(5), abs=1e-3
    )


@pytest.mark.naoqi("ALMotion.setStiffnesses")
@pytest.mark.parametrize(
    ("verb", "args"), [("hip", {"pitch": 5}), ("pose", {"joints": {"KneePitch": 5, "HeadYaw": 5}})]
)
async def test_hip_and_knee_of_a_robot_at_rest_are_left_alone(
    it: Played, verb: str, args: dict[str, Json]
) -> None:
    await it.do("torque", on=False)
    await it.robot.clear()
    with pytest.raises(DriverError, match="at rest") as told:
        await it.do(verb, **args)
    assert "torque" in told.value.remedy
    moving = ("setStiffnesses", "setAngles", "angleInterpolation")
    assert await it.calls(*(f"ALMotion.{one}" for one in moving)) == []
    await it.do("torque", on=True)


@pytest.mark.parametrize("name", PEPPER.joints.ranges)
async def test_the_head_arms_and_hands_are_stiffened_and_nothing_else(name: str) -> None:
    limb = PEPPER.joints.limb(name)
    assert limb in {"Head", "LArm", "RArm", "LHand", "RHand", None}
    assert (limb is None) is (name in {"HipPitch", "HipRoll", "KneePitch"})


@pytest.mark.parametrize("fault", ["none", "refuse:ALMotion.killTasksUsingResources"])
async def test_a_cancelled_pose_holds_its_joints(tmp_path: Path, fault: str) -> None:
    async with played(tmp_path, pace=SLOW) as it:
        await it.robot.fault(fault)
        job = it.begin("pose", joints={"HeadYaw": 100}, seconds=60)
        await it.robot.called("ALMotion.angleInterpolation")
        await it.cancel(job)

        async def ended() -> bool:
            return "joints" not in await moves(it)

        await it.robot.until(ended)
        assert (await it.robot.get("angles"))["HeadYaw"] < math.radians(100)


# -- motors --------------------------------------------------------------------------------------


@pytest.mark.naoqi("ALMotion.wakeUp", "ALMotion.rest", "ALMotion.robotIsWakeUp")
async def test_motors_go_off_and_on_and_are_read_back(it: Played) -> None:
    await it.do("torque", on=False)
    assert not await it.robot.get("awake")
    await it.shows(awake=False)
    await it.do("torque", on=True)
    assert await it.robot.get("awake")
    await it.shows(awake=True)


@pytest.mark.naoqi("ALMotion.rest")
async def test_left_alone_it_rests_and_autonomous_life_stays_as_it_is(it: Played) -> None:
    await it.driver.rest()
    assert not await it.robot.get("awake")
    assert await it.calls("ALAutonomousLife.setState") == []


async def test_left_alone_it_takes_the_files_posture(tmp_path: Path) -> None:
    async with played(tmp_path, posture="StandInit") as it:
        await it.driver.rest()
        assert await it.robot.get("awake")
        assert await it.robot.get("posture") == "StandInit"
        assert await it.calls("ALMotion.rest") == []


async def _plays(it: Played) -> bool:
    return "animation" in await moves(it)


async def test_motors_that_stay_as_they_are_are_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuses(_: MotionService) -> bool:
        return False

    monkeypatch.setattr(MotionService, "wake_up", offers("wakeUp()b")(refuses))
    async with (
        stand_in_here() as robot,
        wired(BodyPart, tmp_path, robot, senses=QUIET) as it,
    ):
        with pytest.raises(DriverError, match="did not wake up") as told:
            await it.do("torque", on=True)
        assert "emergency stop" in told.value.remedy
        assert await it.do("torque", on=False) == {"on": False}


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
    it: Played, verb: str, args: dict[str, Json]
) -> None:
    await it.do("torque", on=True)
    foretold = await it.driver.predict(verb, args)
    await it.do(verb, **args)
    assert foretold.seconds == pytest.approx(it.jobs[-1].announced[0])


async def test_of_what_the_robot_decides_nothing_is_foretold(it: Played) -> None:
    assert (await it.driver.predict("play", {"move": "Hey_1"})).seconds is None
    assert (await it.driver.predict("posture", {"name": "Stand"})).seconds is None
    with pytest.raises(RejectedError):
        await it.driver.predict("drive", {})
