"""From what a face expresses to the picture on its lights: one pure function.

The same picture goes to the device and to the console, so both are bit for bit the same.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

from woz_tui.motion.crash import CRASH_S, cross, film
from woz_tui.motion.emotions import NEUTRAL
from woz_tui.motion.eyes import (
    LOOKS,
    OPEN,
    Layout,
    Light,
    Lights,
    brows,
    eye,
    frame_of,
    layout,
    mouth,
)
from woz_tui.motion.frames import Frame
from woz_tui.motion.inputs import EMOTIONS
from woz_tui.motion.shapes import FaceShape

__all__ = ["CRASH_S", "FaceState", "draw", "prepare"]

#: An emotion grows in this many steps from neutral to its strongest.
STEPS = 20
#: How far the eyes go from their places, in radii, where there is room: sideways, up and down.
REACH = (1.5, 1.0)


@dataclass(frozen=True, slots=True)
class FaceState:
    """What a face expresses.

    Attributes:
        x: Where the eyes look, -1 (the robot's right, the left of the picture) to 1.
        y: -1 (down) to 1 (up).
        emotion: One of `inputs.EMOTIONS`; anything else looks neutral.
        intensity: 0 (neutral) to 1.
        lid: 0 (closed: a line) to 1 (as open as the emotion has it).
        crash: Seconds since a breakdown began; from `CRASH_S` on it is over. None: there is none.
    """

    x: float = 0.0
    y: float = 0.0
    emotion: str = NEUTRAL
    intensity: float = 0.0
    lid: float = 1.0
    crash: float | None = None


def draw(state: FaceState, shape: FaceShape) -> Frame:
    """The picture of a state. Values out of range are clamped, NaN is the value at rest."""
    place = layout(shape)
    if state.crash is not None and not state.crash >= CRASH_S:
        return frame_of(place, film(place, state.crash))
    step = round(_within(state.intensity, 0.0, 1.0, 0.0) * STEPS)
    eyes, rest = _grown(place, state.emotion)[step]
    closing = squeezed(eyes, _within(state.lid, 0.0, 1.0, 1.0))
    across, down = _gaze(place, eyes | rest, state)
    return frame_of(place, ((x + across, y + down) for x, y in closing | rest))


def prepare(shape: FaceShape) -> None:
    """Work out every emotion's pictures now, so that no later `draw` takes longer than others."""
    for emotion in EMOTIONS:
        _grown(layout(shape), emotion)


def _within(value: float, low: float, high: float, otherwise: float) -> float:
    return otherwise if math.isnan(value) else min(high, max(low, value))


# -- emotions -----------------------------------------------------------------------------------

#: Lights of the eyes (what a lid closes), and of the rest: brows, mouth.
Parts = tuple[Lights, Lights]


@lru_cache(maxsize=64)
def _grown(place: Layout, emotion: str) -> tuple[Parts, ...]:
    """An emotion's pictures from neutral to its strongest, `STEPS + 1` of them.

    Each light changes once at most on the way: a stronger emotion is never nearer to neutral.
    """
    stages = [_parts(place, emotion, step / STEPS) for step in range(STEPS + 1)]
    last_eyes, last_rest = stages[-1]
    eyes, rest = stages[0]
    grown = []
    for stage_eyes, stage_rest in stages:
        eyes = _settled(eyes, stage_eyes, last_eyes)
        rest = _settled(rest, stage_rest, last_rest)
        grown.append((eyes, rest - eyes))
    return tuple(grown)


def _settled(now: Lights, stage: Lights, last: Lights) -> Lights:
    """`now` with the lights that are at this stage as they will be in the end."""
    return (now | (stage & last)) - ((now - stage) - last)


def _parts(place: Layout, emotion: str, share: float) -> Parts:
    """What the table says of an emotion that is `share` (0..1) strong, inside the matrix."""
    if emotion == "crash":
        eyes, rest = (cross(place) if share >= 0.5 else eye(place, OPEN)), frozenset[Light]()
    else:
        look = OPEN.towards(LOOKS.get(emotion, OPEN), share)
        eyes, rest = eye(place, look), brows(place, look) | mouth(place, look)
    inside = frozenset((x, y) for x in range(place.width) for y in range(place.height))
    return eyes & inside, rest & inside


# -- lids and gaze ------------------------------------------------------------------------------


def squeezed(eyes: Lights, lid: float) -> Lights:
    """The eyes closed to a share `lid` of their height; 0 leaves a line as wide as they are."""
    if lid >= 1 or not eyes:
        return eyes
    rows = [y for _, y in eyes]
    middle = round((min(rows) + max(rows)) / 2)
    return frozenset((x, middle + round((y - middle) * lid)) for x, y in eyes)


def _gaze(place: Layout, lights: Lights, state: FaceState) -> Light:
    """By how many columns and rows the face moves; none of it leaves the matrix."""
    if not lights:
        return 0, 0
    columns, rows = [x for x, _ in lights], [y for _, y in lights]
    return (
        _moved(
            _within(state.x, -1.0, 1.0, 0.0),
            REACH[0] * place.radius,
            min(columns),
            place.width - 1 - max(columns),
        ),
        _moved(
            _within(-state.y, -1.0, 1.0, 0.0),
            REACH[1] * place.radius,
            min(rows),
            place.height - 1 - max(rows),
        ),
    )


def _moved(share: float, reach: float, before: int, after: int) -> int:
    """Whole lights, so that the eyes keep their form on their way."""
    return round(share * min(reach, before if share < 0 else after))
