"""The events of the Realtime API that are used here, as the robot sends them.

Names and fields are those of furhat-realtime-api 0.1.3; fields that only reports of other programs
have are optional. An event about a request carries its `request_id`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import msgspec


class RobotEvent(msgspec.Struct, frozen=True, kw_only=True, tag_field="type"):
    """What all events have in common."""

    request_id: str | None = None


class Access(RobotEvent, frozen=True, kw_only=True, tag="response.auth"):
    """Whether the key was right; `scope`: what it is good for."""

    access: bool
    scope: str | None = None


class SpeakStarted(RobotEvent, frozen=True, tag="response.speak.start"):
    """It begins to speak."""

    text: str | None = None


class SpeakWord(RobotEvent, frozen=True, kw_only=True, tag="response.speak.word"):
    """It says a word; `index` counts from 0."""

    word: str | None = None
    index: int


class SpeakEnded(RobotEvent, frozen=True, tag="response.speak.end"):
    """It has ended, been cut short, or could not begin."""

    text: str | None = None
    aborted: bool | None = None
    failed: bool | None = None


class SpeakBuffer(RobotEvent, frozen=True, tag="response.speak.audio.buffer"):
    """How much of the sound that is sent to it has been played, in bytes."""

    played: int | None = None


class GestureStarted(RobotEvent, frozen=True, tag="response.gesture.start"):
    """A gesture has begun."""


class GestureEnded(RobotEvent, frozen=True, tag="response.gesture.end"):
    """A gesture is over."""


class AttendStatus(RobotEvent, frozen=True, tag="response.attend.status"):
    """At whom or what it looks: nobody, location, or a user's id."""

    target: str | None = None
    current: str | None = None


class VoiceStatus(RobotEvent, frozen=True, tag="response.voice.status"):
    """The voice, and all that there are: ids, or objects with `voice_id`, `name`, `language`."""

    voice_id: str | None = None
    voice_list: list[str | dict[str, Any]] | None = None


class FaceStatus(RobotEvent, frozen=True, tag="response.face.status"):
    """The face, and all that there are: `mask - character`."""

    face_id: str | None = None
    face_list: list[str] | None = None


class SystemStatus(RobotEvent, frozen=True, tag="response.system.status"):
    """Volume in per cent, and whether it is the vendor's virtual robot."""

    volume: float | None = None
    virtual: bool | None = None


class ListenStarted(RobotEvent, frozen=True, tag="response.listen.start"):
    """It listens."""


class ListenEnded(RobotEvent, frozen=True, tag="response.listen.end"):
    """It does not listen any more; `cause`: stopped, robot_speak, speech_end, silence_timeout."""

    cause: str | None = None


class HearStarted(RobotEvent, frozen=True, tag="response.hear.start"):
    """Somebody speaks."""


class HearPartial(RobotEvent, frozen=True, kw_only=True, tag="response.hear.partial"):
    """What was understood so far."""

    text: str


class HearEnded(RobotEvent, frozen=True, tag="response.hear.end"):
    """They have stopped; what was understood."""

    text: str | None = None


class Place(msgspec.Struct, frozen=True):
    """Metres from the robot: x to its left, y up, z forward."""

    x: float
    y: float
    z: float


class Coordinates(msgspec.Struct, frozen=True):
    """A `Place` as the robot sends it: of what it has not measured it gives no number."""

    x: float | None = None
    y: float | None = None
    z: float | None = None


class DetectedUser(msgspec.Struct, frozen=True, kw_only=True):
    """Somebody whom the camera sees. Versions of the robot give the place flat or as `location`;
    `attending`: whether they look at the robot, as a flag or as a share.
    """

    id: str | int
    x: float | None = None
    y: float | None = None
    z: float | None = None
    location: Coordinates | None = None
    distance: float | None = None
    attending: bool | float | None = None

    @property
    def place(self) -> Place | None:
        """Where they are, if the robot says so."""
        where = self.location or self
        if where.x is None or where.z is None:
            return None
        return Place(where.x, where.y or 0.0, where.z)


class UsersData(RobotEvent, frozen=True, kw_only=True, tag="response.users.data"):
    """Everybody whom the camera sees."""

    users: list[DetectedUser]


class CameraData(RobotEvent, frozen=True, kw_only=True, tag="response.camera.data"):
    """A JPEG picture in base64."""

    image: str


class AudioData(RobotEvent, frozen=True, tag="response.audio.data"):
    """Sound in base64: 16-bit samples."""

    microphone: str | None = None


Events = (
    *(Access, SpeakStarted, SpeakWord, SpeakEnded, SpeakBuffer, GestureStarted, GestureEnded),
    *(AttendStatus, VoiceStatus, FaceStatus, SystemStatus, ListenStarted, ListenEnded),
    *(HearStarted, HearPartial, HearEnded, UsersData, CameraData, AudioData),
)
_BY_TYPE: Mapping[str, type[RobotEvent]] = {
    str(kind.__struct_config__.tag): kind for kind in Events
}


def read_event(message: Any) -> RobotEvent | None:
    """The event; None for one that is not used here. Raises `ValueError` for what is no event."""
    if not isinstance(message, dict) or not isinstance(message.get("type"), str):
        raise ValueError(f"{str(message)[:60]!r} is no event")
    kind = _BY_TYPE.get(message["type"])
    return None if kind is None else msgspec.convert(message, kind)


def read_error(message: Any) -> tuple[str, str] | None:
    """What the robot complains of, and the id of the request; None for everything else.

    Nobody documents an error's form: its type holds `error`, or it has a text of that name.
    """
    if not isinstance(message, dict):
        return None
    words = message.get("error") or message.get("message")
    if "error" not in str(message.get("type", "")) and not message.get("error"):
        return None
    return str(words or "an error without words")[:200], str(message.get("request_id") or "")
