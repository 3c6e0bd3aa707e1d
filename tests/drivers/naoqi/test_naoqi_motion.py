"""ALMotion and ALRobotPosture."""

from __future__ import annotations

import asyncio
import math

import pytest
from naoqi_simulator.joints import JOINTS, PEPPER, POSTURES

from tests.drivers.naoqi.robot_callers import RobotCallError, SimulatedRobotRig

SPEED_M_S = PEPPER.speed[0]
HEAD = ["HeadYaw", "HeadPitch"]


async def angle(rig: SimulatedRobotRig, joint: str) -> float:
    value: float = (await rig.call("ALMotion.getAngles", joint, True))[0]
    return value


async def at_rest(rig: SimulatedRobotRig) -> None:
    task = await rig.begin("ALMotion.rest", kind="posture")
    await rig.time.advance(3)
    await rig.done(task)


async def test_a_drive_takes_its_time_by_distance(rig: SimulatedRobotRig) -> None:
    task = await rig.begin("ALMotion.moveTo", 0.7, 0.0, 0.0, kind="move")
    await rig.time.advance(1.0)
    assert await rig.call("ALMotion.moveIsActive")
    assert await rig.call("ALMotion.getRobotVelocity") == pytest.approx([SPEED_M_S, 0, 0])
    assert await rig.pending(task)
    await rig.time.advance(1.1)
    assert await rig.done(task) is True
    assert not await rig.call("ALMotion.moveIsActive")
    assert await rig.call("ALMotion.getRobotPosition", True) == pytest.approx([0.7, 0, 0])


async def test_a_turn_then_a_drive_goes_where_the_robot_looks(rig: SimulatedRobotRig) -> None:
    turn = await rig.begin("ALMotion.moveTo", 0.0, 0.0, math.pi / 2, kind="move")
    await rig.time.advance(2)
    assert await rig.done(turn) is True
    drive = await rig.begin("ALMotion.moveTo", 0.35, 0.0, 0.0, kind="move")
    await rig.time.advance(2)
    assert await rig.done(drive) is True
    pose = await rig.call("ALMotion.getRobotPosition", True)
    assert pose == pytest.approx([0, 0.35, math.pi / 2], abs=1e-4)


@pytest.mark.parametrize("stop", ["stopMove", "killMove", "killAll"])
async def test_a_drive_is_ended(rig: SimulatedRobotRig, stop: str) -> None:
    task = await rig.begin("ALMotion.moveTo", 1.0, 0.0, 0.0, kind="move")
    await rig.time.advance(1.0)
    await rig.call(f"ALMotion.{stop}")
    assert await rig.done(task) is False
    await rig.time.advance(1.0)
    assert (await rig.call("ALMotion.getRobotPosition", True))[0] == pytest.approx(SPEED_M_S)


async def test_a_new_drive_takes_over(rig: SimulatedRobotRig) -> None:
    first = await rig.begin("ALMotion.moveTo", 1.0, 0.0, 0.0, kind="move")
    await rig.time.advance(1.0)
    second = asyncio.ensure_future(rig.call("ALMotion.moveTo", -0.35, 0.0, 0.0))
    assert await rig.done(first) is False
    assert await rig.pending(second)
    await rig.time.advance(1.1)
    assert await rig.done(second) is True
    position = await rig.call("ALMotion.getRobotPosition", True)
    assert position == pytest.approx([0, 0, 0], abs=1e-4)


async def test_it_stops_before_an_obstacle(rig: SimulatedRobotRig) -> None:
    await rig.robot.set("front", 0.75)
    await rig.call("ALMotion.setOrthogonalSecurityDistance", 0.4)
    task = await rig.begin("ALMotion.moveTo", 0.7, 0.0, 0.0, kind="move")
    await rig.time.advance(3)
    assert await rig.done(task) is False
    assert (await rig.call("ALMotion.getRobotPosition", True))[0] == pytest.approx(0.35)
    assert await rig.robot.get("front") == pytest.approx(0.4)


async def test_an_obstacle_that_is_near_already_lets_nothing_move(rig: SimulatedRobotRig) -> None:
    await rig.robot.set("front", 0.3)
    assert await rig.call("ALMotion.moveTo", 0.5, 0.0, 0.0) is False
    back = await rig.begin("ALMotion.moveTo", -0.35, 0.0, 0.0, kind="move")
    await rig.time.advance(2)
    assert await rig.done(back) is True


async def test_less_distance_kept_goes_further(rig: SimulatedRobotRig) -> None:
    await rig.robot.set("front", 0.75)
    await rig.call("ALMotion.setOrthogonalSecurityDistance", 0.05)
    task = await rig.begin("ALMotion.moveTo", 0.7, 0.0, 0.0, kind="move")
    await rig.time.advance(3)
    assert await rig.done(task) is True


async def test_a_wall_at_the_side_counts_by_the_tangential_distance(rig: SimulatedRobotRig) -> None:
    await rig.robot.set("side", 0.08)
    assert await rig.call("ALMotion.moveTo", 0.5, 0.0, 0.0) is False
    await rig.call("ALMotion.setTangentialSecurityDistance", 0.05)
    assert await rig.call("ALMotion.getTangentialSecurityDistance") == pytest.approx(0.05)
    task = await rig.begin("ALMotion.moveTo", 0.35, 0.0, 0.0, kind="move")
    await rig.time.advance(2)
    assert await rig.done(task) is True


async def test_at_rest_it_neither_drives_nor_moves(rig: SimulatedRobotRig) -> None:
    await at_rest(rig)
    assert await rig.call("ALMotion.robotIsWakeUp") is False
    assert await rig.call("ALMotion.moveTo", 0.5, 0.0, 0.0) is False
    assert await rig.call("ALRobotPosture.goToPosture", "Stand", 0.5) is False
    before = await angle(rig, "HeadYaw")
    await rig.call("ALMotion.setAngles", "HeadYaw", 1.0, 0.5)
    await rig.time.advance(5)
    assert await angle(rig, "HeadYaw") == before
    assert set(await rig.call("ALMotion.getStiffnesses", "Body")) == {0.0}


async def test_waking_up_takes_time_and_stands(rig: SimulatedRobotRig) -> None:
    await at_rest(rig)
    task = await rig.begin("ALMotion.wakeUp", kind="posture")
    await rig.time.advance(1)
    assert await rig.pending(task)
    await rig.time.advance(2)
    await rig.done(task)
    assert await rig.call("ALRobotPosture.getPosture") == "Stand"
    assert await angle(rig, "HipPitch") == pytest.approx(POSTURES["StandInit"]["HipPitch"])


async def test_angles_are_interpolated(rig: SimulatedRobotRig) -> None:
    names, angles, times = HEAD, [0.5, 0.2], [1.0, 1.0]
    task = await rig.begin("ALMotion.angleInterpolation", names, angles, times, True, kind="joints")
    await rig.time.advance(0.5)
    assert await angle(rig, "HeadYaw") == pytest.approx(0.25)
    assert await rig.pending(task)
    await rig.time.advance(0.6)
    await rig.done(task)
    assert await angle(rig, "HeadPitch") == pytest.approx(0.2)


async def test_relative_angles_add_up(rig: SimulatedRobotRig) -> None:
    for _ in range(2):
        task = await rig.begin(
            "ALMotion.angleInterpolation", ["HeadYaw"], [0.2], [0.5], False, kind="joints"
        )
        await rig.time.advance(0.6)
        await rig.done(task)
    assert await angle(rig, "HeadYaw") == pytest.approx(0.4)


async def test_an_angle_out_of_range_is_clipped(rig: SimulatedRobotRig) -> None:
    task = await rig.begin("ALMotion.angleInterpolation", "HeadYaw", 9.0, 1.0, True, kind="joints")
    await rig.time.advance(1.1)
    await rig.done(task)
    assert await angle(rig, "HeadYaw") == pytest.approx(JOINTS["HeadYaw"][1])


@pytest.mark.parametrize(
    ("args", "why"),
    [
        ((["Nose"], [0.1], [1.0], True), "Nose"),
        ((["HeadYaw", "HeadPitch"], [0.1], [1.0], True), "same size"),
        ((["HeadYaw"], [0.1], [0.0], True), "times"),
        ((["HeadYaw"], [[0.1, 0.2]], [[1.0, 0.5]], True), "times"),
    ],
)
async def test_wrong_interpolations_are_refused(
    rig: SimulatedRobotRig, args: tuple[object, ...], why: str
) -> None:
    with pytest.raises(RobotCallError, match=why):
        await rig.call("ALMotion.angleInterpolation", *args)


async def test_kill_all_holds_the_joints(rig: SimulatedRobotRig) -> None:
    task = await rig.begin(
        "ALMotion.angleInterpolation", ["HeadYaw"], [1.0], [1.0], True, kind="joints"
    )
    await rig.time.advance(0.5)
    await rig.call("ALMotion.killAll")
    await rig.done(task)
    await rig.time.advance(1)
    assert await angle(rig, "HeadYaw") == pytest.approx(0.5)


async def test_kill_all_ends_an_animation(rig: SimulatedRobotRig) -> None:
    path = "animations/Stand/Gestures/Hey_1"
    task = await rig.begin("ALAnimationPlayer.run", path, kind="animation")
    await rig.call("ALMotion.killAll")
    await rig.done(task)
    assert await rig.robot.get("animations") == []


async def test_tasks_are_killed_by_their_joints(rig: SimulatedRobotRig) -> None:
    arguments = (["HeadYaw"], [1.0], [1.0], True)
    task = await rig.begin("ALMotion.angleInterpolation", *arguments, kind="joints")
    await rig.call("ALMotion.killTasksUsingResources", ["LArm"])
    assert await rig.pending(task)
    await rig.call("ALMotion.killTasksUsingResources", ["Head"])
    await rig.done(task)


async def test_a_chain_stands_for_its_joints(rig: SimulatedRobotRig) -> None:
    await rig.call("ALMotion.setStiffnesses", "Head", 0.5)
    assert await rig.call("ALMotion.getStiffnesses", HEAD) == [0.5, 0.5]
    assert await rig.call("ALMotion.getStiffnesses", "LHand") == [1.0]
    assert len(await rig.call("ALMotion.getAngles", "Body", True)) == len(JOINTS)


@pytest.mark.parametrize("name", ["Leg", "Body", "HipPitch", "HeadYaw"])
async def test_only_head_arms_and_hands_are_stiffened_by_themselves(
    rig: SimulatedRobotRig, name: str
) -> None:
    with pytest.raises(RobotCallError, match=name):
        await rig.call("ALMotion.setStiffnesses", ["Head", name], 0.0)
    assert await rig.call("ALMotion.getStiffnesses", HEAD) == [1.0, 1.0]


async def test_chains_breathe_on_their_own_and_together(rig: SimulatedRobotRig) -> None:
    await rig.call("ALMotion.setBreathEnabled", "Body", False)
    await rig.call("ALMotion.setBreathEnabled", "Arms", True)
    on = [
        await rig.call("ALMotion.getBreathEnabled", chain)
        for chain in ("Head", "Arms", "LArm", "Legs", "Body")
    ]
    assert on == [False, True, True, False, False]
    with pytest.raises(RobotCallError, match="chain"):
        await rig.call("ALMotion.getBreathEnabled", "Nose")


async def test_resting_ends_breathing(rig: SimulatedRobotRig) -> None:
    await rig.call("ALMotion.setBreathEnabled", "Body", True)
    await at_rest(rig)
    assert await rig.call("ALMotion.getBreathEnabled", "Head") is False


async def test_a_posture_is_reached_and_known(rig: SimulatedRobotRig) -> None:
    task = await rig.begin("ALRobotPosture.goToPosture", "Crouch", 0.5, kind="posture")
    await rig.time.advance(3)
    assert await rig.done(task) is True
    assert await rig.call("ALRobotPosture.getPosture") == "Crouch"
    assert await angle(rig, "KneePitch") == pytest.approx(0.5)


async def test_a_posture_that_is_ended_is_not_reached(rig: SimulatedRobotRig) -> None:
    task = await rig.begin("ALRobotPosture.goToPosture", "Crouch", 0.5, kind="posture")
    await rig.call("ALRobotPosture.stopMove")
    assert await rig.done(task) is False
    assert await rig.call("ALRobotPosture.getPosture") == "Stand"


async def test_an_unknown_posture_is_refused(rig: SimulatedRobotRig) -> None:
    with pytest.raises(RobotCallError, match="Handstand"):
        await rig.call("ALRobotPosture.goToPosture", "Handstand", 0.5)


async def test_moves_can_be_told_to_say_no(rig: SimulatedRobotRig) -> None:
    await rig.robot.fault("says-no", 10)
    assert await rig.call("ALMotion.moveTo", 0.5, 0.0, 0.0) is False
    assert await rig.call("ALRobotPosture.goToPosture", "Stand", 0.5) is False
    await rig.time.advance(11)
    task = await rig.begin("ALRobotPosture.goToPosture", "Stand", 0.5, kind="posture")
    await rig.time.advance(3)
    assert await rig.done(task) is True
