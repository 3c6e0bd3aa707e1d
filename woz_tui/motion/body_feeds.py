"""What bodies hand to servos, faces and back, through feeds (`drivers.feeds`)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from woz_tui.motion.light_frames import LightFrame

#: Topics of a body's feeds, and of those it reads.
SETPOINTS, FACE, STATE = "setpoints", "face", "state"
PRESENT, SEEN, VOICE = "present", "seen", "voice"


@dataclass(frozen=True, slots=True)
class Setpoints:
    """Feed `setpoints` of a body: where each joint shall be now, in degrees, with the joint's
    `zero` added. `t_us` is CLOCK_MONOTONIC in microseconds. `zeros` are what was added, so that
    servos can say in the body's own degrees where their joints are. `at_rest`: whether the body has
    reached the pose in which it may be left alone; None as long as nobody sends it there.
    """

    t_us: int
    joints: Mapping[str, float]
    zeros: Mapping[str, float] = field(default_factory=dict)
    at_rest: bool | None = None


@dataclass(frozen=True, slots=True)
class JointPositions:
    """Feed `present` of servos: where each joint is, in degrees; only joints that answer.

    `held` are those whose torque is on; `unable` those that cannot move, each with why, and what to
    do about it.
    """

    t_us: int
    joints: Mapping[str, float]
    held: frozenset[str] = frozenset()
    unable: Mapping[str, tuple[str, str]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Sighting:
    """Feed `seen` of a camera: the middle of what it looks for, from -1 (left edge, top) to 1
    (right edge, bottom), and its share of the picture's area, 0..1. None: nothing is seen.
    `frame` counts pictures.
    """

    t_us: int
    frame: int
    x: float | None
    y: float | None
    size: float = 0.0


@dataclass(frozen=True, slots=True)
class VoiceLevels:
    """Feed `voice` of a driver that speaks: how loud what began at `t_us` (CLOCK_MONOTONIC, in
    microseconds) is, each `every` seconds, from 0 to 1, which is where it is loudest. Nothing is
    said behind their end; empty: nothing is said now.
    """

    t_us: int = 0
    every: float = 1.0
    levels: tuple[float, ...] = ()

    def at(self, now: float) -> float:
        """How loud it is at `now`, in seconds of CLOCK_MONOTONIC."""
        place = math.floor((now - self.t_us / 1e6) / self.every)
        return self.levels[place] if 0 <= place < len(self.levels) else 0.0


@dataclass(frozen=True, slots=True)
class FacePicture:
    """Feed `face` of a body: the frame that shall be shown, and how bright, 0..1."""

    frame: LightFrame
    brightness: float


@dataclass(frozen=True, slots=True)
class BodyState:
    """Feed `state` of a body: what a control panel must know to agree with it.

    `controls` are the places, 0..1, at which each control of the body stands now; `move` is the
    move being played, or empty.
    """

    controls: Mapping[str, float]
    mode: str
    emotion: str
    move: str
    personality: str
