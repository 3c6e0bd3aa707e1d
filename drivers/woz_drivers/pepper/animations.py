"""Animations: whole movements of the body that are stored on the robot."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping

from woz_drivers.pepper.animations_known import path_of
from woz_drivers.pepper.memory import flag
from woz_drivers.pepper.parts import Part, Robot
from woz_drivers.pepper.parts_calls import LONG_S, Endings
from woz_drivers.pepper.settings import PepperSettings
from woz_drivers.simulated.values import text
from woz_tui.core.driver import Argument, DriverError, Job, Lost, Outlet, Scope, Verb
from woz_tui.core.messages import Json

BEHAVIORS = "ALBehaviorManager"
LANE = "body"
#: How often it is asked whether an animation has ended.
ASK_S = 0.03


class Animations(Part):
    """Plays one animation at a time. The robot ends it when the call is cancelled."""

    name = "animations"

    def __init__(self, robot: Robot, settings: PepperSettings, outlet: Outlet) -> None:
        super().__init__(robot, settings, outlet)
        self._endings = Endings()
        self._playing = ""

    @classmethod
    def verbs(cls, settings: PepperSettings) -> tuple[Verb, ...]:
        """`play`."""
        return (
            Verb(
                "play",
                "play an animation of the robot",
                (Argument("move", "text", "its path, or its short name such as Hey_1", True),),
                lane=LANE,
                limit_s=600.0,
            ),
        )

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Play it to its end."""
        path = path_of(text(job.args, "move"))
        await self._endings.settled()
        self._playing = path
        try:
            await self._robot.call("ALAnimationPlayer", "run", path, within=LONG_S)
        except asyncio.CancelledError:
            self._endings.send(self._end(path))  # until then it may go on, and a stop must reach it
            raise
        except DriverError as error:
            self._playing = ""
            if isinstance(error, Lost):
                raise
            raise DriverError(
                f"{path} was not played: {error.what}",
                error.remedy
                or "see that its motors are on, and check the path;"
                " `naoqi: ALBehaviorManager.getInstalledBehaviors` lists what the robot has",
            ) from error
        self._playing = ""
        return {"move": path}

    async def stop(self, scope: Scope) -> tuple[str, ...]:
        """End the animation under way."""
        if scope is not Scope.ALL or not self._playing:
            return ()
        await self._end(self._playing)
        return (self.name,)

    def lost(self) -> None:
        """What was played is not known to play any more."""
        self._playing = ""

    async def close(self) -> None:
        """End what is on its way."""
        await self._endings.close()

    async def _end(self, path: str) -> None:
        """The job's cancelled call ends it where the robot listens to that; this ends it anyway."""
        try:
            await self._robot.call(BEHAVIORS, "stopBehavior", path)
        except Lost:
            raise
        except DriverError:
            # Perhaps because it has ended already, by the cancelled call or by the end of motion.
            while await self._runs(path):  # noqa: ASYNC110
                await asyncio.sleep(ASK_S)  # the robot tells of no end: it has to be asked
        if self._playing == path:
            self._playing = ""

    async def _runs(self, path: str) -> bool:
        """Raises `DriverError` if the robot does not say it: then nobody knows."""
        runs = flag(await self._robot.call(BEHAVIORS, "isBehaviorRunning", path))
        if runs is None:
            raise DriverError(f"the robot does not say whether {path} has ended", "look at it")
        return runs
