"""The settings of a Furhat in a robot file."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Annotated

from woz_drivers.furhat.moves import FACE_PARAMETERS, FaceFrame
from woz_drivers.programs.simulated_process import SIMULATED, robot_place
from woz_drivers.sound.live_talk import TalkSettings
from woz_tui.drivers.argument_values import color, did_you_mean
from woz_tui.drivers.fields import Doc, OneOf, Range, Seconds, Section
from woz_tui.drivers.robot_settings import RobotSetting, problem_at

#: Where the Realtime API listens.
PORT = 9000
#: What can be shown and changed, by name; `seen` is only shown.
SETTINGS = {
    row.name: row
    for row in (
        RobotSetting(
            *("Voice", "voice", "text", "name of the voice, or a part of it", "voice", "name"),
            file="voice.name",
            label="Voice",
        ),
        RobotSetting(
            *("Voice", "volume", "number", "how loud it is: 0 mute, 1 full", "volume", "level"),
            file="voice.volume",
            label="Volume",
        ),
        RobotSetting(
            *("Voice", "listening", "flag"),
            *("recognises what is said, but not while it speaks itself", "listen", "on"),
            label="Listens",
        ),
        RobotSetting(
            *("Face", "face", "text", "mask and character, such as adult - Isabel"),
            *("face", "face"),
            file="face",
            label="Face",
        ),
        RobotSetting(
            *("Face", "eyes", "color", "a name or #rrggbb; off", "eyes", "color"),
            file="led",
            label="LED ring",
        ),
        RobotSetting(
            *("Face", "attends", "text", "closest, nobody, or a user's id", "follow", "user"),
            label="Looks at",
        ),
        RobotSetting("Face", "seen", "text", "who is there, by id", label="Sees"),
    )
}
SPEEDS = ("xslow", "slow", "medium", "fast", "xfast")
_NO_VARIABLE = (
    "must be the name of an environment variable, in capitals, such as WOZ_FURHAT_KEY; the key"
    " itself stands in no file"
)
_EXAMPLES = "write the address of the robot, such as 192.168.1.20, or simulated"


@dataclass(frozen=True, slots=True)
class FurhatVoiceSettings:
    """How it speaks. What is not named is left as the robot has it."""

    name: Annotated[str, SETTINGS["voice"].doc] = ""
    language: Annotated[str, Doc("language of the voice: en-US")] = ""
    gender: Annotated[str, Doc("male, female or neutral, as the robot's list of voices has it")] = (
        ""
    )
    volume: Annotated[float | None, SETTINGS["volume"].range, SETTINGS["volume"].doc] = None


@dataclass(frozen=True, slots=True)
class FurhatListeningSettings:
    """What it recognises of what is said to it."""

    on: Annotated[bool, Doc("listen from the start, but not while it speaks itself")] = True
    languages: Annotated[tuple[str, ...], Doc("languages to recognise")] = ("en-US",)
    phrases: Annotated[tuple[str, ...], Doc("words that are likely, such as names")] = ()
    end_speech: Annotated[float, Seconds(0.1, 10), Doc("silence that ends an utterance")] = 1.0


@dataclass(frozen=True, slots=True)
class FurhatTalkSettings(TalkSettings):
    """How somebody talks through it live."""

    lipsync: Annotated[bool, Doc("move the lips to the voice")] = True


@dataclass(frozen=True, slots=True)
class FurhatGazeSettings:
    """How it looks at somebody or something."""

    speed: Annotated[str, OneOf(SPEEDS), Doc("of the head")] = "medium"
    slack_yaw: Annotated[
        float, Range(0, 60, "degrees"), Doc("so far to the side the eyes turn without the head")
    ] = 5.0
    slack_pitch: Annotated[
        float, Range(0, 60, "degrees"), Doc("so far up and down the eyes turn without the head")
    ] = 5.0
    slack_timeout: Annotated[
        float, Seconds(0, 60), Doc("after so long the head follows the eyes")
    ] = 3.0
    mirrored: Annotated[
        bool, Doc("true if the robot looks to the right when it should look to the left")
    ] = False


@dataclass(frozen=True, slots=True)
class FurhatSensesSettings:
    """What is read from the robot all the time."""

    users: Annotated[bool, Doc("presence, gaze, distance and direction of people")] = True
    loudness: Annotated[bool, Doc("loudness at its microphone")] = True


@dataclass(frozen=True, slots=True)
class GestureFrame:
    """A piece of a gesture of your own."""

    seconds: Annotated[float, Seconds(0, 60), Doc("time from the piece before")]
    face: Annotated[dict[str, float], Doc("face parameters, 0 to 1")] = field(default_factory=dict)
    yaw: Annotated[float, Range(-60, 60, "degrees"), Doc("turn of the head to the left")] = 0.0
    pitch: Annotated[float, Range(-40, 40, "degrees"), Doc("turn of the head down")] = 0.0


@dataclass(frozen=True, slots=True)
class FurhatSettings(Section):
    """One Furhat."""

    address: Annotated[str, Doc("the robot's address, host or host:port, or simulated")] = SIMULATED
    key: Annotated[
        str, Doc("name of the environment variable with the key of the Realtime API")
    ] = "WOZ_FURHAT_KEY"
    face: Annotated[str, SETTINGS["face"].doc_on_connect] = ""
    led: Annotated[str, SETTINGS["eyes"].doc_on_connect] = ""
    voice: Annotated[FurhatVoiceSettings, Doc("applied on connect")] = field(
        default_factory=FurhatVoiceSettings
    )
    listening: Annotated[FurhatListeningSettings, Doc("recognition of speech")] = field(
        default_factory=FurhatListeningSettings
    )
    attention: Annotated[FurhatGazeSettings, Doc("how it looks")] = field(
        default_factory=FurhatGazeSettings
    )
    senses: Annotated[FurhatSensesSettings, Doc("what is read")] = field(
        default_factory=FurhatSensesSettings
    )
    gestures: Annotated[
        dict[str, tuple[GestureFrame, ...]], Doc("gestures of your own, for `play`")
    ] = field(default_factory=dict)
    pictures: Annotated[
        str, Doc("folder for camera pictures on this machine; empty: beside the log")
    ] = ""
    talk: Annotated[
        FurhatTalkSettings | None,
        Doc("somebody can talk through its loudspeaker live: verbs `talk` and `end_talk`"),
    ] = None
    pace: Annotated[
        float, Range(0.01, 100), Doc("of the simulated robot only: how fast its time passes")
    ] = 1.0

    @property
    def place(self) -> str:
        """`host:port` of the robot; empty for the simulated one. Raises `RejectedError`."""
        return robot_place(self.address, PORT, _EXAMPLES)

    def frames(self, move: str) -> tuple[FaceFrame, ...]:
        """A gesture of the robot file."""
        return tuple(
            FaceFrame(one.seconds, one.face, one.yaw, one.pitch) for one in self.gestures[move]
        )

    def problems(self) -> list[tuple[str, str]]:
        """What no robot takes, by the setting's path."""
        found: list[tuple[str, str]] = []
        with problem_at("address", found):
            _ = self.place
        if self.talk is not None:
            found += self.talk.problems()
        if not re.fullmatch("[A-Z][A-Z0-9_]*", self.key):
            found.append(("key", _NO_VARIABLE))
        if self.led:
            with problem_at("led", found):
                color({"color": self.led}, "color")
        for name, frames in self.gestures.items():
            for index, frame in enumerate(frames):
                for parameter, value in frame.face.items():
                    path = f"gestures.{name}[{index}].face.{parameter}"
                    limits = FACE_PARAMETERS.get(parameter)
                    if limits is None:
                        near = did_you_mean(parameter, sorted(FACE_PARAMETERS))
                        found.append((path, f"is no face parameter; {near}"))
                    elif not limits.contains(value):
                        found.append((path, f"must be within {limits}"))
        return found
