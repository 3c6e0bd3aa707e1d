"""Faults on demand and the service StandIn, in this loop; `test_naoqi_process` has the others."""

from __future__ import annotations

import asyncio
import json

import pytest
from naoqi_simulator.world import SimulatorOptions

from tests.drivers.naoqi.hands import Said, Wired, own_caller
from tests.fakes.naoqi import stand_in_here


async def test_memory_refuses_as_an_old_naoqi_does(wired: Wired) -> None:
    await wired.robot.fault("invalid-signature", 5)
    for method in ("subscriber", "getData", "getListData"):
        with pytest.raises(Said, match=r"^Invalid signature$"):
            await wired.call(f"ALMemory.{method}", "FaceDetected")
    await wired.time.advance(6)
    assert await wired.call("ALMemory.getData", "FaceDetected") == []


async def test_subscriber_is_refused_unless_told_otherwise() -> None:
    async with stand_in_here(options=SimulatorOptions(visitors=False)) as robot:
        call, client = await own_caller(robot)
        with pytest.raises(Said, match=r"^Invalid signature$"):
            await call("ALMemory.subscriber", "FaceDetected")
        await client.close()


async def test_a_deaf_robot_answers_when_it_hears_again(wired: Wired) -> None:
    await wired.robot.fault("deaf")
    asked = asyncio.ensure_future(wired.call("ALSystem.robotName"))
    await wired.robot.called("ALSystem.robotName")
    await wired.time.advance(1000)
    assert json.loads(await wired.call("StandIn.get", "faults")) == ["deaf"]
    assert not asked.done()
    await wired.robot.fault("none")
    assert await wired.done(asked) == "Pepper"


async def test_deafness_passes_after_its_time(wired: Wired) -> None:
    await wired.robot.fault("deaf", 3)
    asked = asyncio.ensure_future(wired.call("ALSystem.robotName"))
    await wired.robot.called("ALSystem.robotName")
    await wired.time.advance(4)
    assert await wired.done(asked) == "Pepper"


async def test_a_slow_robot_answers_late(wired: Wired) -> None:
    loop = asyncio.get_running_loop()
    await wired.robot.fault("slow:150")
    begun = loop.time()
    await wired.call("ALSystem.robotName")
    assert loop.time() - begun >= 0.149


async def test_only_the_method_that_was_named_refuses(wired: Wired) -> None:
    await wired.robot.fault("refuse:ALLeds.reset=the eyes are shut")
    with pytest.raises(Said, match="the eyes are shut"):
        await wired.call("ALLeds.reset", "FaceLeds")
    await wired.call("ALLeds.on", "FaceLeds")
    await wired.robot.clear()
    await wired.call("ALLeds.reset", "FaceLeds")


async def test_the_trace_has_every_method_with_its_arguments(wired: Wired) -> None:
    await wired.call("ALTextToSpeech.setVolume", 0.5)
    await wired.call("ALMemory.insertData", "Raw", b"\x00\x01")
    first, second = await wired.robot.trace()
    assert (first.name, first.args) == ("ALTextToSpeech.setVolume", [0.5])
    assert second.args == ["Raw", {"bytes": 2}]
    assert first.at_ns < second.at_ns
    await wired.robot.clear()
    assert await wired.robot.trace() == []


async def test_a_refused_call_is_in_the_trace_too(wired: Wired) -> None:
    with pytest.raises(Said):
        await wired.call("ALAnimationPlayer.run", "nothing")
    assert [call.name for call in await wired.robot.trace()] == ["ALAnimationPlayer.run"]


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
    wired: Wired, order: dict[str, object]
) -> None:
    before = await wired.robot.get("state")
    with pytest.raises(AssertionError):
        await wired.robot.order(**order)
    assert await wired.robot.get("state") == before


async def test_state_and_keys_can_be_looked_at_and_set(wired: Wired) -> None:
    await wired.robot.set("memory:Mine", {"a": 1})
    assert await wired.robot.get("memory:Mine") == {"a": 1}
    assert await wired.call("ALMemory.getData", "Mine") == {"a": 1}
    await wired.robot.set("front", 1.5)
    assert (await wired.robot.get("state"))["front"] == 1.5
    await wired.robot.set("front", None)
    assert await wired.robot.get("front") is None
