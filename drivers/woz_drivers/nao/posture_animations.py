"""Animations for the posture that the robot is in: standing or sitting."""

from __future__ import annotations

from woz_drivers.naoqi_robot import memory
from woz_drivers.naoqi_robot.animation_names import posture_of
from woz_drivers.naoqi_robot.animations import AnimationsPart
from woz_tui.drivers.contract import DriverError

#: Folder of the animations by the family of the posture (naoqi/motion/alanimationplayer of 2.8).
FOLDERS = {"Standing": "Stand", "Sitting": "Sit", "SittingOnChair": "SitOnPod"}


class NaoAnimationsPart(AnimationsPart):
    """One that is for another posture would throw the robot over: it is not sent."""

    async def _path(self, move: str) -> str:
        names = self._settings.model.animations
        names.path_of(move)  # what nobody knows need not wait for an answer
        family = memory.word(await self._link.call("ALRobotPosture", "getPostureFamily"))
        if family is None:
            raise DriverError("the robot does not report its posture", "restart it")
        path = names.path_of(move, FOLDERS.get(family, ""))
        needed = posture_of(path)
        if needed in FOLDERS.values() and needed != FOLDERS.get(family):
            raise DriverError(
                f"{path} is for another posture: the robot's is {family}",
                f"first: `posture: {'Stand' if needed == 'Stand' else 'Sit'}`",
            )
        return path
