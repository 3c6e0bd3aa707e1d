"""The settings of a Pepper in a robot file."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from operator import attrgetter
from typing import Annotated

from woz_drivers.naoqi_robot.address import parse, without_password
from woz_drivers.naoqi_robot.robot_settings import SETTINGS, RobotSetting, of_section
from woz_drivers.simulated.argument_values import color
from woz_tui.drivers.contract import RejectedError
from woz_tui.drivers.fields import Doc, OneOf, Range, Seconds, Section
from woz_tui.protocol.messages import Json

#: What a file may name as its client from the time when there were two.
CLIENTS = ("auto", "qi", "own")


@dataclass(frozen=True, slots=True)
class AutonomySettings:
    """What the robot does by itself. What is not named is left as the robot has it."""

    state: Annotated[str, SETTINGS["state"].one_of, SETTINGS["state"].doc] = ""
    awareness: Annotated[bool | None, SETTINGS["awareness"].doc] = None
    engagement: Annotated[str, SETTINGS["engagement"].one_of, SETTINGS["engagement"].doc] = ""
    blinking: Annotated[bool | None, SETTINGS["blinking"].doc] = None
    listening_movement: Annotated[bool | None, SETTINGS["listening_movement"].doc] = None
    speaking_movement: Annotated[bool | None, SETTINGS["speaking_movement"].doc] = None
    head_breathing: Annotated[bool | None, SETTINGS["head_breathing"].doc] = None
    arms_breathing: Annotated[bool | None, SETTINGS["arms_breathing"].doc] = None
    body_breathing: Annotated[bool | None, SETTINGS["body_breathing"].doc] = None
    legs_breathing: Annotated[bool | None, SETTINGS["legs_breathing"].doc] = None
    tangential: Annotated[
        float | None, SETTINGS["tangential"].range, SETTINGS["tangential"].doc
    ] = None
    orthogonal: Annotated[
        float | None, SETTINGS["orthogonal"].range, SETTINGS["orthogonal"].doc
    ] = None


@dataclass(frozen=True, slots=True)
class VoiceSettings:
    """How it speaks. What is not named is left as the robot has it."""

    volume: Annotated[float | None, SETTINGS["volume"].range, SETTINGS["volume"].doc] = None
    speed: Annotated[float | None, SETTINGS["speech_speed"].range, SETTINGS["speech_speed"].doc] = (
        None
    )
    pitch: Annotated[float | None, SETTINGS["speech_pitch"].range, SETTINGS["speech_pitch"].doc] = (
        None
    )


@dataclass(frozen=True, slots=True)
class TabletSettings:
    """The tablet at its chest."""

    root: Annotated[str, Doc("folder of its files, relative to the experiment file")] = ""
    default: Annotated[str, Doc("shown on connect and when nothing else is")] = ""
    address: Annotated[
        str, Doc("this machine's address as the robot reaches it; empty: found out")
    ] = ""
    port: Annotated[int, Range(0, 65535), Doc("where pictures are served; 0: any")] = 0


@dataclass(frozen=True, slots=True)
class SensesSettings:
    """What is read from the robot all the time."""

    rate: Annotated[float, Range(1, 20, "Hz"), Doc("readings a second")] = 5.0
    sonar: Annotated[bool, Doc("distance")] = True
    people: Annotated[bool, Doc("presence, gaze, distance of people, identity")] = True
    loudness: Annotated[bool, Doc("loudness and direction of sound")] = True
    touch: Annotated[bool, Doc("touches of the tablet, as readings")] = True


@dataclass(frozen=True, slots=True)
class RecognitionSettings:
    """What the robot understands of what is said to it."""

    phrases: Annotated[
        tuple[str, ...], Doc("words and short sentences to understand, no others; none: off")
    ] = ()
    language: Annotated[str, Doc("as the robot calls it: English; empty: as it is")] = ""
    spotting: Annotated[bool, Doc("also within longer sentences")] = True
    confidence: Annotated[
        float, Range(0, 1), Doc("what the robot is less sure of counts as not understood")
    ] = 0.4


@dataclass(frozen=True, slots=True)
class PepperSettings(Section):
    """One Pepper, or several of which one is played at a time."""

    robots: Annotated[
        tuple[str, ...],
        Doc(
            "addresses of robots; the first one is used at the start: a host name, tcp://HOST:9559,"
            " tcps://USER@HOST:9503, or simulated"
        ),
    ]
    client: Annotated[str, OneOf(CLIENTS), Doc("without effect: there is one client")] = "auto"
    connect: Annotated[bool, Doc("connect at the start; else wait for the wizard")] = True
    password: Annotated[
        str, Doc("name of the environment variable that holds the password for tcps")
    ] = "WOZ_PEPPER_PASSWORD"
    trusted: Annotated[
        str, Doc("SHA-256 of the expected certificate with tcps; empty: any, with a warning")
    ] = ""
    heartbeat: Annotated[
        float,
        Seconds(0.1, 1.5),
        Doc("time of silence after which the robot is asked for an answer"),
    ] = 0.5
    autonomy: Annotated[AutonomySettings, Doc("applied on connect")] = field(
        default_factory=AutonomySettings
    )
    voice: Annotated[VoiceSettings, Doc("applied on connect")] = field(
        default_factory=VoiceSettings
    )
    eyes: Annotated[str, Doc("colour of the eyes on connect: a name or #rrggbb")] = ""
    tablet: Annotated[TabletSettings, Doc("its tablet")] = field(default_factory=TabletSettings)
    senses: Annotated[SensesSettings, Doc("what is read")] = field(default_factory=SensesSettings)
    recognition: Annotated[RecognitionSettings, Doc("what it understands of speech")] = field(
        default_factory=RecognitionSettings
    )
    posture: Annotated[str, Doc("taken when the robot is left alone; empty: it rests")] = ""
    pictures: Annotated[
        str, Doc("folder for camera pictures on this machine; empty: beside the log")
    ] = ""
    recordings: Annotated[str, Doc("folder for microphone recordings on the robot")] = (
        "/home/nao/recordings"
    )
    pace: Annotated[
        float, Range(0.01, 100), Doc("of the simulated robot only: how fast its time passes")
    ] = 1.0

    def problems(self) -> list[tuple[str, str]]:
        """What no robot takes, by the setting's path."""
        found = [*self._passwords()]
        if self.eyes:
            try:
                color({"color": self.eyes}, "color")
            except RejectedError as error:
                found.append(("eyes", f"{error.what}; {error.remedy}"))
        for name, value in self.initial_values(of_section("Voice")).items():
            if isinstance(value, int | float) and not SETTINGS[name].allows(value):
                found.append((SETTINGS[name].file, f"takes {SETTINGS[name].numbers}"))
        return found

    def initial_values(self, settings: Iterable[RobotSetting]) -> dict[str, Json]:
        """What the file asks for of these, by name; the rest is left as the robot has it."""
        found: dict[str, Json] = {}
        for setting in settings:
            value = attrgetter(setting.file)(self) if setting.file else None
            if value not in (None, ""):
                found[setting.name] = value
        return found

    def warnings(self) -> list[tuple[str, str]]:
        """What is not as it is written, by the setting's path."""
        if self.client != "qi":
            return []
        return [("client", "the package qi is not used: woz-tui's own client is; remove this line")]

    def _passwords(self) -> Iterator[tuple[str, str]]:
        """Addresses with something in them that may be a password: the file goes into every log.
        Others that are none are told of when they are connected to.
        """
        for index, robot in enumerate(self.robots):
            if without_password(robot) == robot:
                continue
            try:
                parse(robot)
            except RejectedError as error:
                yield f"robots[{index}]", f"{error.what}; {error.remedy}"
