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

from woz_tui.motion.easing import Path, along, swell
from woz_tui.motion.move import FaceChange, Move, Posture, SoundCue

# -- demo -----------------------------------------------------------------------------------------
# The demo: in 66 seconds everything the robot can show, by itself.
#
# Scenes and their times are those of Oosterkamp's robot: it falls asleep, wakes, dances, is sad, is
# angry, is amazed. Each scene is a row of the table at the end: a face, paths of the roles in
# degrees, and swings over them, all relative to the pose held before. A negative lean brings the
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
    intensity: Path = ((0, 1),)
    #: Roles and parts of the face (`x`, `y`, `lid`) by name; times count from the demo's start.
    roles: dict[str, Path] = field(default_factory=dict)
    face: dict[str, Path] = field(default_factory=dict)
    swings: tuple[Swing, ...] = ()


#: Every role is at rest where one ends.
DEMO_SCENES = (
    # It nods off, starts up once more, and sinks down.
    DemoScene(
        0,
        "falls asleep",
        "sleepy",
        intensity=((0, 0), (2, 0.7), (5, 1)),
        roles={
            "nod": ((0, 0), (1.8, 10), (2.3, 2), (5, 20)),
            "lean": ((0, 0), (1.8, -10), (2.3, -6), (5, -34)),
            "roll": ((2.3, 0), (5, 8)),
        },
        face={"lid": ((0, 1), (1.8, 0.3), (2.2, 0.9), (3, 0.7), (5, 0))},
    ),
    DemoScene(
        5,
        "sleeps",
        "sleepy",
        roles={"nod": ((5, 20),), "lean": ((5, -34),), "roll": ((5, 8),)},
        face={"lid": ((5, 0),)},
        swings=(
            Swing("lean", 5, 10, (3, 3), (0.4, 0.4)),
            Swing("nod", 5, 10, (-2, -2), (0.4, 0.4)),
        ),
    ),
    DemoScene(
        10,
        "wakes",
        "sleepy",
        intensity=((10.5, 1), (13, 0)),
        roles={
            "nod": ((10, 20), (11.2, 12), (11.6, 14), (13, 0)),
            "lean": ((10, -34), (11.2, -26), (11.6, -28), (13, 0)),
            "roll": ((10, 8), (12.5, 0)),
        },
        face={"lid": ((10, 0), (11, 0.5), (11.3, 0.2), (12, 0.8), (12.3, 0.4), (13, 1))},
    ),
    DemoScene(
        13,
        "looks round",
        "neutral",
        intensity=((13, 0),),
        roles={
            "pan": ((13, 0), (14.2, 40), (15.2, 40), (17, -40), (18, -40), (19, 0)),
            "nod": ((13, 0), (14.2, -6), (15.2, -6), (16.1, 2), (17, -6), (18, -6), (19, 0)),
        },
        face={
            "x": (
                (13, 0),
                (13.4, 0.8),
                (14.2, 0),
                (15.2, 0),
                (15.7, -0.8),
                (17, 0),
                (18, 0),
                (18.3, 0.5),
                (19, 0),
            ),
            "lid": ((16, 1), (16.15, 0), (16.3, 1)),
        },
    ),
    # Tempo and size rise together; no role gets faster than 220 degrees a second.
    DemoScene(
        19,
        "dances",
        "happy",
        intensity=((19, 0), (20, 0.6), (24, 1)),
        swings=(
            Swing("pan", 19, 26, (12, 36), (0.65, 1.05)),
            Swing("lean", 19, 26, (4, 9.6), (1.3, 2.1)),
            Swing("nod", 19, 26, (8, 19), (1.3, 2.1), turn=0.25),
        ),
    ),
    DemoScene(26, "calms down", "happy", intensity=((26, 1), (27, 0))),
    DemoScene(
        27,
        "shakes its head and drops it",
        "sad",
        intensity=((27, 0), (30, 0.8), (33, 1)),
        roles={
            "nod": ((27, 0), (30, 8), (33, 22)),
            "lean": ((27, 0), (33, -12)),
            "roll": ((30, 0), (33, 6)),
        },
        face={"y": ((27, 0), (33, -0.7)), "lid": ((27, 1), (33, 0.8))},
        swings=(Swing("pan", 27, 32, (16, 9), (0.75, 0.45)),),
    ),
    DemoScene(
        33,
        "looks round sadly",
        "sad",
        roles={
            "pan": ((33, 0), (36.5, 32), (38.5, 32), (43, -30), (45, -30), (47, 0)),
            "nod": ((33, 22), (36.5, 14), (38.5, 14), (40.5, 22), (43, 16), (45, 16), (47, 22)),
            "lean": ((33, -12),),
            "roll": ((33, 6), (36.5, -4), (38.5, -4), (43, 8), (47, 6)),
        },
        face={
            "x": ((33, 0), (34.5, 0.5), (36.5, 0), (38.5, 0), (40, -0.5), (43, 0), (45, 0)),
            "y": ((33, -0.7), (37, -0.2), (40, -0.7), (43, -0.3), (46, -0.7)),
            "lid": (
                (33, 0.8),
                (37.5, 0.8),
                (37.75, 0),
                (38, 0.8),
                (44, 0.8),
                (44.25, 0),
                (44.5, 0.8),
            ),
        },
    ),
    # From sad to angry: it draws itself up first.
    DemoScene(
        47,
        "gathers itself",
        "sad",
        intensity=((47, 1), (50.5, 0)),
        roles={
            "nod": ((47, 22), (49, 24), (51, 0)),
            "lean": ((47, -12), (49, -14), (51, 4)),
            "roll": ((47, 6), (50, 0)),
        },
        face={"y": ((47, -0.7), (50, 0)), "lid": ((47, 0.8), (48.2, 0.3), (49, 0.8), (50.5, 1))},
    ),
    DemoScene(
        51,
        "leans forward angrily",
        "angry",
        intensity=((51, 0), (52.5, 0.8), (54, 1)),
        roles={"lean": ((51, 4), (54, -30)), "nod": ((51, 0), (54, -8))},
    ),
    DemoScene(
        54,
        "shakes its head angrily",
        "angry",
        roles={"lean": ((54, -30), (58, -36)), "nod": ((54, -8),)},
        swings=(Swing("pan", 54, 58, (14, 20), (1.6, 2)),),
    ),
    DemoScene(
        58,
        "looks round angrily",
        "angry",
        intensity=((63, 1), (64, 0)),
        roles={
            "pan": ((58, 0), (58.8, 42), (59.8, 42), (60.9, -42), (61.9, -42), (63, 0)),
            "nod": ((58, -8), (58.8, 2), (59.8, 2), (60.9, 2), (61.9, 2), (63, -8), (64, 0)),
            "lean": ((58, -36), (62, -30), (64, 0)),
        },
        face={"x": ((58, 0), (58.3, 0.7), (58.8, 0), (59.8, 0), (60.2, -0.7), (60.9, 0))},
    ),
    DemoScene(
        64,
        "starts back, comes forward, amazed",
        "amazed",
        intensity=((64, 0), (64.3, 1), (65.4, 1), (66, 0)),
        roles={
            "lean": ((64, 0), (64.35, 10), (65, -20), (65.3, -20), (66, 0)),
            "nod": ((64, 0), (64.35, -8), (65, -5), (65.3, -5), (66, 0)),
        },
    ),
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


def _paths(name: str, summary: str, **roles: Path) -> Formula:
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
