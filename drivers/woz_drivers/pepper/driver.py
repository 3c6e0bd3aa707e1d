"""The driver of a Pepper: what it is made of."""

from __future__ import annotations

from collections.abc import Iterable
from typing import ClassVar

from woz_drivers.naoqi_robot import text_remarks
from woz_drivers.naoqi_robot.address import parse, without_password
from woz_drivers.naoqi_robot.animations import AnimationsPart
from woz_drivers.naoqi_robot.autonomy import AutonomyPart
from woz_drivers.naoqi_robot.base import BasePart
from woz_drivers.naoqi_robot.body import BodyPart
from woz_drivers.naoqi_robot.camera import CameraPart
from woz_drivers.naoqi_robot.driver import NaoqiRobot
from woz_drivers.naoqi_robot.eyes import EyesPart
from woz_drivers.naoqi_robot.head import HeadPart
from woz_drivers.naoqi_robot.looks import LooksPart
from woz_drivers.naoqi_robot.microphones import MicrophonesPart
from woz_drivers.naoqi_robot.parts import NaoqiPart
from woz_drivers.naoqi_robot.recognition import RecognitionPart
from woz_drivers.naoqi_robot.senses import SensesPart
from woz_drivers.naoqi_robot.service_call import ServiceCallPart
from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_drivers.naoqi_robot.sounds import SoundsPart
from woz_drivers.naoqi_robot.talk import TalkPart
from woz_drivers.naoqi_robot.tracking import TrackingPart
from woz_drivers.naoqi_robot.voice import VoicePart
from woz_drivers.pepper import doctor, tablet_page
from woz_drivers.pepper.hip import HipPart
from woz_drivers.pepper.settings import PepperSettings
from woz_drivers.pepper.tablet import TabletPart
from woz_tui.drivers.contract import LEAVES, DriverFacts, Finding, Probe


class Pepper(NaoqiRobot):
    """SoftBank's Pepper over NAOqi, or one of the simulated kind."""

    Settings = PepperSettings
    called = "Pepper"
    summary = "SoftBank's Pepper over NAOqi (2.5 to 2.9), or a simulated one"
    facts = DriverFacts(
        robot=True,
        needs="the robot's address",
        simulated="robots: [simulated], with a visitor",
        stop="the robot's answers, by part: base, motion, animation, speech, sound ...",
        page="docs/how-to/pepper.md",
        example="robots: [simulated]",
        shown=("stop", "loss", "return", "errors", "units"),
    )
    settings: PepperSettings

    PARTS: ClassVar[tuple[type[NaoqiPart], ...]] = (
        *(BasePart, BodyPart, AnimationsPart, VoicePart, SoundsPart, HeadPart, HipPart, EyesPart),
        *(
            TabletPart,
            AutonomyPart,
            TrackingPart,
            SensesPart,
            LooksPart,
            RecognitionPart,
            CameraPart,
        ),
        *(MicrophonesPart, TalkPart, ServiceCallPart),
    )
    CHECKS = text_remarks.CHECKS | {"screen": {"file": tablet_page.written_screen}}

    @classmethod
    def people_data(cls, settings: NaoqiSettings) -> Iterable[tuple[str, str]]:
        robots = [robot for robot in settings.addresses.values() if not parse(robot).simulated]
        if robots:
            shown = ", ".join(map(without_password, robots))
            yield LEAVES, f"between this computer and {shown}: what it says and senses"
            yield from super().people_data(settings)

    @classmethod
    async def examine(cls, probe: Probe) -> list[Finding]:
        """Look whether the robots are there and what they lack, without moving anything."""
        return await doctor.examine(probe)
