"""Walking: `drive` on two legs."""

from __future__ import annotations

import asyncio
from typing import ClassVar

from woz_drivers.nao.falls import FALLEN
from woz_drivers.naoqi_robot import memory
from woz_drivers.naoqi_robot.base import MOTION, BasePart, still
from woz_drivers.naoqi_robot.parts import RobotCalls
from woz_tui.drivers.contract import DriverError
from woz_tui.drivers.robot_parts import RefusalAllowed

#: The families of postures in which it can begin to walk.
ON_ITS_FEET = ("Standing",)


async def walks(robot: RobotCalls) -> bool:
    """Whether a step is under way. Raises `DriverError` where the robot does not say it."""
    answer = memory.flag(await robot.call(MOTION, "moveIsActive"))
    if answer is None:
        raise DriverError("the robot does not report whether it walks", "look at the robot")
    return answer


class WalkingPart(BasePart):
    """By `ALMotion.moveTo`; a stop ends the step that is begun, so that it keeps its balance."""

    name = "walking"
    SUMMARY: ClassVar[str] = "walk and turn from where it stands"
    M_S: ClassVar[float] = 0.08
    RAD_S: ClassVar[float] = 0.4

    async def _ready(self) -> None:
        await super()._ready()
        family = memory.word(await self._link.call("ALRobotPosture", "getPostureFamily"))
        if family not in ON_ITS_FEET:
            is_now = f": its posture is {family}" if family else ""
            raise DriverError(f"the robot does not stand{is_now}", "first: `posture: Stand`")

    async def _stands(self) -> bool:
        active, velocity = await asyncio.gather(
            walks(self._link), self._link.call(MOTION, "getRobotVelocity")
        )
        return not active and still(velocity)

    async def _why(self) -> tuple[str, str]:
        with RefusalAllowed():
            if memory.flag(await self._link.call("ALMemory", "getData", FALLEN)):
                return "the robot has fallen", "clear its way; `posture: Stand` gets it up"
        return await super()._why()
