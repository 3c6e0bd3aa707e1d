"""The head: directions to look into, and steps from where it is.

It goes by `ALMotion.setAngles`, which takes the newest goal at once; steps add up from the goal of
the last one, so that a key that is held down loses none of them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from woz_drivers.naoqi_robot.body import MOTION, hold
from woz_drivers.naoqi_robot.joint_table import HEAD_PITCH, HEAD_YAW, JointTable
from woz_drivers.naoqi_robot.memory import item, within
from woz_drivers.naoqi_robot.parts import NaoqiPart, RobotCalls
from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_tui.drivers.argument_values import number
from woz_tui.drivers.contract import (
    Argument,
    DeviceLostError,
    DriverContext,
    DriverError,
    Job,
    Offer,
    Scope,
)
from woz_tui.drivers.fields import Range
from woz_tui.drivers.robot_verbs import common_verb
from woz_tui.protocol.messages import Json
from woz_tui.system.clock import Clock

#: Share of the joints' full speed.
HEAD_SPEED = 0.2
#: A step that comes so soon after the last one goes on from its goal; later ones from where the
#: robot looks then: it may have been moved by something else. The motors are asked as seldom.
RECENT_US = 1_500_000
#: How long a movement takes that the robot is not told a speed for, as in WoZ4U's program.
_INTERPOLATED_S, _MARGIN_S = 1.0, 3.0
#: What an angle that makes sense lies between, in radians.
_TURN = (-2 * math.pi, 2 * math.pi)
_DEGREES = Range(-180, 180, "degrees")
HEAD_NAMES = ("yaw", "pitch")
STEP = Range(-90, 90, "degrees")


@dataclass
class JointPair:
    """Two joints that move together, and what of them was asked for last."""

    robot: RobotCalls
    clock: Clock
    table: JointTable
    joints: tuple[str, str]
    speed: float
    nearest: Callable[[float, float], tuple[float, float]]
    goal: tuple[float, float] = (0.0, 0.0)
    moved_us: int | None = field(default=None)

    async def to(self, first: float, second: float) -> tuple[float, float]:
        """Go to these degrees, or to the nearest that can be taken; returns those."""
        if not self._recent():
            await hold(self.robot, self.table, list(self.joints))
        return await self._send(*self.nearest(first, second))

    async def by(self, first: float, second: float) -> tuple[float, float]:
        """Go so many degrees further."""
        if not self._recent():
            await hold(self.robot, self.table, list(self.joints))
            try:
                now = await self.robot.call(MOTION, "getAngles", list(self.joints), False)
            except DeviceLostError:
                raise
            except DriverError:  # a NAOqi that does not tell can count from where they are
                await self._interpolate(first, second, absolute=False)
                return first, second
            first_now, second_now = (within(item(now, place), *_TURN) for place in (0, 1))
            if first_now is None or second_now is None:
                raise DriverError(
                    f"the robot does not report where {' and '.join(self.joints)} are",
                    "look into a direction with `gaze`; else restart the robot",
                )
            self.goal = math.degrees(first_now), math.degrees(second_now)
        return await self._send(*self.nearest(self.goal[0] + first, self.goal[1] + second))

    def forget(self) -> None:
        """Something else has moved it, or may have."""
        self.moved_us = None

    def _recent(self) -> bool:
        return self.moved_us is not None and self.clock.now_us() - self.moved_us < RECENT_US

    async def _send(self, first: float, second: float) -> tuple[float, float]:
        angles = [math.radians(first), math.radians(second)]
        try:
            await self.robot.call(MOTION, "setAngles", list(self.joints), angles, self.speed)
        except DeviceLostError:
            raise
        except DriverError:
            await self._interpolate(first, second, absolute=True)
        self.goal, self.moved_us = (first, second), self.clock.now_us()
        return self.goal

    async def _interpolate(self, first: float, second: float, *, absolute: bool) -> None:
        """The way of a NAOqi that lacks the other calls; returns when they are there."""
        angles = [math.radians(first), math.radians(second)]
        times = [_INTERPOLATED_S] * len(angles)
        await self.robot.call(
            *(MOTION, "angleInterpolation", list(self.joints), angles, times, absolute),
            within=_INTERPOLATED_S + _MARGIN_S,
        )


class HeadPart(NaoqiPart):
    """`gaze` and `nudge`. What they began ends with the stop of all motion (`BodyPart`)."""

    name = "head"

    def __init__(self, robot: RobotCalls, settings: NaoqiSettings, context: DriverContext) -> None:
        super().__init__(robot, settings, context)
        joints = settings.model.joints
        self._head = JointPair(
            robot, context.clock, joints, (HEAD_YAW, HEAD_PITCH), HEAD_SPEED, joints.head
        )

    @classmethod
    def offer(cls, settings: NaoqiSettings) -> Offer:
        """Directions and steps of the head."""
        return Offer(
            verbs=(
                common_verb(
                    "gaze",
                    "look into a direction",
                    Argument("yaw", "number", "degrees, left is positive", True, None, _DEGREES),
                    Argument("pitch", "number", "degrees, down is positive", False, 0.0, _DEGREES),
                    limit_s=5.0,
                ),
                common_verb("nudge"),
            )
        )

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Send the goal and return: the robot is still on its way then."""
        yaw, pitch = (number(job.args, name) for name in HEAD_NAMES)
        match job.verb:
            case "gaze":
                goal = await self._head.to(yaw, pitch)
                return sent(HEAD_NAMES, (yaw, pitch), goal)
            case "nudge":
                goal = await self._head.by(yaw, pitch)
                return sent(HEAD_NAMES, goal, goal)
        return await super().perform(job)

    def hold(self, scope: Scope) -> None:
        """The stop of all motion holds it; the next step begins where it is then."""
        self.lost()

    def lost(self) -> None:
        """Where it looks is not known any more."""
        self._head.forget()


def sent(
    names: Sequence[str], requested: Sequence[float], goal: Sequence[float]
) -> dict[str, Json]:
    """What was sent, by argument, and what had been asked for where the robot cannot go so far."""
    told: dict[str, Json] = dict(zip(names, (round(angle, 3) for angle in goal), strict=True))
    clamped: dict[str, Json] = {
        name: was for name, was, now in zip(names, requested, goal, strict=True) if was != now
    }
    if clamped:
        told["clamped"] = clamped
    return told
