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


class Kind(enum.Enum):
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


class Hand(enum.Enum):
    """Whose input it is: the wizard's (keys, palette, panel, script) or other software's."""

    WIZARD = "wizard"
    PROGRAM = "program"


#: Sources of commands that are other software's; every other one is the wizard's hand.
_PROGRAMS = frozenset({"program", "engagement"})


def hand_of(source: str) -> Hand:
    """Whose hand a command came from that names this source (`core.driver.Job.source`)."""
    return Hand.PROGRAM if source in _PROGRAMS else Hand.WIZARD


_ALL = frozenset(Mode)
_NORMAL = frozenset({Mode.NORMAL})
_FACE = frozenset({Mode.NORMAL, Mode.SACCADE})


@dataclass(frozen=True, slots=True)
class Row:
    """An input and the modes in which it counts, for the wizard and for programs."""

    wizard: frozenset[Mode]
    program: frozenset[Mode]
    note: str = ""


TABLE: Mapping[Kind, Row] = {
    Kind.STOP: Row(_ALL, _ALL, "ends what moves and leads back to normal"),
    Kind.JOINTS: Row(_NORMAL, _NORMAL, "the wizard's are kept for the way back to normal"),
    Kind.POSE: Row(_NORMAL, _NORMAL),
    Kind.EMOTION: Row(_FACE, _FACE),
    Kind.EYES: Row(_FACE, _FACE, "in saccade following the eyes lead the head"),
    Kind.FACE: Row(_FACE, _FACE),
    Kind.ANIMATION: Row(_NORMAL, _NORMAL),
    Kind.PERSONALITY: Row(_NORMAL, _NORMAL),
    Kind.MODE: Row(_NORMAL, _NORMAL),
}

#: Modes in which the body breathes and blinks by itself.
BREATHES = frozenset({Mode.NORMAL, Mode.SACCADE})
BLINKS = frozenset({Mode.NORMAL, Mode.SACCADE, Mode.TRACKING})


def counts(kind: Kind, mode: Mode, hand: Hand) -> bool:
    """Whether an input of this kind from this hand counts in this mode."""
    row = TABLE[kind]
    return mode in (row.wizard if hand is Hand.WIZARD else row.program)
