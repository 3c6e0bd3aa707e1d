"""Motions that go on after their command: each says once how it ended."""

from __future__ import annotations

import asyncio

from tests.bus.rig import Rig
from tests.bus.test_bus import in_rig
from woz_tui.drivers.contract import Scope
from woz_tui.protocol import messages as m

MOTIONS = (m.MotionArrived, m.MotionInterrupted)


def motions(rig: Rig) -> list[tuple[str, str, str]]:
    """Command, kind and reason of everything that was said of motions."""
    return [
        (line.command, type(line).__name__, getattr(line, "reason", ""))
        for line in rig.lines
        if isinstance(line, MOTIONS)
    ]


def test_what_ends_with_its_command_has_arrived_with_it() -> None:
    async def scenario(rig: Rig) -> None:
        rig.send("pose", seconds=1.0)
        rig.send("say")
        rig.send("pose", "fail")

    rig = in_rig(scenario)
    assert motions(rig) == [("c1", "MotionArrived", "")]
    kinds = [type(line).__name__ for line in rig.lines if getattr(line, "command", "") == "c1"]
    assert kinds == ["Command", "Dispatched", "Done", "MotionArrived"]


def test_a_motion_that_goes_on_arrives_when_its_driver_says_so() -> None:
    async def scenario(rig: Rig) -> None:
        rig.send("aim", "goes on")
        await asyncio.sleep(1)
        assert isinstance(rig.end("c1"), m.Done)
        assert not motions(rig)
        await asyncio.to_thread(rig.head.arrivals["c1"], "")
        rig.head.arrivals["c1"]("too late to be true")

    assert motions(in_rig(scenario)) == [("c1", "MotionArrived", "")]


def test_a_motion_that_will_not_arrive_says_why() -> None:
    async def scenario(rig: Rig) -> None:
        rig.send("aim", "goes on")
        await asyncio.sleep(1)
        rig.head.arrivals["c1"]("the dance needs the head")

    rig = in_rig(scenario)
    assert motions(rig) == [("c1", "MotionInterrupted", "the dance needs the head")]


def test_a_drivers_words_for_a_motion_tell_what_its_command_tells() -> None:
    async def scenario(rig: Rig) -> None:
        rig.send("aim", "goes on", tells=("condition",))
        rig.send("aim", "goes on", driver="base", tells=("condition",))
        await asyncio.sleep(1)
        rig.head.arrivals["c1"]("no arm for `wave warmly`")
        await asyncio.sleep(1)
        rig.bus.stop("key")

    rig = in_rig(scenario)
    told = [line.tells for line in rig.lines if isinstance(line, m.MotionInterrupted)]
    assert told == [("condition",), ()]


def test_a_newer_motion_takes_the_place_of_one_under_way() -> None:
    async def scenario(rig: Rig) -> None:
        rig.send("aim", "goes on")
        await asyncio.sleep(1)
        rig.send("aim", "goes on")
        await asyncio.sleep(1)
        rig.head.arrivals["c1"]("")
        rig.head.arrivals["c2"]("")

    rig = in_rig(scenario)
    assert [(command, kind) for command, kind, _ in motions(rig)] == [
        ("c1", "MotionInterrupted"),
        ("c2", "MotionArrived"),
    ]
    (interrupted,) = rig.of(m.MotionInterrupted)
    assert isinstance(interrupted, m.MotionInterrupted)
    assert interrupted.by == "c2"


def test_a_stop_and_a_lost_robot_interrupt_it() -> None:
    async def scenario(rig: Rig) -> None:
        rig.send("aim", "goes on")
        await asyncio.sleep(1)
        rig.bus.stop("key")
        await asyncio.sleep(1)
        rig.bus.release("key")
        rig.send("aim", "goes on")
        await asyncio.sleep(1)
        rig.hub.publish(m.DriverLost(driver="head"))

    rig = in_rig(scenario)
    assert [(command, kind) for command, kind, _ in motions(rig)] == [
        ("c1", "MotionInterrupted"),
        ("c2", "MotionInterrupted"),
    ]
    assert ("stop", Scope.ALL.value) in rig.head.calls


def test_a_newer_setpoint_ends_one_that_waits_without_a_word_about_motion() -> None:
    async def scenario(rig: Rig) -> None:
        rig.send("aim", seconds=1.0)
        rig.send("aim")
        rig.send("aim", "goes on")
        await asyncio.sleep(2)
        rig.head.arrivals["c3"]("")

    rig = in_rig(scenario)
    assert isinstance(rig.end("c2"), m.Superseded)
    assert [(command, kind) for command, kind, _ in motions(rig)] == [
        ("c1", "MotionArrived"),
        ("c3", "MotionArrived"),
    ]
