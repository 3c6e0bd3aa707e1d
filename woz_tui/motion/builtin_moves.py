"""Moves that every body knows: written in roles, so they fit any number of joints.

Nod, shake, dance and pointing are those of Oosterkamp's toolkit as its published program plays
them: sines of the phase `phi`, which is one turn a beat, with `A` of 12 degrees. Each begins and
ends at the pose held before, standing still, because a swell lies over its swings; between the
swell's ramps it is the formula itself. At the default tempo of 2.13 Hz and amplitude 1 the fastest
joint needs 290 degrees a second.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import msgspec

from woz_tui.motion.easing import TimedValues, along, swell
from woz_tui.motion.move_types import FaceChange, Move, Posture, SoundCue

# -- demo -----------------------------------------------------------------------------------------
# The demo: in 66 seconds everything the robot can show, by itself.
#
# Scenes and their times are those of Oosterkamp's robot: it falls asleep, wakes, dances, is sad, is
# angry, is amazed. `demo.json` has each scene: a face, paths of the roles in degrees (pairs of time
# and angle), and swings over them, all relative to the pose held before. A negative lean brings the
# head forward.


@dataclass(frozen=True, slots=True)
class Swing:
    """A role that goes to and fro, from `start` to `end` (seconds of the demo).

    Amplitude (degrees) and pace (Hz) change evenly from their first to their second value;
    `turn` is where in the turn it begins (0.25: a cosine). It swells and fades within a second.
    """

    role: str
    start: float
    end: float
    amplitude: tuple[float, float]
    pace: tuple[float, float]
    turn: float = 0.0

    def at(self, time: float) -> float:
        """Degrees; 0 before and after."""
        if not self.start < time < self.end:
            return 0.0
        spent, length = time - self.start, self.end - self.start
        size, growth = self.amplitude[0], self.amplitude[1] - self.amplitude[0]
        pace, haste = self.pace[0], self.pace[1] - self.pace[0]
        turns = self.turn + spent * (pace + haste * spent / length / 2)
        fade = swell(spent, length, min(1.0, length / 2))
        return fade * (size + growth * spent / length) * math.sin(math.tau * turns)


@dataclass(frozen=True, slots=True)
class DemoScene:
    """A part of the demo, until the next one begins."""

    start: float
    title: str
    emotion: str
    intensity: TimedValues = ((0, 1),)
    #: Roles and parts of the face (`x`, `y`, `lid`) by name; times count from the demo's start.
    roles: dict[str, TimedValues] = field(default_factory=dict)
    face: dict[str, TimedValues] = field(default_factory=dict)
    swings: tuple[Swing, ...] = ()


#: In order; every role is at rest where a scene ends. In the dance tempo and size rise together,
#: and no role gets faster than 220 degrees a second.
DEMO_SCENES = msgspec.json.decode(
    Path(__file__).with_name("demo.json").read_bytes(), type=tuple[DemoScene, ...]
)


def _demo(place: float) -> Posture:
    scene = next(scene for scene in reversed(DEMO_SCENES) if place >= scene.start)
    roles = {role: along(path, place) for role, path in scene.roles.items()}
    for swing in scene.swings:
        roles[swing.role] = roles.get(swing.role, 0.0) + swing.at(place)
    features = {name: along(path, place) for name, path in scene.face.items()}
    face = FaceChange(
        emotion=scene.emotion,
        intensity=along(scene.intensity, place),
        x=features.get("x", 0.0),
        y=features.get("y", 0.0),
        lid=features.get("lid", 1.0),
    )
    return Posture(roles=roles, face=face)


# --------------------------------------------------------------------------------------------------

#: Amplitude of animations, in degrees: pi/15.
A = 12.0

#: Half a beat to get going in moves that people do in passing, two for the dance.
_BRIEF, _LONG = 0.5, 2.0


@dataclass(frozen=True, slots=True)
class Formula:
    """A move that is computed; `form` gets a place inside the length."""

    name: str
    summary: str
    length: float
    form: Callable[[float], Posture]
    beats: bool = True
    stays: bool = False
    cues: tuple[SoundCue, ...] = ()

    def at(self, place: float) -> Posture:
        """What it wants at `place`; before the beginning and after the end as there."""
        return self.form(min(self.length, max(0.0, place)))


def _sin(beats: float) -> float:
    return math.sin(math.tau * beats)


def _swing(name: str, summary: str, role: str, length: float) -> Formula:
    """One role, `A` to both sides, once a beat."""

    def form(place: float) -> Posture:
        return Posture(roles={role: A * swell(place, length, _BRIEF) * _sin(place)})

    return Formula(name, summary, length, form)


_DANCE_BEATS = 16.0


def _dance(place: float) -> Posture:
    size = A * swell(place, _DANCE_BEATS, _LONG)
    return Posture(
        roles={
            "pan": 3 * size * _sin(place / 2),
            "lean": 0.8 * size * _sin(place),
            "nod": 1.8 * size * math.cos(math.tau * place),
        }
    )


#: Pointing, in beats: out, three nods of a quarter of a beat, a moment there, back.
_OUT, _NODS, _THERE = 1.5, 0.75, 0.25


def _point(name: str, summary: str, side: float) -> Formula:
    """Stretches towards something and nods at it; `side` is 1 for the robot's left."""
    length = 2 * _OUT + _NODS + _THERE

    def form(place: float) -> Posture:
        out = swell(place, length, _OUT)
        nodding = place - _OUT
        nods = 0.3 * A * swell(nodding, _NODS, _NODS / 6) * _sin(4 * nodding)
        return Posture(
            roles={"pan": 4.5 * A * side * out, "lean": -3 * A * out, "nod": -A * out + nods}
        )

    return Formula(name, summary, length, form)


def _paths(name: str, summary: str, **roles: TimedValues) -> Formula:
    length = max(path[-1][0] for path in roles.values())

    def form(place: float) -> Posture:
        return Posture(roles={role: along(path, place) for role, path in roles.items()})

    return Formula(name, summary, length, form)


_MOVES = (
    _swing("nod", "yes: nods three times", "nod", 3.0),
    _swing("shake", "no: turns the head to both sides three times", "pan", 3.0),
    Formula("dance", "sways and bobs for four bars", _DANCE_BEATS, _dance),
    _point("point-left", "points to its left, nods there, comes back", 1.0),
    _point("point-middle", "points straight ahead, nods there, comes back", 0.0),
    _point("point-right", "points to its right, nods there, comes back", -1.0),
    _paths(
        "look-around",
        "looks to its left, to its right and back",
        pan=((0, 0), (2, 40), (4, 40), (7, -40), (9, -40), (11, 0)),
        nod=((0, 0), (2, -4), (4, -4), (5.5, 3), (7, -4), (9, -4), (11, 0)),
    ),
    _paths(
        "bow",
        "lowers the head, waits, and raises it again",
        nod=((0, 0), (2, 24), (3.5, 24), (6, 0)),
        lean=((0, 0), (2.25, -20), (3.5, -20), (6, 0)),
    ),
    _paths(
        "tilt",
        "curious: cocks the head to one side",
        roll=((0, 0), (1.25, 15), (4, 15), (5.5, 0)),
        pan=((0, 0), (1.5, 9), (4, 9), (5.5, 0)),
        nod=((0, 0), (1.25, -5), (4, -5), (5.5, 0)),
    ),
)

DEMO = Formula(
    "demo",
    "everything it can, in 66 seconds: asleep, happy, sad, angry, amazed",
    66.0,
    _demo,
    beats=False,
)

#: Every move that needs no file, by name.
BUILT_IN: Mapping[str, Move] = {**{move.name: move for move in _MOVES}, DEMO.name: DEMO}
