"""The base: driving and turning from where it stands."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Mapping
from typing import Any, ClassVar

from woz_drivers.naoqi_robot.memory import items
from woz_drivers.naoqi_robot.memory import number as number_of
from woz_drivers.naoqi_robot.parts import LOOK_S, NaoqiPart, answers
from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_tui.drivers.argument_values import number
from woz_tui.drivers.contract import (
    DriverError,
    Forecast,
    Job,
    Offer,
    RejectedError,
    Scope,
)
from woz_tui.drivers.robot_parts import Pending
from woz_tui.drivers.robot_verbs import common_verb
from woz_tui.protocol.messages import Json

MOTION = "ALMotion"
#: It starts and brakes gently, and goes round what it can: it may take so much longer.
SLACK_FACTOR, SLACK_S = 4.0, 10.0
#: Slower than this it stands (m/s, rad/s); how often it is asked while it comes to a halt.
STILL, ASK_S = 0.01, 0.03


class BasePart(NaoqiPart):
    """Three wheels by `ALMotion.moveTo`; the posture stays as it is."""

    name = "driving"
    #: What `drive` does, for a list of verbs.
    SUMMARY: ClassVar[str] = "drive and turn from where it stands"
    #: Speeds that it goes at unless it is told otherwise; the expected time is made of them.
    M_S: ClassVar[float] = 0.35
    RAD_S: ClassVar[float] = 1.0

    @classmethod
    def offer(cls, settings: NaoqiSettings) -> Offer:
        """`drive`."""
        return Offer(verbs=(common_verb("drive", cls.SUMMARY, arrives=True),))

    async def predict(self, verb: str, args: Mapping[str, Any]) -> Forecast:
        """About: it starts and brakes gently."""
        return Forecast(self._seconds(*_way(args)), ())

    def _seconds(self, x: float, y: float, turn: float) -> float:
        return max(math.hypot(x, y) / self.M_S, abs(math.radians(turn)) / self.RAD_S)

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Drive there; fails with a sentence when something is in the way."""
        x, y, turn = _way(job.args)
        await self._cleaned_up()
        # A robot that was silent for a while must not set off when it wakes from that.
        await self._link.probe()
        await self._ready()
        seconds = self._seconds(x, y, turn)
        job.expects(seconds)
        arrived = await self._drive(x, y, math.radians(turn), seconds * SLACK_FACTOR + SLACK_S)
        if arrived is False:
            raise DriverError(*await self._why())
        return {"x": x, "y": y, "turn": turn}

    async def halt(self, scope: Scope) -> Pending:
        """Brake; returns when the robot says that it stands."""
        await self._link.call(MOTION, "stopMove")
        while not await self._stands():  # noqa: ASYNC110
            await asyncio.sleep(ASK_S)  # the robot tells of no end: it has to be asked
        return ()

    async def _ready(self) -> None:
        """Return if it can go now. Raises `DriverError`."""
        if not await self._link.call(MOTION, "robotIsWakeUp"):
            raise DriverError("the robot is at rest and cannot drive", "wake it: `torque: true`")

    async def _stands(self) -> bool:
        """Whether it stands still. Raises `DriverError` if the robot does not say it."""
        return still(await self._link.call(MOTION, "getRobotVelocity"))

    async def _drive(self, x: float, y: float, turn: float, within: float) -> object:
        try:
            return await self._link.call(MOTION, "moveTo", x, y, turn, within=within)
        except (asyncio.CancelledError, DriverError):
            # Cut short, or no answer in time: it must not drive on by itself.
            self._clean_up.start(self._link.call(MOTION, "stopMove"))
            raise

    async def _why(self) -> tuple[str, str]:
        """A sentence and a remedy for a drive that ended before its goal."""
        call = self._link.call
        kept = await answers(
            {
                "ahead": call(MOTION, "getOrthogonalSecurityDistance", within=LOOK_S),
                "beside": call(MOTION, "getTangentialSecurityDistance", within=LOOK_S),
            }
        )
        metres = {where: number_of(distance) for where, distance in kept.items()}
        distances = " and ".join(
            f"{distance:.2f} m {where}"
            for where, distance in metres.items()
            if distance is not None
        )
        within = f" (it keeps {distances})" if distances else ""
        return (
            f"the robot did not arrive: something is within its security distance{within},"
            " or an animation has its body",
            "clear the way, or let it keep less distance with `collision`; then drive again",
        )


def still(velocity: object) -> bool:
    """Whether it stands. Raises `DriverError` if the robot does not say it: then nobody knows."""
    speeds = [number_of(speed) for speed in items(velocity)]
    known = [speed for speed in speeds if speed is not None]
    if not known or len(known) < len(speeds):
        raise DriverError("the robot does not report its speed", "check whether it stands still")
    return all(abs(speed) < STILL for speed in known)


def _way(args: Mapping[str, Any]) -> tuple[float, float, float]:
    """Metres forward and to the left, degrees to the left."""
    x, y, turn = (number(args, name) for name in ("x", "y", "turn"))
    if x == y == turn == 0.0:
        raise RejectedError("no distance and no turn is given", "give x, y or turn")
    return x, y, turn
