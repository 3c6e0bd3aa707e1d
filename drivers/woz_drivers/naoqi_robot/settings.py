"""Settings that all robots with NAOqi have in a robot file."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from operator import attrgetter
from typing import Annotated, ClassVar, Protocol

from woz_drivers.naoqi_robot.address import parse, without_password
from woz_drivers.naoqi_robot.model import RobotModel
from woz_drivers.naoqi_robot.robot_settings import (
    SETTINGS,
    STILL_MODE,
    NaoqiSetting,
    of_section,
)
from woz_drivers.sound.live_talk import TalkSettings
from woz_tui.drivers.argument_values import color
from woz_tui.drivers.fields import Doc, OneOf, Range, Seconds, Section
from woz_tui.drivers.robot_settings import problem_at
from woz_tui.protocol.messages import Json

#: What ALAudioDevice plays, in Hz.
TALK_RATES = (16_000, 22_050, 44_100, 48_000)


@dataclass(frozen=True, slots=True)
class AutonomySettings:
    """What the robot does by itself. What is not named is left as the robot has it."""

    state: Annotated[str, SETTINGS["state"].one_of, SETTINGS["state"].doc] = ""
    awareness: Annotated[bool | None, SETTINGS["awareness"].doc] = None
    engagement: Annotated[str, SETTINGS["engagement"].one_of, SETTINGS["engagement"].doc] = ""
    tracking: Annotated[
        str, OneOf(("", STILL_MODE)), Doc("what of it follows people; more than the head: `track`")
    ] = ""
    heeds_people: Annotated[bool | None, SETTINGS["heeds_people"].doc] = None
    heeds_touch: Annotated[bool | None, SETTINGS["heeds_touch"].doc] = None
    heeds_sound: Annotated[bool | None, SETTINGS["heeds_sound"].doc] = None
    heeds_movement: Annotated[bool | None, SETTINGS["heeds_movement"].doc] = None
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


class ServingSettings(Protocol):
    """Where files of this machine are served to the robot."""

    @property
    def address(self) -> str:
        """This machine's address as the robot reaches it; empty: found out."""
        ...

    @property
    def port(self) -> int:
        """0: any."""
        ...


@dataclass(frozen=True, slots=True)
class SensesSettings:
    """What is read from the robot all the time."""

    rate: Annotated[float, Range(1, 20, "Hz"), Doc("readings a second")] = 5.0
    sonar: Annotated[bool, Doc("distance")] = True
    people: Annotated[bool, Doc("presence, gaze, distance of people, identity")] = True
    loudness: Annotated[bool, Doc("loudness and direction of sound")] = True
    touch: Annotated[bool, Doc("touches, as readings")] = True
    face: Annotated[
        bool, Doc("age, gender, smile, expression as the robot guesses them; the law limits it")
    ] = False
    mood: Annotated[
        bool, Doc("mood and attention as the robot guesses them; the law limits it")
    ] = False


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


@dataclass(frozen=True)
class NaoqiSettings(Section):
    """One robot, or several of which one is played at a time."""

    model: ClassVar[RobotModel]
    #: Where the robot file says where files are served.
    serving_section: ClassVar[str]

    connect: Annotated[bool, Doc("connect at the start; else wait for the wizard")] = True
    password: Annotated[
        str, Doc("name of the environment variable that holds the password for tcps")
    ] = ""
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
    eyes: Annotated[str, SETTINGS["eyes"].doc_on_connect] = ""
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
    talk: Annotated[
        TalkSettings | None,
        Doc("somebody can talk through its loudspeaker live: verbs `talk` and `end_talk`"),
    ] = None
    pace: Annotated[
        float, Range(0.01, 100), Doc("of the simulated robot only: how fast its time passes")
    ] = 1.0
    echo: Annotated[
        float,
        Range(0, 1),
        Doc("of the simulated robot only: how loud its microphones hear its own voice; 0: not"),
    ] = 0.3

    @property
    def addresses(self) -> Mapping[str, str]:
        """Robots as the file writes them, by the setting's path; the first one is used at the
        start.
        """
        raise NotImplementedError

    @property
    def serving(self) -> ServingSettings:
        """Where files of this machine are served to the robot."""
        raise NotImplementedError

    def problems(self) -> list[tuple[str, str]]:
        """What no robot takes, by the setting's path."""
        found: list[tuple[str, str]] = []
        for path, robot in self.addresses.items():
            # One that is none is told of when it is connected to, but for one with something in it
            # that may be a password: the file goes into every log.
            if without_password(robot) != robot:
                with problem_at(path, found):
                    parse(robot)
        if self.eyes:
            with problem_at("eyes", found):
                color({"color": self.eyes}, "color")
        for name, value in self.initial_values(of_section("Voice")).items():
            if isinstance(value, int | float) and not SETTINGS[name].allows(value):
                found.append((SETTINGS[name].file, f"takes {SETTINGS[name].numbers}"))
        if self.posture and self.posture not in self.model.postures:
            known = ", ".join(self.model.postures)
            found.append(("posture", f"no robot of this kind has {self.posture!r}; it has {known}"))
        if self.talk is not None:
            found += self.talk.problems()
            if self.talk.rate not in TALK_RATES:
                rates = ", ".join(map(str, TALK_RATES))
                found.append(("talk.rate", f"its loudspeaker plays {rates} Hz"))
        return found

    def initial_values(self, settings: Iterable[NaoqiSetting]) -> dict[str, Json]:
        """What the file asks for of these, by name; the rest is left as the robot has it."""
        found: dict[str, Json] = {}
        for setting in settings:
            value = attrgetter(setting.file)(self) if setting.file else None
            if value not in (None, ""):
                found[setting.name] = value
        return found
