"""Which mode takes which input: the one table that keyboard, panel and socket are held to.

Normal is direct control with breathing and blinking. The demo plays by itself, object tracking
follows what the camera sees, saccade following lets the head follow the eyes. The stop counts
everywhere and leads back to normal.
"""

from __future__ import annotations

import enum
from collections.abc import Mapping
from dataclasses import dataclass


class Mode(enum.Enum):
    """What the robot is up to."""

    NORMAL = "normal"
    DEMO = "demo"
    TRACKING = "tracking"
    SACCADE = "saccade"


class InputKind(enum.Enum):
    """What an input is about; a row of the table."""

    STOP = "stop"
    JOINTS = "joint controls"
    EMOTION = "emotion"
    EYES = "eye position"
    ANIMATION = "animations"
    PERSONALITY = "personality"
    MODE = "mode"
    POSE = "gaze and pose"
    FACE = "face"


class Operator(enum.Enum):
    """Whose input it is: the wizard's (keys, palette, panel, script) or other software's."""

    WIZARD = "wizard"
    PROGRAM = "program"


#: Sources of commands that are other software's; every other one is the wizard's hand.
_PROGRAMS = frozenset({"program", "engagement"})


def operator_of(source: str) -> Operator:
    """Whose hand a command came from that names this source (`drivers.contract.Job.source`)."""
    return Operator.PROGRAM if source in _PROGRAMS else Operator.WIZARD


_ALL = frozenset(Mode)
_NORMAL = frozenset({Mode.NORMAL})
_FACE = frozenset({Mode.NORMAL, Mode.SACCADE})


@dataclass(frozen=True, slots=True)
class ModeRule:
    """An input and the modes in which it counts."""

    modes: frozenset[Mode]
    note: str = ""


MODE_RULES: Mapping[InputKind, ModeRule] = {
    InputKind.STOP: ModeRule(_ALL, "ends what moves and leads back to normal"),
    InputKind.JOINTS: ModeRule(_NORMAL, "the wizard's are kept for the way back to normal"),
    InputKind.POSE: ModeRule(_NORMAL),
    InputKind.EMOTION: ModeRule(_FACE),
    InputKind.EYES: ModeRule(_FACE, "in saccade following the eyes lead the head"),
    InputKind.FACE: ModeRule(_FACE),
    InputKind.ANIMATION: ModeRule(_NORMAL),
    InputKind.PERSONALITY: ModeRule(_NORMAL),
    InputKind.MODE: ModeRule(_NORMAL),
}

#: Modes in which the body breathes and blinks by itself.
BREATHES = frozenset({Mode.NORMAL, Mode.SACCADE})
BLINKS = frozenset({Mode.NORMAL, Mode.SACCADE, Mode.TRACKING})


def is_accepted(kind: InputKind, mode: Mode) -> bool:
    """Whether an input of this kind counts in this mode."""
    return mode in MODE_RULES[kind].modes
