"""Servos that follow a body: slowly at first, then at once, and never beyond their own limits."""

from __future__ import annotations

import asyncio
import itertools
import math
import random
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

import pytest
from woz_drivers.dynamixel import DynamixelServos, ServoJointSettings, ServoSettings

from tests.drivers.published_messages import BusJob, until
from tests.drivers.servo_rig import ServoRig, connected_servos, head
from tests.fakes.servos import ServoBus
from woz_tui.drivers.contract import DeviceLostError, RejectedError, Scope
from woz_tui.motion.body_feeds import PRESENT, SETPOINTS, JointPositions, Setpoints
from woz_tui.protocol.messages import DriverConnected, DriverLost

pytestmark = pytest.mark.real_clock

COUNT = 360 / 4096
SPEED, SLOW = 300.0, 60.0
#: Far enough in the future that setpoints put once do not grow old in a test.
LATER_S = 1000.0


def placed(bus: ServoBus) -> None:
    for number, position in ((11, 1700.0), (12, 2100.0), (13, 2300.0)):
        motor = bus.servo(number)
        motor.position = position
        motor.put(132, 4, round(position))
        motor.put(116, 4, 0)


def say(rig: ServoRig, joints: Mapping[str, object], age: float = -LATER_S) -> None:
    """What the body says, `age` seconds ago."""
    t_us = round((time.monotonic() - age) * 1e6)
    rig.published.context.feed(SETPOINTS, of="body").put(Setpoints(t_us, joints))  # type: ignore[arg-type]


def present(rig: ServoRig) -> JointPositions | None:
    value = rig.published.context.feed(PRESENT).latest().value
    return value if isinstance(value, JointPositions) else None


def steps(goals: Sequence[int]) -> float:
    """The longest step between two goals, in degrees."""
    return max((abs(b - a) for a, b in itertools.pairwise(goals)), default=0) * COUNT


def most(speed: float) -> float:
    """The longest step at a speed: a late tick may catch up two periods; rounding."""
    return speed * 0.02 * 2 + 2 * COUNT


def raw(degrees: float, direction: int = 1) -> int:
    return 2048 + direction * round(degrees / COUNT)


def following(folder: Path) -> ServoSettings:
    return head(folder, follows="body", rest_speed=SLOW)


@pytest.mark.toolkit("R4", "G1")
async def test_the_first_goal_is_the_present_pose_and_the_way_to_the_body_is_slow(
    tmp_path: Path,
) -> None:
    async with connected_servos(tmp_path, prepare=placed, follows="body", rest_speed=SLOW) as rig:
        say(rig, {"pan": 20.0, "tilt": -10.0, "roll": 5.0})
        await rig.ticks(5)
        assert rig.bus.goals(11) == []  # limp: nothing is written
        await rig.do("torque", on=True)
        await until(lambda: rig.bus.goals(11)[-1] == raw(20.0))
        await until(lambda: rig.bus.goals(13)[-1] == raw(5.0, -1))
        for number, first in ((11, 1700), (12, 2100), (13, 2300)):
            goals = rig.bus.goals(number)
            assert goals[0] == first
            assert steps(goals) <= most(SLOW)


@pytest.mark.toolkit("R2")
async def test_once_met_a_joint_follows_without_delay(tmp_path: Path) -> None:
    async with connected_servos(tmp_path, follows="body", rest_speed=SLOW) as rig:
        say(rig, {"pan": 1.0})
        await rig.do("torque", on=True)
        await until(lambda: rig.bus.goals(11)[-1] == raw(1.0))
        last, before = raw(1.0), len(rig.bus.goals(11))
        for target in (3.0, 5.0, 2.0, -1.0):  # within a tick at 300 deg/s, two if one is late
            say(rig, {"pan": target})

            def others(before: int = before, last: int = last) -> list[int]:
                """What was written since; goals are written again now and then."""
                return [goal for goal in rig.bus.goals(11)[before:] if goal != last]

            await until(lambda o=others, to=target: raw(to) in o())  # type: ignore[misc]
            assert others().index(raw(target)) <= 1
            last, before = raw(target), len(rig.bus.goals(11))


@pytest.mark.toolkit("R4", "R1", "R2")
async def test_whatever_the_body_says_goals_stay_in_range_and_under_speed(tmp_path: Path) -> None:
    dice = random.Random(4)
    nonsense = (math.nan, math.inf, -math.inf, 1e300, -1000.0, 90.001)
    async with connected_servos(tmp_path, follows="body", torque=True) as rig:
        await until(lambda: rig.bus.servo(11).torque)
        say(rig, {"pan": 0.0, "tilt": 0.0, "roll": 0.0})
        await rig.ticks(3)
        for _ in range(60):
            names = dice.sample(["pan", "tilt", "roll", "nose"], dice.randint(0, 4))
            say(rig, {n: dice.choice([*nonsense, dice.uniform(-200, 200)]) for n in names})
            await rig.ticks(dice.randint(0, 2))
        while len(rig.bus.goals(11)) <= 10:  # a busy machine leaves ticks out
            say(rig, {"pan": dice.uniform(-200, 200)})
            await rig.ticks(1)
        for number, low, high in ((11, -90, 90), (12, -40, 30), (13, -45, 45)):
            goals = rig.bus.goals(number)
            assert all(raw(low) <= goal <= raw(high) for goal in goals)
            assert steps(goals) <= most(SPEED)


@pytest.mark.toolkit("G1")
async def test_a_body_that_falls_silent_leaves_the_joints_where_they_are(tmp_path: Path) -> None:
    async with connected_servos(tmp_path, follows="body", rest_speed=SLOW, torque=True) as rig:
        say(rig, {"pan": 10.0})
        await until(lambda: bool(rig.bus.goals(11)) and rig.bus.goals(11)[-1] == raw(10.0))
        say(rig, {"pan": 60.0}, age=0.6)  # said by a body that died on the way
        await rig.noticed("body sends no setpoints")
        await rig.ticks(10)
        assert rig.bus.goals(11)[-1] == raw(10.0)
        before = len(rig.bus.goals(11))
        say(rig, {"pan": 30.0})
        await rig.noticed("body is connected")
        await until(lambda: rig.bus.goals(11)[-1] == raw(30.0))
        assert steps(rig.bus.goals(11)[before - 1 :]) <= most(SLOW)


@pytest.mark.toolkit("M4")
@pytest.mark.safety
async def test_a_stop_holds_and_a_release_follows_again_slowly(tmp_path: Path) -> None:
    async with connected_servos(tmp_path, follows="body", rest_speed=SLOW, torque=True) as rig:
        say(rig, {"pan": 40.0})
        await until(lambda: bool(rig.bus.goals(11)) and rig.bus.goals(11)[-1] > raw(5.0))
        await rig.driver.stop(Scope.ALL)
        await rig.ticks(3)  # the servos have heard of it
        held = rig.bus.goals(11)[-1]
        say(rig, {"pan": -40.0})
        await rig.ticks(10)
        assert rig.bus.goals(11)[-1] == held
        before = len(rig.bus.goals(11))
        await rig.driver.resume()
        await until(lambda: rig.bus.goals(11)[-1] == raw(-40.0))
        assert steps(rig.bus.goals(11)[before - 1 :]) <= most(SLOW)


@pytest.mark.toolkit("R4")
async def test_a_cable_pulled_and_plugged_in_again_begins_anew(tmp_path: Path) -> None:
    async with connected_servos(tmp_path, follows="body", rest_speed=SLOW, torque=True) as rig:
        say(rig, {"pan": 15.0})
        await until(lambda: bool(rig.bus.goals(11)) and rig.bus.goals(11)[-1] == raw(15.0))
        rig.bus.pull()
        await rig.published.first(DriverLost)
        found = present(rig)
        assert found is not None and not found.joints and not found.held
        rig.bus.plug()
        await rig.published.first(DriverConnected, after=1)
        await rig.ticks(3)
        assert not rig.bus.servo(11).torque
        placed(rig.bus)  # somebody turned it in the meantime
        await rig.ticks(3)
        before = len(rig.bus.goals(11))
        await rig.do("torque", on=True)
        await until(lambda: rig.bus.goals(11)[-1] == raw(15.0))
        goals = rig.bus.goals(11)[before:]
        assert goals[0] == 1700
        assert steps(goals) <= most(SLOW)


async def test_what_is_told_to_the_body(tmp_path: Path) -> None:
    async with connected_servos(tmp_path, prepare=placed, follows="body") as rig:
        await until(lambda: (found := present(rig)) is not None and len(found.joints) == 3)
        found = present(rig)
        assert found is not None
        assert found.joints["pan"] == pytest.approx((1700 - 2048) * COUNT)
        assert found.held == frozenset()
        assert abs(found.t_us / 1e6 - time.monotonic()) < 30
        await rig.do("torque", on=True, joint="tilt")
        await until(lambda: (now := present(rig)) is not None and now.held == {"tilt"})


async def test_a_joint_is_told_in_the_degrees_of_its_body(tmp_path: Path) -> None:
    async with connected_servos(tmp_path, prepare=placed, follows="body") as rig:
        await until(lambda: bool(rig.published.values("joint.pan")))
        assert rig.published.values("joint.pan")[-1] == pytest.approx(
            (1700 - 2048) * COUNT, abs=0.01
        )
        body = rig.published.context.feed(SETPOINTS, of="body")
        body.put(Setpoints(round(time.monotonic() * 1e6), {"pan": 5.0}, {"pan": 5.0}))
        before = len(rig.published.values("joint.pan"))
        await until(lambda: len(rig.published.values("joint.pan")) > before + 1)
        there = (1700 - 2048) * COUNT - 5.0
        assert rig.published.values("joint.pan")[-1] == pytest.approx(there, abs=0.01)


async def test_only_torque_and_reboot_are_left_to_ask_for(tmp_path: Path) -> None:
    async with connected_servos(tmp_path, follows="body") as rig:
        settings = rig.driver.settings
        assert [verb.name for verb in rig.driver.offer(settings).verbs] == ["torque", "reboot"]
        assert not [
            name for name in rig.driver.offer(settings).sensors if name.startswith("setpoint")
        ]
        with pytest.raises(RejectedError, match="follow 'body'"):
            await rig.driver.perform(BusJob("pose", {"joints": {"pan": 3.0}, "seconds": 1.0}))
        await rig.published.until(lambda: bool(rig.published.values("joint.pan")))
        assert rig.published.values("setpoint.pan") == []


def test_settings_that_a_follower_does_not_use_are_told(tmp_path: Path) -> None:
    settings = head(tmp_path / "x", follows="body", pan="pan", poses={"up": {"tilt": 3.0}})
    assert {path for path, _ in settings.problems()} == {"pan", "poses"}
    assert following(tmp_path / "x").problems() == []


async def test_the_torque_stays_until_the_body_is_at_rest(tmp_path: Path) -> None:
    joints = {"pan": ServoJointSettings(id=11, min=-90, max=90, speed=SPEED)}
    async with connected_servos(
        tmp_path, ids=(11,), joints=joints, follows="body", torque=True, rest_speed=SPEED
    ) as rig:
        say(rig, {"pan": 0.0})
        await until(lambda: rig.bus.servo(11).torque)
        await rig.ticks(2)
        rest = asyncio.create_task(rig.driver.rest())
        for target in range(0, 30, 2):
            say(rig, {"pan": float(target)})
            await rig.ticks(3)
            assert rig.bus.servo(11).torque
        await rest
        assert not rig.bus.servo(11).torque
        assert rig.bus.goals(11)[-1] == raw(28.0)


async def test_the_torque_stays_while_the_body_is_on_a_slow_way_to_rest(tmp_path: Path) -> None:
    joints = {"pan": ServoJointSettings(id=11, min=-90, max=90, speed=SPEED)}
    async with connected_servos(
        tmp_path, ids=(11,), joints=joints, follows="body", torque=True
    ) as rig:
        body = rig.published.context.feed(SETPOINTS, of="body")
        later = round((time.monotonic() + LATER_S) * 1e6)
        body.put(Setpoints(later, {"pan": 0.0}, at_rest=False))
        await until(lambda: rig.bus.servo(11).torque)
        await rig.ticks(2)
        rest = asyncio.create_task(rig.driver.rest())
        await rig.ticks(60)  # more than twice as long as standing still takes to be believed
        assert rig.bus.servo(11).torque
        assert not rest.done()
        body.put(Setpoints(later, {"pan": 0.0}, at_rest=True))
        await rest
        assert not rig.bus.servo(11).torque


async def test_without_a_line_a_follower_is_lost_like_any_servo(tmp_path: Path) -> None:
    async with connected_servos(tmp_path, follows="body") as rig:
        say(rig, {"pan": 5.0})
        rig.bus.pull()
        await rig.published.first(DriverLost)
        with pytest.raises(DeviceLostError):
            await rig.driver.perform(BusJob("torque", {"on": True}))
        await rig.driver.stop(Scope.ALL)  # limp joints: nothing to stop


@contextmanager
def five(folder: Path) -> Iterator[tuple[dict[str, ServoJointSettings], Sequence[int]]]:
    names = ("base", "lean", "neck", "nod", "roll")
    yield (
        {
            name: ServoJointSettings(id=21 + i, min=-60, max=60, speed=SPEED)
            for i, name in enumerate(names)
        },
        tuple(range(21, 26)),
    )


@pytest.mark.toolkit("R6")
async def test_five_joints_follow_as_three_do(tmp_path: Path) -> None:
    with five(tmp_path) as (joints, ids):
        async with connected_servos(
            tmp_path, ids=ids, joints=joints, follows="body", torque=True
        ) as rig:
            assert isinstance(rig.driver, DynamixelServos)
            targets = {name: 4.0 * (index - 2) for index, name in enumerate(joints)}
            say(rig, targets)
            for number, target in zip(ids, targets.values(), strict=True):
                await until(
                    lambda number=number, target=target: (
                        bool(rig.bus.goals(number))  # type: ignore[misc]
                        and rig.bus.goals(number)[-1] == raw(target)
                    )
                )
