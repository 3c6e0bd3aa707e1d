"""Faults on demand and the service StandIn, in this loop; `test_naoqi_process` has the others."""

from __future__ import annotations

import asyncio
import json

import pytest
from naoqi_simulator.world import SimulatorOptions

from tests.drivers.naoqi.robot_callers import RobotCallError, SimulatedRobotRig, own_caller
from tests.fakes.naoqi import stand_in_here


async def test_memory_refuses_as_an_old_naoqi_does(rig: SimulatedRobotRig) -> None:
    await rig.robot.fault("invalid-signature", 5)
    for method in ("subscriber", "getData", "getListData"):
        with pytest.raises(RobotCallError, match=r"^Invalid signature$"):
            await rig.call(f"ALMemory.{method}", "FaceDetected")
    await rig.time.advance(6)
    assert await rig.call("ALMemory.getData", "FaceDetected") == []


async def test_subscriber_is_refused_unless_told_otherwise() -> None:
    async with stand_in_here(options=SimulatorOptions(visitors=False)) as robot:
        call, client = await own_caller(robot)
        with pytest.raises(RobotCallError, match=r"^Invalid signature$"):
            await call("ALMemory.subscriber", "FaceDetected")
        await client.close()


async def test_a_deaf_robot_answers_when_it_hears_again(rig: SimulatedRobotRig) -> None:
    await rig.robot.fault("deaf")
    asked = asyncio.ensure_future(rig.call("ALSystem.robotName"))
    await rig.robot.called("ALSystem.robotName")
    await rig.time.advance(1000)
    assert json.loads(await rig.call("StandIn.get", "faults")) == ["deaf"]
    assert not asked.done()
    await rig.robot.fault("none")
    assert await rig.done(asked) == "Pepper"


async def test_deafness_passes_after_its_time(rig: SimulatedRobotRig) -> None:
    await rig.robot.fault("deaf", 3)
    asked = asyncio.ensure_future(rig.call("ALSystem.robotName"))
    await rig.robot.called("ALSystem.robotName")
    await rig.time.advance(4)
    assert await rig.done(asked) == "Pepper"


async def test_a_slow_robot_answers_late(rig: SimulatedRobotRig) -> None:
    loop = asyncio.get_running_loop()
    await rig.robot.fault("slow:150")
    begun = loop.time()
    await rig.call("ALSystem.robotName")
    assert loop.time() - begun >= 0.149


async def test_only_the_method_that_was_named_refuses(rig: SimulatedRobotRig) -> None:
    await rig.robot.fault("refuse:ALLeds.reset=the eyes are shut")
    with pytest.raises(RobotCallError, match="the eyes are shut"):
        await rig.call("ALLeds.reset", "FaceLeds")
    await rig.call("ALLeds.on", "FaceLeds")
    await rig.robot.clear()
    await rig.call("ALLeds.reset", "FaceLeds")


async def test_the_trace_has_every_method_with_its_arguments(rig: SimulatedRobotRig) -> None:
    await rig.call("ALTextToSpeech.setVolume", 0.5)
    await rig.call("ALMemory.insertData", "Raw", b"\x00\x01")
    first, second = await rig.robot.trace()
    assert (first.name, first.args) == ("ALTextToSpeech.setVolume", [0.5])
    assert second.args == ["Raw", {"bytes": 2}]
    assert first.at_ns < second.at_ns
    await rig.robot.clear()
    assert await rig.robot.trace() == []


async def test_a_refused_call_is_in_the_trace_too(rig: SimulatedRobotRig) -> None:
    with pytest.raises(RobotCallError):
        await rig.call("ALAnimationPlayer.run", "nothing")
    assert [call.name for call in await rig.robot.trace()] == ["ALAnimationPlayer.run"]


@pytest.mark.parametrize(
    "order",
    [
        {"do": "dance"},
        {"do": "fault", "kind": "tired"},
        {"do": "set", "name": "awake", "value": True},
        {"do": "set", "name": "front", "value": "near"},
        {"do": "set", "name": "life", "value": "happy"},
        {"do": "get", "name": "nothing"},
        {"do": "get", "name": "memory:nothing"},
        {"do": "person", "who": {"distance": "far"}},
        {"do": "person", "who": {"height": 2}},
        {"do": "person", "who": 5},
        {"do": "touch", "x": 2, "y": 0},
    ],
    ids=str,
)
async def test_orders_that_make_no_sense_are_refused(
    rig: SimulatedRobotRig, order: dict[str, object]
) -> None:
    before = await rig.robot.get("state")
    with pytest.raises(AssertionError):
        await rig.robot.order(**order)
    assert await rig.robot.get("state") == before


async def test_state_and_keys_can_be_looked_at_and_set(rig: SimulatedRobotRig) -> None:
    await rig.robot.set("memory:Mine", {"a": 1})
    assert await rig.robot.get("memory:Mine") == {"a": 1}
    assert await rig.call("ALMemory.getData", "Mine") == {"a": 1}
    await rig.robot.set("front", 1.5)
    assert (await rig.robot.get("state"))["front"] == 1.5
    await rig.robot.set("front", None)
    assert await rig.robot.get("front") is None
