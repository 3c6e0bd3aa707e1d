"""Every setting that the robot itself has, with the calls of NAOqi that read and set it.

The robot file (`settings.py`), the verbs, the screen (`NaoqiRobot.outline`), what is read back and
compared, and the table in `docs/reference/pepper-coverage.md` are made from here.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from woz_tui.drivers.fields import Range
from woz_tui.drivers.robot_settings import Kind, RobotSetting

#: A service, a method, and what comes before the value.
Call = tuple[str, ...]

LIFE, AWARENESS, MOTION, TTS = "ALAutonomousLife", "ALBasicAwareness", "ALMotion", "ALTextToSpeech"
#: A change of state may wake the robot up, or put it to rest, before it returns.
STATE_S = 20.0
#: The verb that changes the tracking mode, and the one mode that moves the head alone.
TRACK, STILL_MODE = "track", "Head"
#: What awareness heeds; the robot takes it in this order.
STIMULI = ("People", "Touch", "Sound", "Movement")
_METRES = Range(0.0, 5.0, "m")
_SPEED, _PITCH = Range(50.0, 400.0, "%"), Range(0.0, 4.0)


@dataclass(frozen=True, slots=True)
class NaoqiSetting(RobotSetting):
    """One setting.

    Attributes:
        get: Reads it; empty: its part does so in a way of its own.
        put: Sets it; empty: as with `get`.
        within: Seconds that setting it may take.
    """

    get: Call = ()
    put: Call = ()
    within: float = 2.0


def _life(name: str, what: str, get: Call, put: Call, **more: Any) -> NaoqiSetting:
    """Something that the robot does by itself."""
    kind: Kind = "choice" if "choices" in more else "flag"
    verb = ("autonomy", name, f"autonomy.{name}")
    return NaoqiSetting("Autonomy", name, kind, what, *verb, get=get, put=put, **more)


def _ability(name: str, what: str, service: str) -> NaoqiSetting:
    return _life(name, what, (service, "isEnabled"), (service, "setEnabled"))


def _breathing(name: str, what: str, chain: str) -> NaoqiSetting:
    get, put = (MOTION, "getBreathEnabled", chain), (MOTION, "setBreathEnabled", chain)
    return _life(name, what, get, put)


_COMMON = (
    NaoqiSetting(
        *("Robot", "robot", "choice", "robot to use; another address can be typed"),
        *("connect", "robot"),
    ),
    NaoqiSetting(
        *("Robot", "awake", "flag", "on: it stands and moves; off: it rests", "torque", "on"),
        get=(MOTION, "robotIsWakeUp"),
        label="motors",
    ),
    NaoqiSetting("Robot", "battery", "number", "charge"),
    # Set in this order: the state switches most of those behind it by itself, breathing of the
    # whole body that of its parts.
    _life(
        "state",
        "solitary and interactive: it does things by itself; disabled: only what you ask for",
        (LIFE, "getState"),
        (LIFE, "setState"),
        label="autonomous life",
        choices=("solitary", "interactive", "safeguard", "disabled"),
        within=STATE_S,
    ),
    _ability("awareness", "turns to people and sounds", AWARENESS),
    _life(
        "engagement",
        "how strongly awareness stays with one person",
        (AWARENESS, "getEngagementMode"),
        (AWARENESS, "setEngagementMode"),
        choices=("Unengaged", "FullyEngaged", "SemiEngaged"),
    ),
    NaoqiSetting(
        *("Autonomy", "tracking", "choice", "what of it follows people; all but Head drive"),
        *(TRACK, "mode", "autonomy.tracking"),
        get=(AWARENESS, "getTrackingMode"),
        put=(AWARENESS, "setTrackingMode"),
        choices=(STILL_MODE, "BodyRotation", "WholeBody", "MoveContextually"),
    ),
    *(
        _life(
            f"heeds_{stimulus.casefold()}",
            f"awareness turns to {stimulus.casefold()}",
            (AWARENESS, "isStimulusDetectionEnabled", stimulus),
            (AWARENESS, "setStimulusDetectionEnabled", stimulus),
        )
        for stimulus in STIMULI
    ),
    _ability("blinking", "blinks", "ALAutonomousBlinking"),
    _ability("listening_movement", "moves slightly while it listens", "ALListeningMovement"),
    _ability("speaking_movement", "moves while it speaks", "ALSpeakingMovement"),
    _breathing("body_breathing", "the whole body breathes", "Body"),
    _breathing("head_breathing", "the head breathes", "Head"),
    _breathing("arms_breathing", "the arms breathe", "Arms"),
    _breathing("legs_breathing", "the legs breathe", "Legs"),
    *(
        NaoqiSetting(
            *("Safety", name, "number", f"metres kept from {what}", "collision", name),
            f"autonomy.{name}",
            get=(MOTION, f"get{name.title()}SecurityDistance"),
            put=(MOTION, f"set{name.title()}SecurityDistance"),
            label=f"{name} distance",
            range=_METRES,
            step=0.05,
        )
        for name, what in (
            ("tangential", "what it drives along"),
            ("orthogonal", "what it drives towards"),
        )
    ),
    NaoqiSetting(
        *("Voice", "volume", "number", "how loud it speaks", "volume", "level"),
        "voice.volume",
        get=(TTS, "getVolume"),
        put=(TTS, "setVolume"),
        step=0.05,
    ),
    NaoqiSetting(
        *("Voice", "speech_speed", "number", "how fast it speaks, 100 is normal"),
        *("speech_speed", "percent", "voice.speed"),
        get=(TTS, "getParameter", "speed"),
        put=(TTS, "setParameter", "speed"),
        range=_SPEED,
        step=5.0,
    ),
    NaoqiSetting(
        *("Voice", "speech_pitch", "number", "0: its own voice; 1 to 4 times that"),
        *("speech_pitch", "pitch", "voice.pitch"),
        get=(TTS, "getParameter", "pitchShift"),
        put=(TTS, "setParameter", "pitchShift"),
        range=_PITCH,
        gap=(0.0, 1.0),
    ),
    NaoqiSetting("Eyes", "eyes", "color", "a name or #rrggbb; off", "eyes", "color", "eyes"),
    NaoqiSetting(
        *("Eyes", "eyes_brightness", "number", "0 dark, 1 full", "eyes_brightness", "level"),
        label="brightness",
    ),
)
#: Those that all kinds of robots have, by name, in the order of the screen.
SETTINGS: Mapping[str, NaoqiSetting] = {one.name: one for one in _COMMON}


def with_own(postures: tuple[str, ...], *own: NaoqiSetting) -> Mapping[str, NaoqiSetting]:
    """All settings of one kind of robot by name: the common ones, its postures, its own."""
    posture = NaoqiSetting(
        *("Robot", "posture", "choice", "how it stands", "posture", "name"),
        get=("ALRobotPosture", "getPosture"),
        choices=postures,
    )
    table: dict[str, NaoqiSetting] = {}
    for one in (*_COMMON, *own):
        table[one.name] = one
        if one.name == "awake":
            table["posture"] = posture
    return table


def played_and_recorded(section: str) -> tuple[NaoqiSetting, ...]:
    """What sounds and microphones do, in that section of the screen."""
    return (
        NaoqiSetting(section, "sound", "text", "the sound file being played"),
        NaoqiSetting(section, "microphones", "text", "what is recorded"),
    )


def of_verb(*verbs: str) -> dict[str, NaoqiSetting]:
    """What these verbs change, by argument; of the common settings."""
    return {one.argument: one for one in SETTINGS.values() if one.verb in verbs}


def of_section(
    section: str, table: Mapping[str, NaoqiSetting] = SETTINGS
) -> Iterable[NaoqiSetting]:
    """What stands in one section of the screen."""
    return (one for one in table.values() if one.section == section)
