"""ALMotion and ALRobotPosture."""

from __future__ import annotations

import asyncio
import math

import pytest
from naoqi_simulator.joints import JOINTS, PEPPER, POSTURES

from tests.drivers.naoqi.hands import Said, Wired

SPEED_M_S = PEPPER.speed[0]
HEAD = ["HeadYaw", "HeadPitch"]


async def angle(wired: Wired, joint: str) -> float:
    value: float = (await wired.call("ALMotion.getAngles", joint, True))[0]
    return value


async def at_rest(wired: Wired) -> None:
    task = await wired.begin("ALMotion.rest", kind="posture")
    await wired.time.advance(3)
    await wired.done(task)


async def test_a_drive_takes_its_time_by_distance(wired: Wired) -> None:
    task = await wired.begin("ALMotion.moveTo", 0.7, 0.0, 0.0, kind="move")
    await wired.time.advance(1.0)
    assert await wired.call("ALMotion.moveIsActive")
    assert await wired.call("ALMotion.getRobotVelocity") == pytest.approx([SPEED_M_S, 0, 0])
    assert await wired.pending(task)
    await wired.time.advance(1.1)
    assert await wired.done(task) is True
    assert not await wired.call("ALMotion.moveIsActive")
    assert await wired.call("ALMotion.getRobotPosition", True) == pytest.approx([0.7, 0, 0])


async def test_a_turn_then_a_drive_goes_where_the_robot_looks(wired: Wired) -> None:
    turn = await wired.begin("ALMotion.moveTo", 0.0, 0.0, math.pi / 2, kind="move")
    await wired.time.advance(2)
    assert await wired.done(turn) is True
    drive = await wired.begin("ALMotion.moveTo", 0.35, 0.0, 0.0, kind="move")
    await wired.time.advance(2)
    assert await wired.done(drive) is True
    pose = await wired.call("ALMotion.getRobotPosition", True)
    assert pose == pytest.approx([0, 0.35, math.pi / 2], abs=1e-4)


@pytest.mark.parametrize("stop", ["stopMove", "killMove", "killAll"])
async def test_a_drive_is_ended(wired: Wired, stop: str) -> None:
    task = await wired.begin("ALMotion.moveTo", 1.0, 0.0, 0.0, kind="move")
    await wired.time.advance(1.0)
    await wired.call(f"ALMotion.{stop}")
    assert await wired.done(task) is False
    await wired.time.advance(1.0)
    assert (await wired.call("ALMotion.getRobotPosition", True))[0] == pytest.approx(SPEED_M_S)


async def test_a_new_drive_takes_over(wired: Wired) -> None:
    first = await wired.begin("ALMotion.moveTo", 1.0, 0.0, 0.0, kind="move")
    await wired.time.advance(1.0)
    second = asyncio.ensure_future(wired.call("ALMotion.moveTo", -0.35, 0.0, 0.0))
    assert await wired.done(first) is False
    assert await wired.pending(second)
    await wired.time.advance(1.1)
    assert await wired.done(second) is True
    position = await wired.call("ALMotion.getRobotPosition", True)
    assert position == pytest.approx([0, 0, 0], abs=1e-4)


async def test_it_stops_before_an_obstacle(wired: Wired) -> None:
    await wired.robot.set("front", 0.75)
    await wired.call("ALMotion.setOrthogonalSecurityDistance", 0.4)
    task = await wired.begin("ALMotion.moveTo", 0.7, 0.0, 0.0, kind="move")
    await wired.time.advance(3)
    assert await wired.done(task) is False
    assert (await wired.call("ALMotion.getRobotPosition", True))[0] == pytest.approx(0.35)
    assert await wired.robot.get("front") == pytest.approx(0.4)


async def test_an_obstacle_that_is_near_already_lets_nothing_move(wired: Wired) -> None:
    await wired.robot.set("front", 0.3)
    assert await wired.call("ALMotion.moveTo", 0.5, 0.0, 0.0) is False
    back = await wired.begin("ALMotion.moveTo", -0.35, 0.0, 0.0, kind="move")
    await wired.time.advance(2)
    assert await wired.done(back) is True


async def test_less_distance_kept_goes_further(wired: Wired) -> None:
    await wired.robot.set("front", 0.75)
    await wired.call("ALMotion.setOrthogonalSecurityDistance", 0.05)
    task = await wired.begin("ALMotion.moveTo", 0.7, 0.0, 0.0, kind="move")
    await wired.time.advance(3)
    assert await wired.done(task) is True


async def test_a_wall_at_the_side_counts_by_the_tangential_distance(wired: Wired) -> None:
    await wired.robot.set("side", 0.08)
    assert await wired.call("ALMotion.moveTo", 0.5, 0.0, 0.0) is False
    await wired.call("ALMotion.setTangentialSecurityDistance", 0.05)
    assert await wired.call("ALMotion.getTangentialSecurityDistance") == pytest.approx(0.05)
    task = await wired.begin("ALMotion.moveTo", 0.35, 0.0, 0.0, kind="move")
    await wired.time.advance(2)
    assert await wired.done(task) is True


async def test_at_rest_it_neither_drives_nor_moves(wired: Wired) -> None:
    await at_rest(wired)
    assert await wired.call("ALMotion.robotIsWakeUp") is False
    assert await wired.call("ALMotion.moveTo", 0.5, 0.0, 0.0) is False
    assert await wired.call("ALRobotPosture.goToPosture", "Stand", 0.5) is False
    before = await angle(wired, "HeadYaw")
    await wired.call("ALMotion.setAngles", "HeadYaw", 1.0, 0.5)
    await wired.time.advance(5)
    assert await angle(wired, "HeadYaw") == before
    assert set(await wired.call("ALMotion.getStiffnesses", "Body")) == {0.0}


async def test_waking_up_takes_time_and_stands(wired: Wired) -> None:
    await at_rest(wired)
    task = await wired.begin("ALMotion.wakeUp", kind="posture")
    await wired.time.advance(1)
    assert await wired.pending(task)
    await wired.time.advance(2)
    await wired.done(task)
    assert await wired.call("ALRobotPosture.getPosture") == "Stand"
    assert await angle(wired, "HipPitch") == pytest.approx(POSTURES["StandInit"]["HipPitch"])


async def test_angles_are_interpolated(wired: Wired) -> None:
    names, angles, times = HEAD, [0.5, 0.2], [1.0, 1.0]
    task = await wired.begin(
        "ALMotion.angleInterpolation", names, angles, times, True, kind="joints"
    )
    await wired.time.advance(0.5)
    assert await angle(wired, "HeadYaw") == pytest.approx(0.25)
    assert await wired.pending(task)
    await wired.time.advance(0.6)
    await wired.done(task)
    assert await angle(wired, "HeadPitch") == pytest.approx(0.2)


async def test_relative_angles_add_up(wired: Wired) -> None:
    for _ in range(2):
        task = await wired.begin(
            "ALMotion.angleInterpolation", ["HeadYaw"], [0.2], [0.5], False, kind="joints"
        )
        await wired.time.advance(0.6)
        await wired.done(task)
    assert await angle(wired, "HeadYaw") == pytest.approx(0.4)


async def test_an_angle_out_of_range_is_clipped(wired: Wired) -> None:
    task = await wired.begin(
        "ALMotion.angleInterpolation", "HeadYaw", 9.0, 1.0, True, kind="joints"
    )
    await wired.time.advance(1.1)
    await wired.done(task)
    assert await angle(wired, "HeadYaw") == pytest.approx(JOINTS["HeadYaw"][1])


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
    wired: Wired, args: tuple[object, ...], why: str
) -> None:
    with pytest.raises(Said, match=why):
        await wired.call("ALMotion.angleInterpolation", *args)


async def test_kill_all_holds_the_joints(wired: Wired) -> None:
    task = await wired.begin(
        "ALMotion.angleInterpolation", ["HeadYaw"], [1.0], [1.0], True, kind="joints"
    )
    await wired.time.advance(0.5)
    await wired.call("ALMotion.killAll")
    await wired.done(task)
    await wired.time.advance(1)
    assert await angle(wired, "HeadYaw") == pytest.approx(0.5)


async def test_kill_all_ends_an_animation(wired: Wired) -> None:
    path = "animations/Stand/Gestures/Hey_1"
    task = await wired.begin("ALAnimationPlayer.run", path, kind="animation")
    await wired.call("ALMotion.killAll")
    await wired.done(task)
    assert await wired.robot.get("animations") == []


async def test_tasks_are_killed_by_their_joints(wired: Wired) -> None:
    arguments = (["HeadYaw"], [1.0], [1.0], True)
    task = await wired.begin("ALMotion.angleInterpolation", *arguments, kind="joints")
    await wired.call("ALMotion.killTasksUsingResources", ["LArm"])
    assert await wired.pending(task)
    await wired.call("ALMotion.killTasksUsingResources", ["Head"])
    await wired.done(task)


async def test_a_chain_stands_for_its_joints(wired: Wired) -> None:
    await wired.call("ALMotion.setStiffnesses", "Head", 0.5)
    assert await wired.call("ALMotion.getStiffnesses", HEAD) == [0.5, 0.5]
    assert await wired.call("ALMotion.getStiffnesses", "LHand") == [1.0]
    assert len(await wired.call("ALMotion.getAngles", "Body", True)) == len(JOINTS)


@pytest.mark.parametrize("name", ["Leg", "Body", "HipPitch", "HeadYaw"])
async def test_only_head_arms_and_hands_are_stiffened_by_themselves(
    wired: Wired, name: str
) -> None:
    with pytest.raises(Said, match=name):
        await wired.call("ALMotion.setStiffnesses", ["Head", name], 0.0)
    assert await wired.call("ALMotion.getStiffnesses", HEAD) == [1.0, 1.0]


async def test_chains_breathe_on_their_own_and_together(wired: Wired) -> None:
    await wired.call("ALMotion.setBreathEnabled", "Body", False)
    await wired.call("ALMotion.setBreathEnabled", "Arms", True)
    on = [
        await wired.call("ALMotion.getBreathEnabled", chain)
        for chain in ("Head", "Arms", "LArm", "Legs", "Body")
    ]
    assert on == [False, True, True, False, False]
    with pytest.raises(Said, match="chain"):
        await wired.call("ALMotion.getBreathEnabled", "Nose")


async def test_resting_ends_breathing(wired: Wired) -> None:
    await wired.call("ALMotion.setBreathEnabled", "Body", True)
    await at_rest(wired)
    assert await wired.call("ALMotion.getBreathEnabled", "Head") is False


async def test_a_posture_is_reached_and_known(wired: Wired) -> None:
    task = await wired.begin("ALRobotPosture.goToPosture", "Crouch", 0.5, kind="posture")
    await wired.time.advance(3)
    assert await wired.done(task) is True
    assert await wired.call("ALRobotPosture.getPosture") == "Crouch"
    assert await angle(wired, "KneePitch") == pytest.approx(0.5)


async def test_a_posture_that_is_ended_is_not_reached(wired: Wired) -> None:
    task = await wired.begin("ALRobotPosture.goToPosture", "Crouch", 0.5, kind="posture")
    await wired.call("ALRobotPosture.stopMove")
    assert await wired.done(task) is False
    assert await wired.call("ALRobotPosture.getPosture") == "Stand"


async def test_an_unknown_posture_is_refused(wired: Wired) -> None:
    with pytest.raises(Said, match="Handstand"):
        await wired.call("ALRobotPosture.goToPosture", "Handstand", 0.5)


async def test_moves_can_be_told_to_say_no(wired: Wired) -> None:
    await wired.robot.fault("says-no", 10)
    assert await wired.call("ALMotion.moveTo", 0.5, 0.0, 0.0) is False
    assert await wired.call("ALRobotPosture.goToPosture", "Stand", 0.5) is False
    await wired.time.advance(11)
    task = await wired.begin("ALRobotPosture.goToPosture", "Stand", 0.5, kind="posture")
    await wired.time.advance(3)
    assert await wired.done(task) is True
