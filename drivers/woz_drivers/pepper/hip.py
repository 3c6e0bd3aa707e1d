"""The hip: steps from where it is."""

from __future__ import annotations

from collections.abc import Mapping

from woz_drivers.naoqi_robot.head import STEP, JointPair, sent
from woz_drivers.naoqi_robot.parts import NaoqiPart, RobotCalls
from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_drivers.pepper.joints import HIP_PITCH, HIP_ROLL, hip
from woz_tui.drivers.argument_values import number
from woz_tui.drivers.contract import Argument, DriverContext, Job, Offer, Scope, Verb
from woz_tui.protocol.messages import Json

#: Share of the joints' full speed.
HIP_SPEED = 0.1


class HipPart(NaoqiPart):
    """`hip`. What it began ends with the stop of all motion (`BodyPart`)."""

    name = "hip"

    def __init__(self, robot: RobotCalls, settings: NaoqiSettings, context: DriverContext) -> None:
        super().__init__(robot, settings, context)
        joints = settings.model.joints
        self._hip = JointPair(robot, context.clock, joints, (HIP_PITCH, HIP_ROLL), HIP_SPEED, hip)

    @classmethod
    def offer(cls, settings: NaoqiSettings) -> Offer:
        """Steps of the hip."""
        return Offer(
            verbs=(
                Verb(
                    "hip",
                    "bend the hip a step from where it is",
                    (
                        Argument(
                            "pitch", "number", "degrees, forward is positive", False, 0.0, STEP
                        ),
                        Argument("roll", "number", "degrees, left is positive", False, 0.0, STEP),
                    ),
                    lane="hip",
                    limit_s=5.0,
                    brief=True,
                ),
            )
        )

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Send the goal and return: the robot is still on its way then."""
        # Its pitch is that of the legs against the torso: bent forward it is negative.
        pitch, roll = await self._hip.by(-number(job.args, "pitch"), number(job.args, "roll"))
        goal = (0.0 - pitch, roll)
        return sent(("pitch", "roll"), goal, goal)

    def hold(self, scope: Scope) -> None:
        """The stop of all motion holds it; the next step begins where it is then."""
        self.lost()

    def lost(self) -> None:
        """Where it is is not known any more."""
        self._hip.forget()
