"""The body: postures, poses of single joints, motors on and off, and the stop of all motion."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from typing import Any

from woz_drivers.naoqi_robot import memory
from woz_drivers.naoqi_robot.joint_table import JointTable, native
from woz_drivers.naoqi_robot.parts import LONG_S, Call, NaoqiPart, RobotCalls, read_back
from woz_drivers.naoqi_robot.robot_settings import SETTINGS, of_section
from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_tui.drivers.argument_values import positive, text
from woz_tui.drivers.contract import (
    Argument,
    DeviceLostError,
    DriverError,
    Forecast,
    Job,
    Offer,
    RejectedError,
    Scope,
    Verb,
)
from woz_tui.drivers.fields import Range
from woz_tui.drivers.robot_parts import Pending
from woz_tui.drivers.robot_verbs import common_verb
from woz_tui.protocol.messages import Json

MOTION, POSTURE = "ALMotion", "ALRobotPosture"
LANE = "body"
#: Below this a joint is slack and would not follow; what `wakeUp` gives it.
SLACK, STIFF = 0.1, 1.0
#: Share of the full speed at which a posture is taken; `home` in one second goes at the default.
SPEED = Range(0.05, 1.0)
DEFAULT_SPEED = 0.5
SHORTEST_S = 0.1
_SECONDS = Range(0, 60, "s")


class BodyPart(NaoqiPart):
    """Joints and postures by ALMotion and ALRobotPosture."""

    name = "motion"

    @classmethod
    def offer(cls, settings: NaoqiSettings) -> Offer:
        """`posture`, `pose`, `home` and `torque`; its joints in degrees (hands: 0 to 1)."""
        seconds = Argument("seconds", "seconds", "time it takes", False, 1.0, _SECONDS)
        speed = Argument("speed", "number", "share of full speed", False, DEFAULT_SPEED, SPEED)
        return Offer(
            verbs=(
                Verb(
                    "posture",
                    "take a posture of the robot",
                    (Argument("name", "text", ", ".join(settings.model.postures), True), speed),
                    lane=LANE,
                    limit_s=60.0,
                    arrives=True,
                ),
                common_verb(
                    "pose", "move joints to angles in degrees, together", seconds, arrives=True
                ),
                common_verb("home", "stand upright again", seconds, limit_s=60.0, arrives=True),
                SETTINGS["awake"].changed_by(
                    "wake up, or go to rest and switch the motors off",
                    lane=LANE,
                    limit_s=60.0,
                ),
            ),
            joints=dict(settings.model.joints.ranges),
        )

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Move; ends when the robot is there."""
        await self._cleaned_up()
        match job.verb:
            case "posture":
                speed = float(str(job.args.get("speed", DEFAULT_SPEED)))
                return await self.take_posture(text(job.args, "name"), speed)
            case "pose":
                return await self._pose(job)
            case "home":
                speed = min(max(DEFAULT_SPEED / _seconds(job.args), SPEED.low or 0.0), 1.0)
                return await self.take_posture("Stand", round(speed, 3))
            case "torque":
                return await self._torque(job)
        return await super().perform(job)

    async def take_posture(self, posture: str, speed: float) -> dict[str, Json]:
        """Go to a posture. Raises `DriverError` if the robot did not get there."""
        if not posture.strip():
            raise RejectedError("no posture was named", ", ".join(self._settings.model.postures))
        reached = await self._moving(
            self._link.call(POSTURE, "goToPosture", posture, speed, within=LONG_S),
            lambda: self._link.call(POSTURE, "stopMove"),
        )
        if reached is False:
            raise DriverError(
                f"the posture {posture} was not reached",
                "wake the robot up (`torque: true`), give its arms room, and check the name",
            )
        return {"name": posture, "speed": speed}

    async def predict(self, verb: str, args: Mapping[str, Any]) -> Forecast:
        """Of a pose; the way to a posture is the robot's own."""
        if verb != "pose":
            return Forecast()
        self._settings.model.joints.checked(args.get("joints"))
        return Forecast(_seconds(args), ())

    async def rest(self) -> None:
        """How the robot is left alone: the posture of the robot file, otherwise at rest."""
        if self._settings.posture:
            await self.take_posture(self._settings.posture, DEFAULT_SPEED)
        else:
            await self._link.call(MOTION, "rest", within=LONG_S)

    async def halt(self, scope: Scope) -> Pending:
        """End every movement of every joint and of the wheels, whoever began it."""
        await self._end_motion()
        return ()

    async def read(self) -> Mapping[str, Json]:
        """Whether the motors are on, and in which posture it is."""
        return await read_back(self._link, of_section("Robot", self._settings.model.settings))

    async def _pose(self, job: Job) -> dict[str, Json]:
        joints = self._settings.model.joints
        pose = joints.checked(job.args.get("joints"))
        seconds = _seconds(job.args)
        names = list(pose)
        await hold(self._link, joints, names)
        job.expects(seconds)
        angles = [native(name, angle) for name, angle in pose.items()]
        await self._moving(
            self._link.call(
                *(MOTION, "angleInterpolation", names, angles, [seconds] * len(names), True),
                within=seconds + LONG_S,
            ),
            lambda: self._let_go(names),
        )
        return {"joints": dict(pose), "seconds": seconds}

    async def _torque(self, job: Job) -> dict[str, Json]:
        on = job.args.get("on")
        if not isinstance(on, bool):
            raise RejectedError(f"the motors are switched on or off, not {on!r}")
        done = await self._moving(
            self._link.call(MOTION, "wakeUp" if on else "rest", within=LONG_S),
            self._end_motion,
        )
        if done is False:  # where NAOqi answers at all; older ones return nothing
            raise DriverError(
                f"the robot did not {'wake up' if on else 'go to rest'}",
                "release its emergency stop, close its charging flap, give it room; then try again",
            )
        return {"on": on}

    async def _moving(self, call: Call, end: Callable[[], Call]) -> object:
        """Carry a movement to its end; one that is cut short ends on the robot, too."""
        try:
            return await call
        except asyncio.CancelledError:
            self._clean_up.start(end())
            raise

    async def _let_go(self, joints: list[str]) -> None:
        """End what moves these joints; all motion where the robot cannot end it for some alone."""
        try:
            await self._link.call(MOTION, "killTasksUsingResources", joints)
        except DeviceLostError:
            raise
        except DriverError:
            await self._end_motion()

    async def _end_motion(self) -> None:
        """End every movement, whoever began it."""
        await self._link.call(MOTION, "killAll")


def _seconds(args: Mapping[str, Any]) -> float:
    return max(positive(args, "seconds", 1.0), SHORTEST_S)


async def hold(robot: RobotCalls, joints: JointTable, names: list[str]) -> None:
    """Switch on the motors of those limbs that are slack: they would not follow.

    Raises `DriverError` for the lower part: it is stiff while the robot is awake, and its stiffness
    alone is not set; and where what the robot says of them makes no sense.
    """
    try:
        answer = await robot.call(MOTION, "getStiffnesses", names)
    except DeviceLostError:
        raise
    except DriverError:  # a NAOqi without it: a stiff head may be stiffened once more
        awake = all(joints.limb(name) for name in names) or await robot.call(
            MOTION, "robotIsWakeUp"
        )
        answer = [STIFF if joints.limb(name) is None and awake else 0.0 for name in names]
    values = memory.items(answer)
    now = [stiffness for value in values if (stiffness := memory.number(value)) is not None]
    if len(now) != len(names) or len(values) != len(names):
        raise DriverError(
            f"the robot does not report whether {', '.join(names)} are stiff",
            "wake it: `torque: true`; else restart it",
        )
    slack = [name for name, stiffness in zip(names, now, strict=True) if stiffness < SLACK]
    limbs = [joints.limb(name) for name in slack]
    if None in limbs:
        raise DriverError(
            f"the robot is at rest: {joints.lower_words} are slack", "wake it: `torque: true`"
        )
    if limbs:
        await robot.call(MOTION, "setStiffnesses", list(dict.fromkeys(limbs)), STIFF)
