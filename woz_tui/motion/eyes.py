"""Two eyes drawn with lights: where they are on a matrix, and what an emotion makes of them.

An eye is a disc. Lids cut it, a cheek pushes into it from below, a hole or a spark darkens a part
of it, a brow stands above: all of it numbers in one table, in units of the eye's radius, so a face
looks the same on any matrix. Inside an eye `u` points away from the nose and `v` down.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, fields, replace
from functools import lru_cache

from woz_tui.motion.frames import Frame
from woz_tui.motion.shapes import FaceShape

#: A light: column and row, from 0 at the upper left.
Light = tuple[int, int]
Lights = frozenset[Light]

#: A disc of radius 3 has its lights up to 3.2 from the middle: round, without single lights at
#: its four ends.
_ROUND = 0.2
#: Nothing of an eye or its brow is farther from its middle, in radii.
_FARTHEST = 3.0
#: A brow that is shorter on either side would be a single light; in radii.
_SHORTEST_BROW = 0.33


@dataclass(frozen=True, slots=True)
class Look:
    """How an emotion at its strongest shapes an eye; lengths in radii of the open eye.

    Attributes:
        wide: Half the eye's width.
        tall: Half the eye's height.
        drop: How far its middle is lowered.
        lid: Height of the upper lid's edge at the eye's middle; lights above are out. -1 is the
            top of the open eye, 1 its bottom.
        slant: How much lower that edge is, a radius further out.
        bulge: How much higher that edge is, a radius from the middle: lashes that hang.
        cheek: Height of the top of the cheek, a disc as large as the eye.
        hole: Radius of a dark middle.
        spark: Radius of a reflected light, dark, up to the left in both eyes.
        brow: Half the brow's length.
        brow_height: Height of the brow's middle.
        brow_slant: How much lower it is, a radius further out.
        smile: Half the width of a mouth between and below the eyes.
    """

    wide: float = 1.0
    tall: float = 1.0
    drop: float = 0.0
    lid: float = -1.4
    slant: float = 0.0
    bulge: float = 0.0
    cheek: float = 1.4
    hole: float = 0.0
    spark: float = 0.0
    brow: float = 0.0
    brow_height: float = -1.67
    brow_slant: float = 0.0
    smile: float = 0.0

    def towards(self, other: Look, share: float) -> Look:
        """The look `share` (0..1) of the way to `other`; brows grow where they will be."""
        mine = {field.name: getattr(self, field.name) for field in fields(self)}
        between = Look(
            **{name: value + (getattr(other, name) - value) * share for name, value in mine.items()}
        )
        return replace(between, brow_height=other.brow_height, brow_slant=other.brow_slant)


OPEN = Look()

LOOKS: Mapping[str, Look] = {
    "neutral": OPEN,
    "sleepy": Look(lid=0.6, bulge=0.75, wide=1.25, drop=0.33),
    "angry": Look(lid=-0.2, slant=-0.75, brow=1.0, brow_height=-1.1, brow_slant=-0.75),
    "sad": Look(lid=-0.3, slant=0.6, drop=0.33, brow=1.0, brow_height=-1.2, brow_slant=0.5),
    "happy": Look(cheek=-0.35, tall=1.1, wide=1.25),
    "amazed": Look(wide=1.4, tall=1.4, hole=0.55, brow=0.7, brow_height=-2.0),
    "friendly": Look(wide=1.1, tall=1.35, spark=0.45, smile=0.9),
}


@dataclass(frozen=True, slots=True)
class Layout:
    """Where the eyes are: columns of their middles (left one first, as seen from the front), row
    of both, radius. Whatever a file says, an open eye lies inside the matrix and beside the other.
    """

    width: int
    height: int
    columns: tuple[float, float]
    row: float
    radius: float


@lru_cache(maxsize=32)
def layout(shape: FaceShape) -> Layout:
    """The eyes' places on this matrix."""
    right_edge, lower_edge = shape.width - 1.0, shape.height - 1.0
    quarter = shape.width / 4
    given = shape.eyes or (quarter, right_edge - quarter)
    left, right = sorted(_within(column, 1.0, right_edge - 1.0) for column in given)
    if right - left < 3.0:
        left, right = quarter, right_edge - quarter
    half = (shape.height - 2) / 2
    row = _within(half if shape.eye_row is None else shape.eye_row, 1.0, lower_edge - 1.0)
    room = min(left, right_edge - right, (right - left - 1) / 2, row, lower_edge - row)
    return Layout(shape.width, shape.height, (left, right), row, min(shape.eye_radius, room))


def _within(value: float, low: float, high: float) -> float:
    return min(high, max(low, value))


# -- drawing ------------------------------------------------------------------------------------

#: Whether a point of an eye, `u` and `v` in radii, is lit.
Test = Callable[[float, float], bool]


def pair(place: Layout, test: Test) -> Lights:
    """Both eyes' lights: the same on both sides of the nose."""
    left, right = place.columns
    return _lights(place, left, -1, test) | _lights(place, right, 1, test)


def _lights(place: Layout, column: float, out: int, test: Test) -> Lights:
    """One eye's; `out` is the direction away from the nose. Nothing beyond the nose or matrix."""
    nose = sum(place.columns) / 2
    return frozenset(
        (x, y)
        for x, y in _around(place, column)
        if (x - nose) * out > 0
        and test((x - column) * out / place.radius, (y - place.row) / place.radius)
    )


@lru_cache(maxsize=64)
def _around(place: Layout, column: float) -> tuple[Light, ...]:
    """The matrix's lights to which an eye in this column may reach with its brow."""
    reach = math.ceil(_FARTHEST * place.radius)
    across = range(max(0, int(column) - reach), min(place.width, int(column) + reach + 2))
    down = range(max(0, int(place.row) - reach), min(place.height, int(place.row) + reach + 2))
    return tuple((x, y) for x in across for y in down)


def eye(place: Layout, look: Look) -> Lights:
    """Both eyes without brows."""
    rim = 1 + _ROUND / place.radius
    wide, tall = look.wide - 1 + rim, look.tall - 1 + rim

    def lit(u: float, v: float) -> bool:
        v -= look.drop
        return (
            (u / wide) ** 2 + (v / tall) ** 2 <= 1
            and v >= look.lid + look.slant * u - look.bulge * u * u
            and math.hypot(u / look.wide, v - look.cheek - 1) > 1
            and not (look.hole and math.hypot(u, v) < look.hole)
        )

    return pair(place, lit) - _sparks(place, look)


def _sparks(place: Layout, look: Look) -> Lights:
    """Reflected light falls from one side, so it is not mirrored."""
    if look.spark <= 0:
        return frozenset()
    reach = look.spark * place.radius
    return frozenset(
        (x, y)
        for column in place.columns
        for x, y in _around(place, column)
        if math.hypot(x - column + 0.4 * place.radius, y - place.row + 0.5 * place.radius) <= reach
    )


def brows(place: Layout, look: Look) -> Lights:
    """Both brows; a brow is one light thick for each three of the eye's radius, at least one."""
    if look.brow < _SHORTEST_BROW:
        return frozenset()
    half = max(1.0, place.radius / 3) / place.radius / 2

    def lit(u: float, v: float) -> bool:
        above = v - look.brow_height - look.brow_slant * u
        return abs(u) <= look.brow + 1e-9 and -half <= above < half

    return pair(place, lit)


def mouth(place: Layout, look: Look) -> Lights:
    """A smile: an arc whose ends are higher than its middle."""
    if look.smile <= 0:
        return frozenset()
    nose = sum(place.columns) / 2
    reach, low = look.smile * place.radius, place.row + 2.2 * place.radius
    return frozenset(
        (x, round(low - 0.4 * place.radius * ((x - nose) / reach) ** 2))
        for x in range(place.width)
        if abs(x - nose) <= reach
    )


def frame_of(place: Layout, lights: Iterable[Light]) -> Frame:
    """The picture of these lights; those outside the matrix are left out."""
    rows = [0] * place.height
    for x, y in lights:
        if 0 <= x < place.width and 0 <= y < place.height:
            rows[y] |= 1 << (place.width - 1 - x)
    return Frame(place.width, tuple(rows))
