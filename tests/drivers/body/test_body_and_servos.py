"""A body's own thread and real servos' threads, over a pseudo-terminal: what is written there."""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import sys
import time
from collections.abc import AsyncIterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from woz_drivers.body import Body, BodySettings
from woz_drivers.dynamixel import DynamixelServos, ServoJointSettings, ServoSettings

from tests.drivers.body.rig import robot
from tests.drivers.published_messages import BusJob, until
from tests.drivers.servo_rig import PATIENT_MS, PATIENT_WATCHDOG_MS, WATCHDOG_PATIENCE
from tests.fakes.servos import ServoBus
from woz_tui.bus.hub import Hub
from woz_tui.drivers.contract import DeviceLostError, Driver, DriverError, RejectedError, Scope
from woz_tui.drivers.feeds import Feeds
from woz_tui.protocol.messages import DriverConnected, DriverLost, Message, Notice, Reading
from woz_tui.session.driver_context import SessionDriverContext
from woz_tui.system.clock import RealClock

pytestmark = pytest.mark.real_clock

COUNT = 360 / 4096
IDS = (21, 22, 23, 24, 25)
SPEED = 300.0


@dataclass
class Robot:
    """Both drivers of one robot, and what they said."""

    body: Body
    servos: DynamixelServos
    bus: ServoBus
    said: list[Message]

    def goals(self, name: str) -> list[float]:
        """Every goal written to a joint's servo, in degrees."""
        return [goal for goal, _ in self.goals_and_places(name)]

    def goals_and_places(self, name: str) -> list[tuple[float, float]]:
        """Every goal, and where the joint stood when it was written, in degrees."""
        number = IDS[list(self.body.settings.joints).index(name)]
        found = self.bus.goals_and_places(number)
        return [((goal - 2048) * COUNT, (place - 2048) * COUNT) for goal, place in found]

    def at(self, name: str) -> float:
        """The newest goal."""
        return self.goals(name)[-1]

    async def torque(self) -> None:
        await self.servos.perform(BusJob("torque", {"on": True}))

    def safe(self) -> bool:
        """Whether every goal ever written keeps the joint's range and the servo's speed, but for
        those that let the joint stay where it stands.
        """
        # A late tick may make up for two periods; a count to each side is rounding.
        most = SPEED * 0.02 * 2 + 2 * COUNT
        for name, joint in self.body.settings.joints.items():
            steps = self.goals_and_places(name)
            if not all(joint.min - COUNT <= goal <= joint.max + COUNT for goal, _ in steps):
                return False
            for (before, _), (goal, place) in itertools.pairwise(steps):
                if abs(goal - before) > most and abs(goal - place) > most:
                    return False
        return True


@contextlib.asynccontextmanager
async def assembled(tmp_path: Path, settings: BodySettings) -> AsyncIterator[Robot]:
    """The five joints' body with five servos that follow it, open and found."""
    said: list[Message] = []
    clock, feeds = RealClock(), Feeds()
    hub = Hub(clock, lambda message, line: None)
    hub.listen(said.append)
    with ServoBus(IDS, tmp_path / "servos", patience=WATCHDOG_PATIENCE) as bus:
        joints = {
            name: ServoJointSettings(id=number, min=joint.min, max=joint.max, speed=SPEED)
            for number, (name, joint) in zip(IDS, settings.joints.items(), strict=True)
        }
        followers = ServoSettings(
            port=str(bus.link),
            joints=joints,
            follows="body",
            reply_timeout=PATIENT_MS,
            watchdog=PATIENT_WATCHDOG_MS,
            rest_speed=200.0,
        )

        def context(name: str) -> SessionDriverContext:
            return SessionDriverContext(name, hub, clock, tmp_path, feeds=feeds)

        body = Body("body", settings, context("body"))
        servos = DynamixelServos("head", followers, context("head"))
        drivers: tuple[Driver, ...] = (body, servos)
        for driver in drivers:
            await driver.open()
        try:
            await until(lambda: sum(isinstance(one, DriverConnected) for one in said) >= 2)
            yield Robot(body, servos, bus, said)
        finally:
            for driver in drivers:
                await driver.close()


def five(tmp_path: Path) -> BodySettings:
    return robot("five-joints", tmp_path, servos="head")


@pytest.mark.toolkit("R4", "R6", "G1")
async def test_five_servos_play_what_the_body_plays_within_all_limits(tmp_path: Path) -> None:
    async with assembled(tmp_path, five(tmp_path)) as both_drivers:
        await both_drivers.torque()
        await both_drivers.body.perform(BusJob("pose", {"joints": {"base": 30.0, "roll": 10.0}}))
        await until(
            lambda: (
                abs(both_drivers.at("base") - 30.0) < 1.0
                and abs(both_drivers.at("roll") - 10.0) < 1.0
            )
        )
        await both_drivers.body.perform(
            BusJob("play", {"move": "nod", "speed": 1.5, "amplitude": 1.0})
        )
        nods = both_drivers.goals("nod")
        assert max(nods) - min(nods) > 5.0
        assert both_drivers.safe()
        goals = {name: both_drivers.goals(name)[0] for name in both_drivers.body.settings.joints}
        assert goals == pytest.approx(dict.fromkeys(goals, 0.0), abs=COUNT)  # where they were
        assert {one.driver for one in both_drivers.said if isinstance(one, Reading)} == {
            "body",
            "head",
        }
        names = {one.sensor for one in both_drivers.said if isinstance(one, Reading)}
        assert {"joint.base", "setpoint.base", "tick"} <= names


@pytest.mark.toolkit("G1")
async def test_servos_keep_the_last_safe_pose_when_the_body_dies(tmp_path: Path) -> None:
    async with assembled(tmp_path, five(tmp_path)) as both_drivers:
        await both_drivers.torque()
        await until(lambda: len(both_drivers.goals("base")) > 3)
        dancing = asyncio.create_task(
            both_drivers.body.perform(
                BusJob("play", {"move": "dance", "speed": 1.0, "amplitude": 1.0})
            )
        )
        await until(lambda: abs(both_drivers.at("base")) > 5.0)
        both_drivers.body._ticker.end()  # its thread is gone, without a word
        await until(lambda: both_drivers.body._ticker.ended)
        await until(
            lambda: any(
                isinstance(one, Notice) and "sends no setpoints" in one.text
                for one in both_drivers.said
            )
        )
        held = {name: both_drivers.at(name) for name in both_drivers.body.settings.joints}
        ticks = both_drivers.servos.loop.ticks
        await until(lambda: both_drivers.servos.loop.ticks > ticks + 10)
        assert {name: both_drivers.at(name) for name in held} == held
        assert all(both_drivers.bus.servo(number).torque for number in IDS)
        assert both_drivers.safe()
        dancing.cancel()
        await asyncio.gather(dancing, return_exceptions=True)


@pytest.mark.toolkit("M4", "E4")
@pytest.mark.parametrize("pace", [1.0, 0.1], ids=["in time", "far behind their goals"])
@pytest.mark.safety
async def test_a_stop_reaches_the_servos_and_a_release_brings_them_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, pace: float
) -> None:
    monkeypatch.setattr("woz_drivers.body.driver.STOP_S", 20.0)  # its thread may stand still
    async with assembled(tmp_path, five(tmp_path)) as both_drivers:
        await both_drivers.torque()
        began = time.monotonic()
        both_drivers.bus.clock = lambda: began + pace * (time.monotonic() - began)
        await until(lambda: len(both_drivers.goals("base")) > 3)
        dancing = asyncio.create_task(
            both_drivers.body.perform(
                BusJob("play", {"move": "dance", "speed": 1.0, "amplitude": 1.0})
            )
        )
        await until(lambda: abs(both_drivers.at("base")) > 15.0)
        await asyncio.gather(both_drivers.body.stop(Scope.ALL), both_drivers.servos.stop(Scope.ALL))
        ticks = both_drivers.servos.loop.ticks
        await until(lambda: both_drivers.servos.loop.ticks > ticks + 3)
        held = {name: both_drivers.at(name) for name in both_drivers.body.settings.joints}
        await until(lambda: both_drivers.servos.loop.ticks > ticks + 20)
        assert {name: both_drivers.at(name) for name in held} == held
        behind = time.monotonic() - both_drivers.bus.clock()
        both_drivers.bus.clock = lambda: (
            time.monotonic() - behind
        )  # their time goes on as ours does
        await asyncio.gather(both_drivers.body.resume(), both_drivers.servos.resume(), dancing)
        await both_drivers.body.perform(BusJob("pose", {"joints": {"base": -20.0}}))
        await until(lambda: abs(both_drivers.at("base") + 20.0) < 1.0)
        assert both_drivers.safe()


async def test_the_thread_leaves_the_interpreter_as_it_was(tmp_path: Path) -> None:
    before = sys.getswitchinterval()
    async with assembled(tmp_path, five(tmp_path)) as both_drivers:
        assert both_drivers.body._ticker.lateness.ticks >= 1
    assert sys.getswitchinterval() == before


async def test_a_body_moves_nothing_while_its_servos_are_limp_dead_or_overloaded(
    tmp_path: Path,
) -> None:
    async with assembled(tmp_path, five(tmp_path)) as both_drivers:
        pose = BusJob("pose", {"joints": {"base": 30.0}, "seconds": 0.5})
        with pytest.raises(RejectedError, match="the torque of base is off") as limp:
            await both_drivers.body.perform(pose)
        assert "torque: on" in limp.value.remedy
        await both_drivers.torque()
        await both_drivers.body.perform(pose)
        assert (pose.evidences, pose.arrivals) == (["measured"], [])
        both_drivers.bus.servo(
            IDS[list(both_drivers.body.settings.joints).index("base")]
        ).stuck = True
        with pytest.raises(DriverError, match=r"base stands at .* degrees and not at -30"):
            await both_drivers.body.perform(
                BusJob("pose", {"joints": {"base": -30.0}, "seconds": 0.5})
            )
        both_drivers.bus.pull()
        await until(lambda: any(isinstance(one, DriverLost) for one in both_drivers.said))
        with pytest.raises(DeviceLostError) as gone:
            await both_drivers.body.perform(pose)
        assert gone.value.remedy
