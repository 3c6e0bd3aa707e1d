"""What an engine gives back: results of inputs, and ticks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from woz_tui.motion.light_frames import LightFrame
from woz_tui.motion.modes import Mode
from woz_tui.motion.move_types import SoundCue
from woz_tui.protocol.messages import Json


@dataclass(frozen=True, slots=True)
class InputResult:
    """What an engine did with an input.

    `sent` is what was really taken, after clamping. An input that takes time has a `token`, which
    some later tick names in `ended`, and `seconds` if it is known how long. `stroke`: where its
    meaning lies, in seconds from its beginning, if it has such a point.
    """

    sent: Mapping[str, Json] = field(default_factory=dict)
    token: int = 0
    seconds: float | None = None
    stroke: float | None = None


@dataclass(frozen=True, slots=True)
class EndedInput:
    """An input that took time is over; `why` is empty if it came to its own end."""

    token: int
    why: str = ""


@dataclass(frozen=True, slots=True)
class Tick:
    """One moment of a body, in degrees.

    `wanted` is what the layers ask for, `joints` what safety lets through: within range, speed and
    acceleration, always finite. `face` is None for a body without one.
    """

    t: float
    joints: Mapping[str, float]
    wanted: Mapping[str, float]
    mode: Mode
    emotion: str
    intensity: float
    face: LightFrame | None = None
    brightness: float = 1.0
    move: str = ""
    ended: tuple[EndedInput, ...] = ()
    #: The input whose stroke this moment is, by token; 0: none.
    stroke: int = 0
    cues: tuple[SoundCue, ...] = ()
    #: Sentences for the wizard: why a mode ended, what a value was replaced by.
    notices: tuple[str, ...] = ()
