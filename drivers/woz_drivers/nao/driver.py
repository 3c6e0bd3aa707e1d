"""The driver of a NAO: what it is made of."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping
from typing import ClassVar

from woz_drivers.nao import doctor
from woz_drivers.nao.body import NaoBodyPart, written_pose
from woz_drivers.nao.body_senses import BodySensesPart
from woz_drivers.nao.lights import LightsPart, NaoEyesPart
from woz_drivers.nao.posture_animations import NaoAnimationsPart
from woz_drivers.nao.settings import NaoSettings
from woz_drivers.nao.two_cameras import TwoCamerasPart
from woz_drivers.nao.walking import WalkingPart
from woz_drivers.naoqi_robot import text_remarks
from woz_drivers.naoqi_robot.autonomy import AutonomyPart
from woz_drivers.naoqi_robot.driver import NaoqiRobot
from woz_drivers.naoqi_robot.head import HeadPart
from woz_drivers.naoqi_robot.looks import LooksPart
from woz_drivers.naoqi_robot.microphones import MicrophonesPart
from woz_drivers.naoqi_robot.parts import NaoqiPart
from woz_drivers.naoqi_robot.recognition import RecognitionPart
from woz_drivers.naoqi_robot.senses import SensesPart
from woz_drivers.naoqi_robot.service_call import ServiceCallPart
from woz_drivers.naoqi_robot.sounds import SoundsPart
from woz_drivers.naoqi_robot.talk import TalkPart
from woz_drivers.naoqi_robot.tracking import TrackingPart
from woz_drivers.naoqi_robot.voice import VoicePart
from woz_tui.drivers.contract import DriverError, DriverFacts, Finding, Job, Probe
from woz_tui.protocol.messages import Json

#: Verbs that would move it. `posture` and `home` get it up again.
MOVING = frozenset(("drive", "play", "pose", "torque", "gaze", "nudge"))


class Nao(NaoqiRobot):
    """Aldebaran's NAO over NAOqi, or one of the simulated kind."""

    Settings = NaoSettings
    called = "a NAO"
    summary = "Aldebaran's NAO over NAOqi (2.8), or a simulated one"
    settings: NaoSettings
    facts = DriverFacts(
        robot=True,
        needs="the robot's address",
        simulated="address: simulated, with a visitor; falls to order",
        stop="the robot's answers, by part: walking, motion, animations, speech, sounds ...",
        page="docs/how-to/nao.md",
        example="address: simulated",
        shown=("stop", "loss", "return", "errors", "units"),
    )

    CHECKS = text_remarks.CHECKS | {"pose": {"joints": written_pose}}
    PARTS: ClassVar[tuple[type[NaoqiPart], ...]] = (
        *(WalkingPart, NaoBodyPart, NaoAnimationsPart, VoicePart, SoundsPart, HeadPart),
        *(NaoEyesPart, LightsPart, AutonomyPart, TrackingPart, BodySensesPart, SensesPart),
        *(LooksPart, RecognitionPart, TwoCamerasPart, MicrophonesPart, TalkPart, ServiceCallPart),
    )

    @classmethod
    async def examine(cls, probe: Probe) -> list[Finding]:
        """Look whether the robot is there and what it lacks, without moving anything."""
        return await doctor.examine(probe)

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """See `NaoqiRobot.perform`; what moves is refused at once while the robot lies."""
        refusal = self._link.refused("ALMotion.wakeUp") if job.verb in MOVING else None
        if refusal is not None:
            raise refusal
        return await super().perform(job)

    async def _connected(self) -> None:
        """Whether it lies is known before anything is set that could move it."""
        for part in self._parts:
            if isinstance(part, BodySensesPart):
                with contextlib.suppress(DriverError):  # its loop goes on asking
                    await part.look()
        await super()._connected()
