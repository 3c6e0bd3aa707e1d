"""Every setting that the robot itself has: its range, its words, the verb that changes it, where
the robot file says it, and the calls of NAOqi that read and set it.

The robot file (`settings.py`), the verbs, the screen (`NaoqiRobot.outline`), what is read back and
compared, and the table in `docs/how-to/pepper.md` are made from here.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

from woz_tui.drivers.contract import Argument
from woz_tui.drivers.fields import Doc, OneOf, Range
from woz_tui.protocol.robot_outline import Setting

#: A service, a method, and what comes before the value.
Call = tuple[str, ...]
Kind = Literal["flag", "choice", "number", "color", "text"]

LIFE, AWARENESS, MOTION, TTS = "ALAutonomousLife", "ALBasicAwareness", "ALMotion", "ALTextToSpeech"
#: A change of state may wake the robot up, or put it to rest, before it returns.
STATE_S = 20.0
_SHARE, _METRES = Range(0.0, 1.0), Range(0.0, 5.0, "m")
_SPEED, _PITCH = Range(50.0, 400.0, "%"), Range(0.0, 4.0)


@dataclass(frozen=True, slots=True)
class RobotSetting:
    """One setting.

    Attributes:
        section: Where on the robot's screen it stands.
        name: Its key among the values that are read back.
        kind: What its value is.
        what: What it is or does.
        verb: What changes it, with its value as `argument`; empty: it is only shown.
        file: Where the robot file asks for it; empty: nowhere.
        get: Reads it; empty: its part does so in a way of its own.
        put: Sets it; empty: as with `get`.
        label: What the screen calls it; empty: its name.
        choices: Of a choice.
        range: Of a number.
        gap: Between these two of a number it takes none.
        step: How far an arrow key changes a number.
        within: Seconds that setting it may take.
    """

    section: str
    name: str
    kind: Kind
    what: str = ""
    verb: str = ""
    argument: str = ""
    file: str = ""
    get: Call = ()
    put: Call = ()
    label: str = ""
    choices: tuple[str, ...] = ()
    range: Range = _SHARE
    gap: tuple[float, float] | None = None
    step: float = 0.1
    within: float = 2.0

    @property
    def doc(self) -> Doc:
        """What it is, for the robot file."""
        return Doc(self.what)

    @property
    def one_of(self) -> OneOf:
        """What the robot file may say of a choice; empty: it is left as it is."""
        return OneOf(("", *self.choices))

    def allows(self, number: float) -> bool:
        """Whether the robot takes that number."""
        low, high = self.gap or (0.0, 0.0)
        return self.range.contains(number) and not low < number < high

    @property
    def numbers(self) -> str:
        """What the robot takes, in words."""
        if self.gap is None:
            return str(self.range)
        return f"{self.gap[0]:g}, or {replace(self.range, low=self.gap[1])}"

    def taken(self, *, required: bool = False) -> Argument:
        """The argument of the verb that changes it."""
        number = self.kind == "number"
        kind = "text" if self.kind == "color" else self.kind
        return Argument(
            *(self.argument, kind, self.what, required),
            range=self.range if number else None,
            choices=self.choices,
        )

    def line(self) -> Setting:
        """As the console is told."""
        return Setting(
            name=self.name,
            section=self.section,
            label=self.label or self.name.replace("_", " "),
            verb=self.verb,
            argument=self.argument,
            kind=self.kind,
            choices=list(self.choices),
            low=self.range.low or 0.0,
            high=self.range.high or 0.0,
            step=self.step,
            unit=self.range.unit,
            help=self.what,
        )


def _life(name: str, what: str, get: Call, put: Call, **more: Any) -> RobotSetting:
    """Something that the robot does by itself."""
    kind: Kind = "choice" if "choices" in more else "flag"
    verb = ("autonomy", name, f"autonomy.{name}")
    return RobotSetting("Autonomy", name, kind, what, *verb, get, put, **more)


def _ability(name: str, what: str, service: str) -> RobotSetting:
    return _life(name, what, (service, "isEnabled"), (service, "setEnabled"))


def _breathing(name: str, what: str, chain: str) -> RobotSetting:
    get, put = (MOTION, "getBreathEnabled", chain), (MOTION, "setBreathEnabled", chain)
    return _life(name, what, get, put)


_COMMON = (
    RobotSetting(
        *("Robot", "robot", "choice", "robot to use; another address can be typed"),
        *("connect", "robot"),
    ),
    RobotSetting(
        *("Robot", "awake", "flag", "on: it stands and moves; off: it rests", "torque", "on"),
        get=(MOTION, "robotIsWakeUp"),
        label="motors",
    ),
    RobotSetting("Robot", "battery", "number", "charge"),
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
    _ability("blinking", "blinks", "ALAutonomousBlinking"),
    _ability("listening_movement", "moves slightly while it listens", "ALListeningMovement"),
    _ability("speaking_movement", "moves while it speaks", "ALSpeakingMovement"),
    _breathing("body_breathing", "the whole body breathes", "Body"),
    _breathing("head_breathing", "the head breathes", "Head"),
    _breathing("arms_breathing", "the arms breathe", "Arms"),
    _breathing("legs_breathing", "the legs breathe", "Legs"),
    *(
        RobotSetting(
            *("Safety", name, "number", f"metres kept from {what}", "collision", name),
            f"autonomy.{name}",
            (MOTION, f"get{name.title()}SecurityDistance"),
            (MOTION, f"set{name.title()}SecurityDistance"),
            label=f"{name} distance",
            range=_METRES,
            step=0.05,
        )
        for name, what in (
            ("tangential", "what it drives along"),
            ("orthogonal", "what it drives towards"),
        )
    ),
    RobotSetting(
        *("Voice", "volume", "number", "how loud it speaks", "volume", "level"),
        *("voice.volume", (TTS, "getVolume"), (TTS, "setVolume")),
        step=0.05,
    ),
    RobotSetting(
        *("Voice", "speech_speed", "number", "how fast it speaks, 100 is normal"),
        *("speech_speed", "percent", "voice.speed"),
        *((TTS, "getParameter", "speed"), (TTS, "setParameter", "speed")),
        range=_SPEED,
        step=5.0,
    ),
    RobotSetting(
        *("Voice", "speech_pitch", "number", "0: its own voice; 1 to 4 times that"),
        *("speech_pitch", "pitch", "voice.pitch"),
        *((TTS, "getParameter", "pitchShift"), (TTS, "setParameter", "pitchShift")),
        range=_PITCH,
        gap=(0.0, 1.0),
    ),
    RobotSetting("Eyes", "eyes", "color", "a name or #rrggbb; off", "eyes", "color", "eyes"),
    RobotSetting(
        *("Eyes", "eyes_brightness", "number", "0 dark, 1 full", "eyes_brightness", "level"),
        label="brightness",
    ),
)
#: Those that all kinds of robots have, by name, in the order of the screen.
SETTINGS: Mapping[str, RobotSetting] = {one.name: one for one in _COMMON}


def with_own(postures: tuple[str, ...], *own: RobotSetting) -> Mapping[str, RobotSetting]:
    """All settings of one kind of robot by name: the common ones, its postures, its own."""
    posture = RobotSetting(
        *("Robot", "posture", "choice", "how it stands", "posture", "name"),
        get=("ALRobotPosture", "getPosture"),
        choices=postures,
    )
    table: dict[str, RobotSetting] = {}
    for one in (*_COMMON, *own):
        table[one.name] = one
        if one.name == "awake":
            table["posture"] = posture
    return table


def played_and_recorded(section: str) -> tuple[RobotSetting, ...]:
    """What sounds and microphones do, in that section of the screen."""
    return (
        RobotSetting(section, "sound", "text", "the sound file being played"),
        RobotSetting(section, "microphones", "text", "what is recorded"),
    )


def of_verb(*verbs: str) -> dict[str, RobotSetting]:
    """What these verbs change, by argument; of the common settings."""
    return {one.argument: one for one in SETTINGS.values() if one.verb in verbs}


def of_section(
    section: str, table: Mapping[str, RobotSetting] = SETTINGS
) -> Iterable[RobotSetting]:
    """What stands in one section of the screen."""
    return (one for one in table.values() if one.section == section)
