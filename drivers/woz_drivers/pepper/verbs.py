"""The parts of a Pepper, and what all of them offer together."""

from __future__ import annotations

from collections.abc import Mapping

from woz_drivers.pepper import address
from woz_drivers.pepper.animations import AnimationsPart
from woz_drivers.pepper.autonomy import AutonomyPart
from woz_drivers.pepper.base import BasePart
from woz_drivers.pepper.body import BodyPart
from woz_drivers.pepper.camera import CameraPart
from woz_drivers.pepper.eyes import EyesPart
from woz_drivers.pepper.head import HeadPart
from woz_drivers.pepper.microphones import MicrophonesPart
from woz_drivers.pepper.parts import PepperPart
from woz_drivers.pepper.recognition import RecognitionPart
from woz_drivers.pepper.senses import SensesPart
from woz_drivers.pepper.service_call import ServiceCallPart
from woz_drivers.pepper.settings import PepperSettings
from woz_drivers.pepper.sounds import SoundsPart
from woz_drivers.pepper.tablet import TabletPart
from woz_drivers.pepper.voice import VoicePart
from woz_tui.drivers.contract import Argument, Verb

#: What a stop reaches first stands first.
PARTS: tuple[type[PepperPart], ...] = (
    *(BasePart, BodyPart, AnimationsPart, VoicePart, SoundsPart, HeadPart, EyesPart, TabletPart),
    *(AutonomyPart, SensesPart, RecognitionPart, CameraPart, MicrophonesPart, ServiceCallPart),
)
#: A robot that has just been switched on takes its time before it answers.
CONNECT_LIMIT_S = 180.0
#: Of `connect` and `disconnect` alone: nothing that waits for the robot stands before them.
LANE = "line"

LINE = (
    Verb(
        "connect",
        "connect to a robot",
        (
            Argument(
                "robot",
                "text",
                "an address or a host name; empty: the first",
                default="",
                hide=address.without_password,
            ),
        ),
        lane=LANE,
        limit_s=CONNECT_LIMIT_S,
    ),
    Verb("disconnect", "disconnect the robot until `connect`", lane=LANE, limit_s=10.0),
)


def offered(settings: PepperSettings) -> tuple[Verb, ...]:
    """The verbs of all parts, and those of the line to the robot."""
    return (*(verb for part in PARTS for verb in part.verbs(settings)), *LINE)


def by_verb(parts: tuple[PepperPart, ...], settings: PepperSettings) -> Mapping[str, PepperPart]:
    """Which part performs which verb."""
    return {verb.name: part for part in parts for verb in part.verbs(settings)}
