"""A NAO's two cameras: one above the other in its face, the lower one looks at its feet."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from woz_drivers.nao.model import CAMERAS, NAO
from woz_drivers.nao.settings import NaoSettings
from woz_drivers.naoqi_robot.camera import RGB, SINGLE, CameraPart
from woz_drivers.naoqi_robot.parts import RobotCalls
from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_tui.drivers.argument_values import word
from woz_tui.drivers.contract import Argument, DriverContext, Job, Offer, Verb
from woz_tui.protocol.messages import Json


class TwoCamerasPart(CameraPart):
    """Pictures of either; what is watched is one of them at a time."""

    def __init__(self, robot: RobotCalls, settings: NaoSettings, context: DriverContext) -> None:
        super().__init__(robot, settings, context)
        self._which = settings.camera
        #: Of the single picture that is being taken.
        self._single = settings.camera

    @classmethod
    def offer(cls, settings: NaoqiSettings) -> Offer:
        """It can keep a picture, of this camera or of the other one."""
        (picture,) = super().offer(settings).verbs
        which = NAO.settings["camera"].taken(required=True)
        either = Argument("camera", "choice", "of which camera", choices=CAMERAS)
        return Offer(
            verbs=(
                Verb(picture.name, picture.summary, (either,), lane=picture.lane),
                Verb(
                    "camera", "look through the other camera", (which,), lane="camera", brief=True
                ),
            )
        )

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Take a picture and keep it, or look through another camera."""
        if job.verb == "camera":
            self._which = word(job.args, "which", CAMERAS)
            await self._unsubscribe()  # the next picture is asked of the other one
            return {"which": self._which}
        asked = job.args.get("camera")
        self._single = self._which if asked is None else word(job.args, "camera", CAMERAS)
        return {**await super().perform(job), "camera": self._single}

    async def read(self) -> Mapping[str, Json]:
        """Which one is looked through."""
        return {"camera": self._which}

    def _words(self, name: str, size: int, rate: int) -> tuple[Any, ...]:
        which = self._single if name == SINGLE else self._which
        return "subscribeCamera", name, CAMERAS.index(which), size, RGB, rate
