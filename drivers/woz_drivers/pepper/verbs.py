"""The parts of a Pepper, and what all of them offer together."""

from __future__ import annotations

from collections.abc import Mapping

from woz_drivers.pepper import address
from woz_drivers.pepper.animations import Animations
from woz_drivers.pepper.autonomy import Autonomy
from woz_drivers.pepper.base import Base
from woz_drivers.pepper.body import Body
from woz_drivers.pepper.camera import Camera
from woz_drivers.pepper.eyes import Eyes
from woz_drivers.pepper.head import Head
from woz_drivers.pepper.microphones import Microphones
from woz_drivers.pepper.parts import Part
from woz_drivers.pepper.recognition import Recognition
from woz_drivers.pepper.senses import Senses
from woz_drivers.pepper.service_call import NaoqiCall
from woz_drivers.pepper.settings import PepperSettings
from woz_drivers.pepper.sounds import Sounds
from woz_drivers.pepper.tablet import Screen
from woz_drivers.pepper.voice import Voice
from woz_tui.drivers.contract import Argument, Verb

#: What a stop reaches first stands first.
PARTS: tuple[type[Part], ...] = (
    *(Base, Body, Animations, Voice, Sounds, Head, Eyes, Screen),
    *(Autonomy, Senses, Recognition, Camera, Microphones, NaoqiCall),
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
                hide=address.seen,
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


def by_verb(parts: tuple[Part, ...], settings: PepperSettings) -> Mapping[str, Part]:
    """Which part performs which verb."""
    return {verb.name: part for part in parts for verb in part.verbs(settings)}
