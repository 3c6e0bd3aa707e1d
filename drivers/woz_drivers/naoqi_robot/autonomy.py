"""What the robot does by itself: autonomous life, awareness, blinking, breathing, distances kept.

The robot changes all of this by itself, too; therefore it is read back all the time, and nothing is
taken for granted because it was set once.
"""

from __future__ import annotations

from collections.abc import Mapping

from woz_drivers.naoqi_robot import memory
from woz_drivers.naoqi_robot.parts import LOOK_S, NaoqiPart, RobotCalls, read_back, write_setting
from woz_drivers.naoqi_robot.robot_settings import SETTINGS, STATE_S, of_verb
from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_tui.drivers.argument_values import number
from woz_tui.drivers.contract import (
    DeviceLostError,
    DriverContext,
    DriverError,
    Job,
    Offer,
    RejectedError,
    Verb,
)
from woz_tui.drivers.robot_parts import RefusalAllowed
from woz_tui.protocol.messages import Json

LANE = "settings"
#: NAOqi refuses one change alone (naoqi/interaction/autonomouslife-api of 2.5).
_BACK = "from interactive it gets to solitary by disabled alone, in which it rests"


class AutonomyPart(NaoqiPart):
    """Switches of the robot's autonomy, and the distances that it keeps."""

    name = "autonomy"

    def __init__(self, robot: RobotCalls, settings: NaoqiSettings, context: DriverContext) -> None:
        super().__init__(robot, settings, context)
        #: Asked for last, by the robot file or by a command: set again after a loss.
        self._desired = settings.initial_values(of_verb("autonomy", "collision").values())

    @classmethod
    def offer(cls, settings: NaoqiSettings) -> Offer:
        """`autonomy` and `collision`; what is not named is left as it is."""
        verbs = (
            ("autonomy", "change what the robot does by itself", STATE_S + 5.0),
            ("collision", "change which distances the robot keeps when it moves", 10.0),
        )
        return Offer(
            verbs=tuple(
                Verb(
                    name,
                    summary,
                    tuple(setting.taken() for setting in of_verb(name).values()),
                    lane=LANE,
                    limit_s=limit_s,
                    brief=True,
                )
                for name, summary, limit_s in verbs
            )
        )

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Set what was named; the rest is set even if the robot refuses one of them."""
        changes = {name: value for name, value in job.args.items() if value is not None}
        if not changes:
            raise RejectedError(
                f"{job.verb} was given no setting", "name what to change and its value"
            )
        if job.verb == "collision":
            changes = {name: number(changes, name) for name in changes}
        refused = await self._set(changes)
        self._desired |= {name: value for name, value in changes.items() if name not in refused}
        if refused:
            which = "; ".join(f"{name}: {error.what}" for name, error in refused.items())
            changed = [name for name in changes if name not in refused]
            also = f"; {', '.join(changed)} did change" if changed else ""
            remedies = dict.fromkeys(filter(None, (error.remedy for error in refused.values())))
            raise DriverError(
                f"the robot did not change {which}{also}",
                "; ".join(remedies) or "look at the robot's settings",
            )
        return dict(changes)

    async def connected(self) -> None:
        """Apply what the file says, or the wizard since; what the robot refuses is a notice."""
        changes = dict(self._desired)
        if "state" in changes and await self._state() == changes["state"]:
            # Sent again, `disabled` sends a robot to rest that was woken since.
            del changes["state"]
        for name, error in (await self._set(changes)).items():
            self._context.notice("warning", f"{name} could not be set: {error.what}", error.remedy)

    async def read(self) -> Mapping[str, Json]:
        """All of it as the robot has it now."""
        return await read_back(self._link, of_verb("autonomy", "collision").values())

    async def _state(self) -> Json:
        """Of autonomous life; None: it does not say. Raises `DeviceLostError`."""
        with RefusalAllowed():
            return memory.word(await self._link.call(*SETTINGS["state"].get, within=LOOK_S))
        return None

    async def _set(self, changes: Mapping[str, Json]) -> dict[str, DriverError]:
        """Set these, in the order of the table; returns what the robot refused, and why.

        Raises `DeviceLostError`.
        """
        refused: dict[str, DriverError] = {}
        for name in filter(changes.__contains__, SETTINGS):
            try:
                await write_setting(self._link, SETTINGS[name], changes[name])
            except DeviceLostError:
                raise
            except DriverError as error:
                remedy = _BACK if (name, changes[name]) == ("state", "solitary") else ""
                refused[name] = DriverError(error.what, error.remedy or remedy)
        return refused
