"""Whether the robot has fallen: told at once, and no motion is sent to it until it is up again.

`ALMotion/RobotIsFalling` and `robotHasFallen` are raised when the fall manager begins and ends
(naoqi/motion/reflexes-fall-manager of NAOqi 2.8); their values stay in ALMemory, so they are taken
back there once the robot is up. Whether it is up, says the family of its posture.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Mapping
from contextvars import ContextVar
from typing import Any

from woz_drivers.naoqi_robot import memory
from woz_drivers.naoqi_robot.parts import RobotCalls
from woz_drivers.naoqi_robot.senses import CALM_US
from woz_tui.drivers.contract import DriverContext, DriverError, RejectedError
from woz_tui.drivers.robot_parts import RefusalAllowed

FALLING, FALLEN = "ALMotion/RobotIsFalling", "robotHasFallen"
KEYS = (FALLEN, FALLING)
#: Families of postures in which it has got up (naoqi/motion/alrobotposture of NAOqi 2.8).
UPRIGHT = ("Standing", "Crouching", "Sitting", "SittingOnChair", "Kneeling")
#: It is up when its posture has been one of these for so long: in the moment of a fall the robot
#: may still call it Standing.
UPRIGHT_US = 1_000_000
SENSOR = "fallen"
REMEDY = "clear its way, then `posture: Stand` gets it up; or lift it"

#: What would move it. Not in here: what ends something, and questions.
_MOTION = frozenset(
    f"ALMotion.{method}"
    for method in (
        *("angleInterpolation", "angleInterpolationWithSpeed", "angleInterpolationBezier"),
        *("setAngles", "changeAngles", "openHand", "closeHand", "move", "moveTo", "moveToward"),
        *("moveInit", "setFootSteps", "setFootStepsWithSpeed", "setPositions", "changePosition"),
        *("positionInterpolations", "transformInterpolations", "wakeUp", "rest"),
        *("setStiffnesses", "stiffnessInterpolation"),
    )
) | {
    *("ALRobotPosture.goToPosture", "ALRobotPosture.applyPosture"),
    *("ALAnimationPlayer.run", "ALAnimationPlayer.runTag", "ALAnimatedSpeech.say"),
    *("ALBehaviorManager.runBehavior", "ALBehaviorManager.startBehavior"),
}

#: Set while the wizard has it get up: the only motion that is let through.
_GETS_UP: ContextVar[bool] = ContextVar("gets_up", default=False)


@contextlib.contextmanager
def getting_up() -> Iterator[None]:
    """In here the calls of this task are let through to a robot that has fallen."""
    token = _GETS_UP.set(True)
    try:
        yield
    finally:
        _GETS_UP.reset(token)


class FallWatch:
    """Follows what the robot says, and guards it."""

    def __init__(self, robot: RobotCalls, context: DriverContext) -> None:
        self._link = robot
        self._context = context
        self.fallen = False
        #: Since when its posture is upright again, while the keys still say that it fell.
        self._upright_us: int | None = None
        self._told_us: int | None = None
        robot.guard(self.refused)

    def refused(self, what: str, args: tuple[Any, ...]) -> DriverError | None:
        """See `RobotCalls.guard`."""
        begins_life = what == "ALAutonomousLife.setState" and args != ("disabled",)
        if not self.fallen or _GETS_UP.get() or not (what in _MOTION or begins_life):
            return None
        return RejectedError("NAO has fallen: no motion is sent to it", REMEDY)

    def forget(self) -> None:
        """It may be another robot, or somebody has lifted it meanwhile."""
        self.fallen, self._upright_us, self._told_us = False, None, None

    async def take(self, values: Mapping[str, Any], *, first: bool = False) -> None:
        """What ALMemory says now; `first` after a connection: an upright robot fell long ago.

        Raises `DeviceLostError`.
        """
        raws = [values.get(key) for key in KEYS]
        told = [memory.flag(raw) for raw in raws]
        if any(flag is None and raw is not None for flag, raw in zip(told, raws, strict=True)):
            self._context.sensor(SENSOR, "stale", f"the robot says {memory.brief(raws)}")
            return
        self._context.sensor(SENSOR, "ok")
        if any(told) and not await self._is_up(first=first):
            self._is(fallen=True)
        else:
            if any(told) or (first and None in raws):
                # A key that there is not yet would have every question be asked key by key.
                await self._take_back()
            self._upright_us = None
            self._is(fallen=False)

    async def _is_up(self, *, first: bool) -> bool:
        family = None
        with RefusalAllowed():
            family = memory.word(await self._link.call("ALRobotPosture", "getPostureFamily"))
        if family not in UPRIGHT:
            self._upright_us = None
            return False
        now_us = self._context.clock.now_us()
        if self._upright_us is None:
            self._upright_us = now_us
        return first or now_us - self._upright_us >= UPRIGHT_US

    async def _take_back(self) -> None:
        for key in KEYS:
            with RefusalAllowed():  # it is asked for its posture again, then
                await self._link.call("ALMemory", "insertData", key, False)

    def _is(self, *, fallen: bool) -> None:
        now_us = self._context.clock.now_us()
        if fallen != self.fallen:
            self.fallen = fallen
            if fallen:
                self._link.unwell("it has fallen, no motion is sent to it", REMEDY)
                self._context.notice("error", "NAO has fallen: no motion is sent to it", REMEDY)
            else:
                self._link.unwell("")
                self._context.notice("info", "NAO is up again")
        elif self._told_us is not None and now_us - self._told_us < CALM_US:
            return
        self._told_us = now_us
        self._context.reading(SENSOR, float(fallen))
