"""Tracking modes of basic awareness: how much of the robot turns and moves to people by itself.

All but Head move the base although nobody has asked for a drive, and go on doing so after
`ALMotion.stopMove`. So they are a verb that drives: it lasts as long as the mode does, needs
somebody who watches, and leaves the robot with Head behind, however it ends.

Source: naoqi/interaction/autonomousabilities/albasicawareness of NAOqi 2.5.
"""

from __future__ import annotations

import asyncio
from collections.abc import Mapping

from woz_drivers.naoqi_robot import memory
from woz_drivers.naoqi_robot.parts import (
    LOOK_S,
    NaoqiPart,
    RobotCalls,
    ServiceAbsentError,
    read_back,
)
from woz_drivers.naoqi_robot.robot_settings import AWARENESS, SETTINGS, STILL_MODE, TRACK
from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_tui.drivers.argument_values import number, text
from woz_tui.drivers.contract import (
    Argument,
    DeviceLostError,
    DriverContext,
    DriverError,
    Job,
    Offer,
    RejectedError,
    Scope,
    Verb,
)
from woz_tui.drivers.fields import Range
from woz_tui.drivers.robot_parts import Pending
from woz_tui.protocol.messages import Json

#: The longest that a mode may be asked for at once, in seconds.
LONGEST_S = 3600.0
_SETTING = SETTINGS["tracking"]


class TrackingPart(NaoqiPart):
    """The verb `track`, and the setting `tracking`."""

    name = "tracking"

    def __init__(self, robot: RobotCalls, settings: NaoqiSettings, context: DriverContext) -> None:
        super().__init__(robot, settings, context)
        #: What the robot said last, and whether another mode was asked for since it said Head.
        self._mode = ""
        self._asked = False
        #: How often the robot was told a mode: an answer from before says nothing.
        self._told = 0
        self._paused = False

    @classmethod
    def offer(cls, settings: NaoqiSettings) -> Offer:
        """`track`."""
        return Offer(
            verbs=(
                Verb(
                    TRACK,
                    "have it turn and move to people by itself for so long; Head: the head alone",
                    (
                        Argument(
                            *("mode", "choice", "what of it follows people", True),
                            choices=_SETTING.choices,
                        ),
                        Argument(
                            *("seconds", "number", "then it is Head again", False, 60.0),
                            range=Range(1.0, LONGEST_S, "s"),
                        ),
                    ),
                    lane=TRACK,
                    drives=True,
                    limit_s=LONGEST_S + 30.0,
                ),
            )
        )

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Track in this mode until the time is over; `mode` in the result was read back."""
        mode, seconds = text(job.args, "mode"), number(job.args, "seconds")
        await self._cleaned_up()
        if mode == STILL_MODE:
            await self._tell(mode)
            return {"mode": mode}
        if memory.flag(await self._link.call(AWARENESS, "isEnabled", within=LOOK_S)) is False:
            raise RejectedError(
                "awareness is off: the robot would track nobody", "autonomy: {awareness: true}"
            )
        # A robot that was silent for a while must not set off when it wakes from that.
        await self._link.probe()
        try:
            await self._tell(mode)
            job.expects(seconds)
            await asyncio.sleep(seconds)
        finally:
            self._clean_up.start(self._be_still())
        await self._cleaned_up()
        return {"mode": mode, "seconds": seconds}

    async def _tell(self, mode: str) -> None:
        """Set a mode. Raises `DriverError` where the robot has another one then."""
        self._told += 1
        self._asked |= mode != STILL_MODE
        await self._link.call(*_SETTING.put, mode)
        has = memory.word(await self._link.call(*_SETTING.get, within=LOOK_S))
        if has != mode:
            raise DriverError(
                f"the robot did not take the tracking mode {mode}: it has {has or 'none'}",
                "look at what else has its awareness",
            )

    async def _be_still(self) -> None:
        """Head, or no awareness at all where the robot does not take that."""
        self._told += 1
        try:
            await self._link.call(*_SETTING.put, STILL_MODE)
        except (DeviceLostError, ServiceAbsentError):
            raise
        except DriverError:
            await self._link.call(AWARENESS, "pauseAwareness")
            self._paused = True

    async def halt(self, scope: Scope) -> Pending:
        """Track with the head alone, if it was more: that the base stands, its own part sees to."""
        if not self._asked and self._mode in ("", STILL_MODE):
            return None
        await self._be_still()
        return ()

    def resume(self) -> None:
        """The stop was released: awareness goes on where it had to be paused."""
        if self._paused:
            self._paused = False
            self._clean_up.start(self._link.call(AWARENESS, "resumeAwareness"))

    async def connected(self) -> None:
        """Head, if the file says so, or if it was lost while it tracked with more."""
        self._mode, self._paused = "", False
        if self._asked or self._settings.autonomy.tracking:
            await self._be_still()

    async def read(self) -> Mapping[str, Json]:
        """The mode as the robot has it now."""
        told = self._told
        values = await read_back(self._link, (_SETTING,))
        self._mode = str(values.get(_SETTING.name, self._mode))
        if told == self._told and self._mode == STILL_MODE:
            self._asked = False
        return values
