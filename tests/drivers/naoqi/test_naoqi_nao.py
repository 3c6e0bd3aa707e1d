"""The simulated robot as a NAO: it walks in steps, falls where a real one would, gets up, feels."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from typing import Any

import pytest
from naoqi_simulator.nao_body import NAO
from naoqi_simulator.world import SimulatorOptions
from qimessaging import NaoqiClient

from tests.drivers.naoqi.robot_callers import (
    HandTime,
    RobotCallError,
    SimulatedRobotRig,
    own_caller,
    qi_caller,
    qi_session,
)
from tests.fakes.libqi import needed
from tests.fakes.naoqi import PATIENCE_S, stand_in, stand_in_here

FALLEN, FALLING = "robotHasFallen", "ALMotion/RobotIsFalling"
STANDING = "animations/Stand/Gestures/Hey_1"
SITTING = "animations/Sit/Gestures/Hey_3"


@pytest.fixture
async def nao() -> AsyncIterator[SimulatedRobotRig]:
    """A NAO in this loop that stands, reached over a socket; its time stands still."""
    time = HandTime()
    options = SimulatorOptions(robot="nao", visitors=False, invalid_signature=False)
    async with stand_in_here(time, options) as robot:
        client = await NaoqiClient.open("127.0.0.1", int(robot.address.rpartition(":")[2]))
        try:
            yield SimulatedRobotRig(robot, client, time)
        finally:
            await client.close()


async def walking(nao: SimulatedRobotRig) -> Any:
    walk = await nao.begin("ALMotion.moveTo", 1.0, 0.0, 0.0, kind="move")
    await nao.pass_by(2.0)
    assert await nao.call("ALMotion.moveIsActive") is True
    return walk


async def fell(nao: SimulatedRobotRig) -> bool:
    flags = [await nao.robot.get(f"memory:{key}") for key in (FALLEN, FALLING)]
    return flags == [True, True]


async def take(nao: SimulatedRobotRig, posture: str) -> bool:
    taking = await nao.begin("ALRobotPosture.goToPosture", posture, 0.5, kind="posture")
    await nao.pass_by(20.0)
    reached: bool = await nao.done(taking)
    return reached


async def test_a_walk_ends_with_the_step_that_is_begun(nao: SimulatedRobotRig) -> None:
    walk = await walking(nao)
    await nao.call("ALMotion.stopMove")
    assert await nao.done(walk) is False
    assert await nao.call("ALMotion.moveIsActive") is True
    await nao.time.advance(NAO.step_s + 0.01)
    assert await nao.call("ALMotion.moveIsActive") is False
    assert (await nao.call("ALMotion.getRobotPosition", True))[0] == pytest.approx(0.184, abs=0.01)
    assert await nao.call("ALRobotPosture.getPostureFamily") == "Standing"


@pytest.mark.parametrize(
    ("method", "args"),
    [("killMove", ()), ("killAll", ()), ("killTasksUsingResources", (["LLeg"],))],
)
async def test_a_walk_that_is_killed_ends_in_a_fall(
    nao: SimulatedRobotRig, method: str, args: Any
) -> None:
    walk = await walking(nao)
    await nao.call(f"ALMotion.{method}", *args)
    assert await nao.done(walk) is False
    assert await fell(nao)


async def test_arms_that_are_stopped_leave_it_walking(nao: SimulatedRobotRig) -> None:
    await walking(nao)
    await nao.call("ALMotion.killTasksUsingResources", ["LArm", "RArm", "Head"])
    assert await nao.call("ALMotion.moveIsActive") is True
    assert nao.pepper.world.falls.lies is False


async def test_who_lies_gets_up_when_its_motors_are_stiff(nao: SimulatedRobotRig) -> None:
    await nao.robot.fault("fall:back")
    assert await fell(nao)
    assert await nao.call("ALRobotPosture.getPostureFamily") == "LyingBack"
    assert await nao.call("ALMotion.robotIsWakeUp") is False
    assert await nao.call("ALMotion.moveTo", 1.0, 0.0, 0.0) is False
    assert await nao.call("ALRobotPosture.goToPosture", "Stand", 0.5) is False
    await nao.call("ALMotion.setStiffnesses", "Body", 1.0)
    assert await take(nao, "Stand") is True
    assert await nao.call("ALRobotPosture.getPostureFamily") == "Standing"
    # Nothing takes the values back, as on the real one.
    assert await fell(nao)


async def test_a_seated_robot_plays_what_is_for_a_seat_and_falls_over_the_rest(
    nao: SimulatedRobotRig,
) -> None:
    assert await take(nao, "Sit") is True
    playing = await nao.begin(
        "ALAnimationPlayer.run", "animations/[posture]/Gestures/Hey_3", kind="animation"
    )
    await nao.pass_by(3.0)
    await nao.done(playing)
    assert nao.pepper.animations.done == [SITTING]
    assert await nao.call("ALMotion.moveTo", 1.0, 0.0, 0.0) is False
    await nao.call("ALAnimationPlayer.run", STANDING)
    assert await fell(nao)


async def test_it_has_26_joints_and_their_limits(nao: SimulatedRobotRig) -> None:
    assert len(await nao.call("ALMotion.getBodyNames", "Body")) == 26
    (low, high, *_), *_ = await nao.call("ALMotion.getLimits", "LKneePitch")
    assert (low, high) == pytest.approx((-0.092346, 2.112528))
    for posture, angles in NAO.postures.items():
        assert all(NAO.clip(joint, angle) == angle for joint, angle in angles.items()), posture


async def test_it_feels_touches_and_heat(nao: SimulatedRobotRig) -> None:
    key = "Device/SubDeviceList/Head/Touch/Front/Sensor/Value"
    assert await nao.call("ALMemory.getData", key) == 0.0
    await nao.robot.set("touched", ["Head/Touch/Front"])
    assert await nao.call("ALMemory.getData", key) == 1.0
    assert await nao.call("ALBodyTemperature.getTemperatureDiagnosis") == []
    await nao.robot.set("temperatures", {"LKneePitch": 81, "RKneePitch": 76})
    assert await nao.call("ALBodyTemperature.getTemperatureDiagnosis") == [2, ["LKneePitch"]]
    warm = "Device/SubDeviceList/RKneePitch/Temperature/Sensor"
    assert await nao.call("ALMemory.getListData", [f"{warm}/Value", f"{warm}/Status"]) == [76, 1]
    for name, wrong in (("touched", ["Tail"]), ("temperatures", {"Tail": 50})):
        with pytest.raises(AssertionError, match="Tail"):
            await nao.robot.set(name, wrong)


async def test_each_sonar_sees_its_side(nao: SimulatedRobotRig) -> None:
    await nao.call("ALSonar.subscribe", "test")
    keys = [f"Device/SubDeviceList/US/{side}/Sensor/Value" for side in ("Left", "Right")]
    await nao.robot.person({"distance": 0.8, "angle": -0.6})
    assert await nao.call("ALMemory.getListData", keys) == [5.0, pytest.approx(0.8)]
    await nao.robot.person({"distance": 0.8, "angle": 0.0})
    assert await nao.call("ALMemory.getListData", keys) == [pytest.approx(0.8)] * 2


async def test_it_has_no_tablet_and_a_pepper_does_not_fall(
    nao: SimulatedRobotRig, rig: SimulatedRobotRig
) -> None:
    with pytest.raises(RobotCallError):
        await nao.call("ALTabletService.hideWebview")
    with pytest.raises(AssertionError, match="tablet"):
        await nao.robot.touch(0.5, 0.5)
    with pytest.raises(AssertionError, match="no fault 'fall'"):
        await rig.robot.fault("fall")


@needed
@pytest.mark.real_clock
@pytest.mark.parametrize("server", ["own", "qi"])
async def test_the_robots_own_library_plays_it(server: str) -> None:
    """As its programs do: walk, sit down, look through either camera, hear that it has fallen."""
    async with stand_in(server, options=("--robot", "nao")) as robot:
        async with qi_session(robot.address) as session:
            call = qi_caller(session)
            assert await call("ALSystem.robotName") == "NAO"
            assert await call("ALMotion.moveTo", 0.08, 0.0, 0.0) is True
            assert await call("ALRobotPosture.goToPosture", "Sit", 1.0) is True
            assert await call("ALRobotPosture.getPostureFamily") == "Sitting"
            handle = await call("ALVideoDevice.subscribeCamera", "eye", 1, 0, 11, 5)
            assert (await call("ALVideoDevice.getImageRemote", handle))[7] == 1
            await robot.set("temperatures", {"LKneePitch": 76})
            assert await call("ALBodyTemperature.getTemperatureDiagnosis") == [1, ["LKneePitch"]]
            heard: list[Any] = []
            subscriber = await call("ALMemory.subscriber", FALLEN)
            await asyncio.to_thread(subscriber.signal.connect, heard.append)
            await robot.fault("fall")

            async def came() -> bool:
                return heard == [True]

            await robot.until(came, PATIENCE_S)
        other, client = await own_caller(robot)
        assert await other("ALRobotPosture.getPostureFamily") == "LyingBelly"
        await client.close()
