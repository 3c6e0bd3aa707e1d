"""A NAO's body: it gets up after a fall, and is stopped without losing its balance."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator

from woz_drivers.nao.falls import getting_up
from woz_drivers.nao.joints import LEGS
from woz_drivers.nao.model import HALT_UPPER
from woz_drivers.nao.walking import walks
from woz_drivers.naoqi_robot.base import ASK_S
from woz_drivers.naoqi_robot.body import MOTION, POSTURE, STIFF, BodyPart
from woz_drivers.naoqi_robot.text_remarks import WrittenValue
from woz_tui.drivers.contract import RejectedError
from woz_tui.drivers.robot_parts import RefusalAllowed
from woz_tui.protocol.messages import Json


class NaoBodyPart(BodyPart):
    """Postures bring it to its feet again; what moves the legs ends when it walks no more."""

    async def take_posture(self, posture: str, speed: float) -> dict[str, Json]:
        """Go to a posture, from the floor too. Raises `DriverError` if it did not get there."""
        if self._link.refused(f"{POSTURE}.goToPosture") is None:
            return await super().take_posture(posture, speed)
        with getting_up():
            # The fall manager has switched all motors off.
            await self._link.call(MOTION, "setStiffnesses", "Body", STIFF)
            return await super().take_posture(posture, speed)

    async def rest(self) -> None:
        """How the robot is left alone; one that lies is left as it lies."""
        try:
            await super().rest()
        except RejectedError:
            if self._link.refused(f"{MOTION}.rest") is None:
                raise

    async def _end_motion(self) -> None:
        """End every movement: at once above the legs, and of the legs when it does not walk."""
        await asyncio.gather(self._link.call(*HALT_UPPER), self._end_posture())
        while await walks(self._link):  # noqa: ASYNC110
            await asyncio.sleep(ASK_S)  # the robot tells of no end: it has to be asked
        await self._link.call(MOTION, "killTasksUsingResources", list(LEGS))

    async def _end_posture(self) -> None:
        with RefusalAllowed():  # none is being taken
            await self._link.call(POSTURE, "stopMove")


def written_pose(argument: WrittenValue) -> Iterator[tuple[str, str]]:
    """What is odd about a pose in a file. Raises `RejectedError` for an impossible one."""
    pose = argument.settings.model.joints.checked(argument.value)
    legs = ", ".join(joint for joint in pose if joint in LEGS)
    if legs:
        yield f"{legs}: a NAO that stands may fall when its legs are moved", "let it sit for that"
