"""What a move is: a length, and what it wants at each moment of it.

A move does not know when it began or how fast it is played; the engine counts. So a speed changed
half-way changes the pace and not the place, and a late tick is late but never slow.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol


@dataclass(frozen=True, slots=True)
class FaceChange:
    """What a move wants of the face; None leaves a thing as it is.

    `x` and `y` are where the eyes look, -1 (the robot's right, down) to 1 (its left, up); `lid` is
    how far they are open, 0..1.
    """

    emotion: str | None = None
    intensity: float | None = None
    x: float | None = None
    y: float | None = None
    lid: float | None = None


@dataclass(frozen=True, slots=True)
class Posture:
    """What a move wants at one moment, in degrees.

    `roles` (pan, nod, lean, roll) and `joints` are added to the pose held when the move began, at
    the amplitude it is played with; `places` take the place of that pose.
    """

    roles: Mapping[str, float] = field(default_factory=dict)
    joints: Mapping[str, float] = field(default_factory=dict)
    places: Mapping[str, float] = field(default_factory=dict)
    face: FaceChange | None = None


@dataclass(frozen=True, slots=True)
class SoundCue:
    """Something that happens once, at a moment of a move: a `sound` file to be heard."""

    at: float
    sound: str = ""
    volume: float = 1.0


class Move(Protocol):
    """A movement that can be played; frozen, and the same for everybody who plays it."""

    @property
    def name(self) -> str:
        """What `play` calls it by."""
        ...

    @property
    def summary(self) -> str:
        """What it looks like, in a few words."""
        ...

    @property
    def length(self) -> float:
        """How long it is: seconds, or beats of the personality's tempo; more than 0."""
        ...

    @property
    def beats(self) -> bool:
        """Whether `length` counts beats."""
        ...

    @property
    def stays(self) -> bool:
        """Whether the last posture is held afterwards; else the pose from before is."""
        ...

    def at(self, place: float) -> Posture:
        """What it wants at `place`, from 0 to `length`."""
        ...

    @property
    def cues(self) -> tuple[SoundCue, ...]:
        """What happens on the way, in order; `at` counts as `length` does."""
        ...


#: At so many places of a move its stroke is looked for.
_PLACES = 480
#: A move is there where it has come this share of its way, as in Oosterkamp's program.
_NEARLY = 0.99
#: A move that goes less far than this has no stroke, in degrees.
_LEAST = 1.0


def stroke_of(move: Move) -> float | None:
    """Where the meaning of a gesture lies: the place at which the move is for the first time as far
    from its beginning as it goes; None if it hardly moves, or cannot be asked.
    """
    places = [move.length * number / _PLACES for number in range(_PLACES + 1)]
    try:
        angles = [_angles(move.at(place)) for place in places]
    except Exception:  # noqa: BLE001 - a stranger's move; playing it says what is wrong
        return None
    reach = [
        math.hypot(*(angle - angles[0].get(name, 0.0) for name, angle in each.items()))
        for each in angles
    ]
    farthest = max(reach)
    if not _LEAST < farthest < math.inf:
        return None
    return next(at for at, far in zip(places, reach, strict=True) if far > _NEARLY * farthest)


def _angles(posture: Posture) -> dict[str, float]:
    return {
        f"{kind} {name}": angle
        for kind in ("roles", "joints", "places")
        for name, angle in getattr(posture, kind).items()
    }
