"""Animations: whole movements of the body that are stored on the robot."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping

from woz_drivers.naoqi_robot.memory import flag
from woz_drivers.naoqi_robot.parts import LONG_S, NaoqiPart, RobotCalls
from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_tui.drivers.argument_values import text
from woz_tui.drivers.contract import (
    Argument,
    DeviceLostError,
    DriverContext,
    DriverError,
    Job,
    Offer,
    Scope,
    Verb,
)
from woz_tui.drivers.robot_parts import Pending
from woz_tui.protocol.messages import Json

BEHAVIORS = "ALBehaviorManager"
LANE = "body"
#: How often it is asked whether an animation has ended.
ASK_S = 0.03


class AnimationsPart(NaoqiPart):
    """Plays one animation at a time. The robot ends it when the call is cancelled."""

    name = "animations"

    def __init__(self, robot: RobotCalls, settings: NaoqiSettings, context: DriverContext) -> None:
        super().__init__(robot, settings, context)
        self._playing = ""

    @classmethod
    def offer(cls, settings: NaoqiSettings) -> Offer:
        """`play`."""
        return Offer(
            verbs=(
                Verb(
                    "play",
                    "play an animation of the robot",
                    (Argument("move", "text", "its path, or its short name such as Hey_1", True),),
                    lane=LANE,
                    limit_s=600.0,
                ),
            )
        )

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Play it to its end."""
        path = await self._path(text(job.args, "move"))
        await self._cleaned_up()
        self._playing = path
        try:
            await self._link.call("ALAnimationPlayer", "run", path, within=LONG_S)
        except asyncio.CancelledError:
            # Until then it may go on, and a stop must reach it.
            self._clean_up.start(self._end(path))
            raise
        except DriverError as error:
            self._playing = ""
            if isinstance(error, DeviceLostError):
                raise
            raise DriverError(
                f"{path} was not played: {error.what}",
                error.remedy
                or "see that its motors are on, and check the path;"
                " `naoqi: ALBehaviorManager.getInstalledBehaviors` lists what the robot has",
            ) from error
        self._playing = ""
        return {"move": path}

    async def _path(self, move: str) -> str:
        """The animation that is meant. Raises `DriverError` for one that is not known."""
        return self._settings.model.animations.path_of(move)

    async def halt(self, scope: Scope) -> Pending:
        """End the animation under way."""
        if not self._playing:
            return None
        await self._end(self._playing)
        return ()

    def lost(self) -> None:
        """What was played is not known to play any more."""
        self._playing = ""

    async def _end(self, path: str) -> None:
        """The job's cancelled call ends it where the robot listens to that; this ends it anyway."""
        try:
            await self._link.call(BEHAVIORS, "stopBehavior", path)
        except DeviceLostError:
            raise
        except DriverError:
            # Perhaps because it has ended already, by the cancelled call or by the end of motion.
            while await self._runs(path):  # noqa: ASYNC110
                await asyncio.sleep(ASK_S)  # the robot tells of no end: it has to be asked
        if self._playing == path:
            self._playing = ""

    async def _runs(self, path: str) -> bool:
        """Raises `DriverError` if the robot does not say it: then nobody knows."""
        runs = flag(await self._link.call(BEHAVIORS, "isBehaviorRunning", path))
        if runs is None:
            raise DriverError(
                f"the robot does not report whether {path} has ended", "check the robot"
            )
        return runs
