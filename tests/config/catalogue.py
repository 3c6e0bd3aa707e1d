"""Drivers for reading files with: real driver classes that want many kinds of settings."""

from __future__ import annotations

import enum
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path as FilePath
from typing import Annotated, Any, ClassVar, Literal

from woz_drivers.body import Body
from woz_drivers.dynamixel import DynamixelServos
from woz_drivers.simulated.settings import SimulatedSettings

from woz_tui.drivers.contract import Argument, Ask, Driver, Job, Offer, PassiveDriver, Verb
from woz_tui.drivers.fields import Doc, OneOf, Path, Pattern, Port, Range, Seconds, Section
from woz_tui.protocol.messages import Json


class Bare(PassiveDriver):
    """What every driver here does with hardware: nothing."""

    summary = "for tests"

    async def perform(self, job: Job) -> Mapping[str, Json]:
        return dict(job.args)


@dataclass(frozen=True, slots=True)
class Joint:
    id: Annotated[int, Range(0, 252), Doc("the servo's id")]
    min: Annotated[float, Range(-180, 180, "deg")] = -90.0
    max: Annotated[float, Range(-180, 180, "deg")] = 90.0


@dataclass(frozen=True, slots=True)
class HeadSettings(Section):
    port: Annotated[
        str, Port(), Pattern(r"/dev/\S+", "a device such as /dev/ttyUSB0"), Doc("where it is")
    ]
    joints: Annotated[dict[str, Joint], Doc("the joints by name")]
    rate: Annotated[float, Range(1, 200, "Hz")] = 50.0
    torque: bool = False

    def problems(self) -> list[tuple[str, str]]:
        return [
            (f"joints.{name}.min", f"{joint.min:g} is not below max ({joint.max:g})")
            for name, joint in self.joints.items()
            if joint.min >= joint.max
        ]


class Head(Bare):
    """A head with joints that it can name."""

    Settings = HeadSettings

    @classmethod
    def offer(cls, settings: HeadSettings) -> Offer:
        seconds = Argument("seconds", "seconds", default=1.0, range=Range(0, 60, "s"))
        move = Argument("move", "choice", required=True, choices=("nod", "shake"))
        return Offer(
            lacks={"repeat": "it has no mouth"},
            joints={
                name: Range(joint.min, joint.max, "deg") for name, joint in settings.joints.items()
            },
            verbs=(
                Verb("play", "a gesture", (move, Argument("speed", "number", range=Range(0.1, 4)))),
                Verb(
                    "pose",
                    "a pose",
                    (Argument("joints", "joints", required=True), seconds),
                    arrives=True,
                ),
                Verb("poses", "poses", (Argument("poses", "poses", required=True),)),
                Verb("home", "go home", (seconds,)),
                Verb("torque", "hold", (Argument("on", "flag", required=True),), lane="control"),
                Verb("blink", "close the eyes once", lane="eyes"),
            ),
            sensors=tuple(f"joint.{name}" for name in settings.joints),
        )


class Colour(enum.Enum):
    RED = "red"
    BLUE = "blue"


@dataclass(frozen=True, slots=True)
class Rule:
    when: str
    level: Annotated[float, Range(0, 1)] = 0.5


@dataclass(frozen=True, slots=True)
class VoiceSettings:
    """Every kind of setting that a file can hold."""

    voice: Annotated[str, OneOf(("anna", "otto"))] = "anna"
    volume: Annotated[float, Range(0, 1)] = 1.0
    pause: Annotated[float, Seconds(0, 10)] = 0.2
    retries: int = 3
    colour: Colour = Colour.RED
    mode: Literal["loud", "soft"] = "soft"
    words: Annotated[tuple[str, ...], Doc("words it knows")] = ()
    pair: tuple[float, float] = (0.0, 1.0)
    rules: tuple[Rule, ...] = ()
    numbers: list[int] = field(default_factory=list)
    limit: Annotated[float | None, Range(0, 5, "m")] = None
    command: str | tuple[str, ...] = ""
    either: int | str = 0
    wav: Annotated[str, Path(must_exist=True)] = ""
    folder: FilePath | None = None
    extra: Any = None
    from_: str = ""

    def __post_init__(self) -> None:
        if self.retries > 100:
            raise ValueError("nobody tries 100 times")


class Voice(Bare):
    """A voice."""

    Settings: ClassVar[type] = VoiceSettings

    @classmethod
    def offer(cls, settings: VoiceSettings) -> Offer:
        return Offer(
            verbs=(
                Verb(
                    "say",
                    "speak",
                    (
                        Argument("text", "text", "what to say", required=True),
                        Argument("volume", "number", range=Range(0, 1)),
                        Argument("speed", "number", range=Range(0.5, 2)),
                    ),
                    lane="voice",
                    limit_s=60.0,
                ),
                Verb(
                    "sound", "play a file", (Argument("file", "file", required=True),), lane="sound"
                ),
                Verb("volume", "how loud", (Argument("level", "number", range=Range(0, 1)),)),
                Verb("repeat", "say it again", (Argument("times", "whole", range=Range(1, 9)),)),
            )
        )


@dataclass(frozen=True, slots=True)
class NoSettings:
    """Nothing can be set."""


class Simulated(Bare):
    """A robot without hardware, whose robot file is the real one's."""

    Settings = SimulatedSettings

    @classmethod
    def offer(cls, settings: SimulatedSettings) -> Offer:
        emotions = ("neutral", "happy", "sad")
        return Offer(
            verbs=(
                Verb("say", "speak", (Argument("text", "text", required=True),), lane="voice"),
                Verb(
                    "emotion",
                    "show an emotion",
                    (
                        Argument("emotion", "choice", required=True, choices=emotions),
                        Argument("intensity", "number", range=Range(0, 1)),
                    ),
                    lane="face",
                ),
                Verb(
                    "drive",
                    "drive",
                    (Argument("x", "number", range=Range(-1, 1, "m")), Argument("turn", "number")),
                    lane="base",
                    drives=True,
                ),
                Verb(
                    "screen", "show a file", (Argument("file", "file", required=True),), lane="face"
                ),
            )
        )


@dataclass(frozen=True, slots=True)
class CameraSettings:
    """What it sees; and buttons on it that ask for verbs: `toggle: gaze`."""

    sees: tuple[str, ...] = ("presence", "gaze", "identity")
    buttons: dict[str, str] = field(default_factory=dict)


class Camera(Bare):
    """Senses what it is told to."""

    Settings = CameraSettings

    @classmethod
    def offer(cls, settings: CameraSettings) -> Offer:
        return Offer(
            sensors=settings.sees,
            asks=tuple(
                (f"buttons.{verb}", Ask("verb", verb, {"sign": sign}))
                for verb, sign in settings.buttons.items()
            ),
        )


class Failing(Bare):
    """A stranger's driver with a bug."""

    Settings = NoSettings

    @classmethod
    def offer(cls, settings: NoSettings) -> Offer:
        raise RuntimeError("a bug in the driver")


CATALOGUE: Mapping[str, type[Driver]] = {
    "head": Head,
    "voice": Voice,
    "simulated": Simulated,
    "camera": Camera,
    "failing": Failing,
    "body": Body,
    "dynamixel": DynamixelServos,
}
