"""From what a face expresses to the picture on its lights: one pure function.

The same picture goes to the device and to the console, so both are bit for bit the same.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, fields, replace
from functools import lru_cache

from woz_tui.motion.body_shape import FaceShape
from woz_tui.motion.body_verbs import EMOTIONS
from woz_tui.motion.emotions import NEUTRAL
from woz_tui.motion.light_frames import LightFrame

# -- glyphs ---------------------------------------------------------------------------------------
# Letters of five rows for faces that have something to say.

HEIGHT = 5

#: Only what is said: `ERROR!` and `RESETTING....`; rows from the top, # is lit.
GLYPHS: Mapping[str, str] = {
    "E": "### #.. ##. #.. ###",
    "R": "##. #.# ##. #.# #.#",
    "O": "### #.# #.# #.# ###",
    "S": "### #.. ### ..# ###",
    "T": "### .#. .#. .#. .#.",
    "I": "# # # # #",
    "N": "#..# ##.# #.## #..# #..#",
    "G": "#### #... #.## #..# ####",
    "!": "# # # . #",
    ".": ". . . . #",
    " ": ".. .. .. .. ..",
}


def text_lights(text: str, *, scale: int = 1) -> frozenset[tuple[int, int]]:
    """The lights of a text, from (0, 0); letters that are not in `GLYPHS` are left blank."""
    lights: set[tuple[int, int]] = set()
    left = 0
    for letter in text:
        rows = GLYPHS.get(letter, GLYPHS[" "]).split()
        lights |= {
            (left + column, row)
            for row, line in enumerate(rows)
            for column, light in enumerate(line)
            if light == "#"
        }
        left += len(rows[0]) + 1
    return frozenset(
        (x * scale + across, y * scale + down)
        for x, y in lights
        for across in range(scale)
        for down in range(scale)
    )


def width_of(text: str, *, scale: int = 1) -> int:
    """How many columns `text_lights` takes, with the blank one after the last letter."""
    columns = (len(GLYPHS.get(letter, GLYPHS[" "]).split()[0]) + 1 for letter in text)
    return sum(columns) * scale


# -- eyes -----------------------------------------------------------------------------------------
# Two eyes drawn with lights: where they are on a matrix, and what an emotion makes of them.
#
# An eye is a disc. Lids cut it, a cheek pushes into it from below, a hole or a spark darkens a
# part of it, a brow stands above: all of it numbers in one table, in units of the eye's radius, so
# a face looks the same on any matrix. Inside an eye `u` points away from the nose and `v` down.

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
class EyeShape:
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

    def towards(self, other: EyeShape, share: float) -> EyeShape:
        """The look `share` (0..1) of the way to `other`; brows grow where they will be."""
        mine = {field.name: getattr(self, field.name) for field in fields(self)}
        between = EyeShape(
            **{name: value + (getattr(other, name) - value) * share for name, value in mine.items()}
        )
        return replace(between, brow_height=other.brow_height, brow_slant=other.brow_slant)


OPEN = EyeShape()

EYE_SHAPES: Mapping[str, EyeShape] = {
    "neutral": OPEN,
    "sleepy": EyeShape(lid=0.6, bulge=0.75, wide=1.25, drop=0.33),
    "angry": EyeShape(lid=-0.2, slant=-0.75, brow=1.0, brow_height=-1.1, brow_slant=-0.75),
    "sad": EyeShape(lid=-0.3, slant=0.6, drop=0.33, brow=1.0, brow_height=-1.2, brow_slant=0.5),
    "happy": EyeShape(cheek=-0.35, tall=1.1, wide=1.25),
    "amazed": EyeShape(wide=1.4, tall=1.4, hole=0.55, brow=0.7, brow_height=-2.0),
    "friendly": EyeShape(wide=1.1, tall=1.35, spark=0.45, smile=0.9),
}


@dataclass(frozen=True, slots=True)
class EyeLayout:
    """Where the eyes are: columns of their middles (left one first, as seen from the front), row
    of both, radius. Whatever a file says, an open eye lies inside the matrix and beside the other.
    """

    width: int
    height: int
    columns: tuple[float, float]
    row: float
    radius: float


@lru_cache(maxsize=32)
def eye_layout(shape: FaceShape) -> EyeLayout:
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
    return EyeLayout(shape.width, shape.height, (left, right), row, min(shape.eye_radius, room))


# -- drawing ------------------------------------------------------------------------------------

#: Whether a point of an eye, `u` and `v` in radii, is lit.
Test = Callable[[float, float], bool]


def pair(place: EyeLayout, test: Test) -> Lights:
    """Both eyes' lights: the same on both sides of the nose."""
    left, right = place.columns
    return _lights(place, left, -1, test) | _lights(place, right, 1, test)


def _lights(place: EyeLayout, column: float, out: int, test: Test) -> Lights:
    """One eye's; `out` is the direction away from the nose. Nothing beyond the nose or matrix."""
    nose = sum(place.columns) / 2
    return frozenset(
        (x, y)
        for x, y in _lights_within_reach(place, column)
        if (x - nose) * out > 0
        and test((x - column) * out / place.radius, (y - place.row) / place.radius)
    )


@lru_cache(maxsize=64)
def _lights_within_reach(place: EyeLayout, column: float) -> tuple[Light, ...]:
    """The matrix's lights to which an eye in this column may reach with its brow."""
    reach = math.ceil(_FARTHEST * place.radius)
    across = range(max(0, int(column) - reach), min(place.width, int(column) + reach + 2))
    down = range(max(0, int(place.row) - reach), min(place.height, int(place.row) + reach + 2))
    return tuple((x, y) for x in across for y in down)


def draw_eyes(place: EyeLayout, look: EyeShape) -> Lights:
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


def _sparks(place: EyeLayout, look: EyeShape) -> Lights:
    """Reflected light falls from one side, so it is not mirrored."""
    if look.spark <= 0:
        return frozenset()
    reach = look.spark * place.radius
    return frozenset(
        (x, y)
        for column in place.columns
        for x, y in _lights_within_reach(place, column)
        if math.hypot(x - column + 0.4 * place.radius, y - place.row + 0.5 * place.radius) <= reach
    )


def draw_brows(place: EyeLayout, look: EyeShape) -> Lights:
    """Both brows; a brow is one light thick for each three of the eye's radius, at least one."""
    if look.brow < _SHORTEST_BROW:
        return frozenset()
    half = max(1.0, place.radius / 3) / place.radius / 2

    def lit(u: float, v: float) -> bool:
        above = v - look.brow_height - look.brow_slant * u
        return abs(u) <= look.brow + 1e-9 and -half <= above < half

    return pair(place, lit)


def draw_mouth(place: EyeLayout, look: EyeShape) -> Lights:
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


def open_mouth(place: EyeLayout, opening: float) -> Lights:
    """A mouth that speaks, `opening` (0 to 1) wide: as high as that, at least one light."""
    if not opening > 0:
        return frozenset()
    nose, low = sum(place.columns) / 2, place.row + 2.2 * place.radius
    across, down = 0.8 * place.radius, max(0.5, 0.7 * place.radius * min(1.0, opening))
    return frozenset(
        (x, y)
        for x in range(place.width)
        for y in range(place.height)
        if ((x - nose) / (across + _ROUND)) ** 2 + ((y - low) / down) ** 2 <= 1
    )


def frame_of(place: EyeLayout, lights: Iterable[Light]) -> LightFrame:
    """The picture of these lights; those outside the matrix are left out."""
    rows = [0] * place.height
    for x, y in lights:
        if 0 <= x < place.width and 0 <= y < place.height:
            rows[y] |= 1 << (place.width - 1 - x)
    return LightFrame(place.width, tuple(rows))


# -- crash ----------------------------------------------------------------------------------------
# A face that breaks down: a film in scenes, a pure function of the seconds since it began.
#
# Noise, blinking crosses, eyes that lose each other, an error, a game to pass the time, a restart.
# Chance is a fixed sequence, so that every robot, every picture on the console and every replay
# breaks down in the same way.

#: Pictures of noise a second, crosses and errors that light up a second.
_NOISE_HZ, _CROSS_HZ, _ERROR_HZ = 12, 2, 2
#: Turns a second of the wandering eyes.
_WANDER_HZ = 0.75
#: How far they wander, in radii of an eye.
_WANDER_REACH = 0.9
#: Columns that the last line of text moves on in a second.
_SCROLL_HZ = 24
_ERROR, _RESETTING = "ERROR!", "RESETTING...."


def cross(place: EyeLayout) -> Lights:
    """Two crosses where the eyes are, as large as they."""
    half = max(1.0, place.radius / 3) / place.radius / 2

    def lit(u: float, v: float) -> bool:
        near = abs(abs(u) - abs(v)) < 2 * half if place.radius > 1 else abs(u) == abs(v)
        return near and max(abs(u), abs(v)) <= 1.0

    return pair(place, lit)


def crash_film(place: EyeLayout, seconds: float) -> Lights:
    """The lights at a moment; before the beginning as at it, dark from `CRASH_S` on."""
    left = max(0.0, seconds) if math.isfinite(seconds) else 0.0
    for length, scene in SCENES:
        if left < length:
            return scene(place, left)
        left -= length
    return frozenset()


def _noise(place: EyeLayout, seconds: float) -> Lights:
    return _noisy(place, int(seconds * _NOISE_HZ))


@lru_cache(maxsize=64)
def _noisy(place: EyeLayout, number: int) -> Lights:
    """Half of the lights, others in each picture; the first ones leave some of the eyes."""
    chance = random.Random(number)
    everywhere = [(x, y) for x in range(place.width) for y in range(place.height)]
    share = min(0.5, 0.1 * (number + 1))
    return draw_eyes(place, OPEN) ^ frozenset(
        light for light in everywhere if chance.random() < share
    )


def _crosses(place: EyeLayout, seconds: float) -> Lights:
    return cross(place) if seconds * _CROSS_HZ % 1 < 0.6 else frozenset()


def _wander(place: EyeLayout, seconds: float) -> Lights:
    """Each eye goes its own way round, as after too many turns."""
    angle = seconds * _WANDER_HZ * math.tau
    room = min(_WANDER_REACH * place.radius, *_room(place))
    across, down = round(room * math.sin(angle)), round(room * (1 - math.cos(angle)) / 2)
    nose = sum(place.columns) / 2
    return frozenset(
        (x + across, y + down) if x < nose else (x - across, y - down)
        for x, y in draw_eyes(place, OPEN)
    )


def _room(place: EyeLayout) -> tuple[float, float, float]:
    """Lights between the eyes and the edges: sideways, above and below."""
    radius = math.ceil(place.radius)
    left, right = place.columns
    side = min(left, place.width - 1 - right, (right - left - 1) / 2)
    return (
        max(0.0, side - radius),
        max(0.0, place.row - radius),
        max(0.0, place.height - 1 - place.row - radius),
    )


def _error(place: EyeLayout, seconds: float) -> Lights:
    """`ERROR!`, blinking, if it fits; else it passes by."""
    scale = max(1, min(place.width // width_of(_ERROR), place.height // HEIGHT))
    if width_of(_ERROR, scale=scale) > place.width + 1:
        return _passing(place, _ERROR, seconds / ERROR_S)
    left = (place.width + 1 - width_of(_ERROR, scale=scale)) // 2
    return _text(place, _ERROR, left, scale) if seconds * _ERROR_HZ % 1 < 0.75 else frozenset()


def _pong(place: EyeLayout, seconds: float) -> Lights:
    """Two bats and a ball; at the end the right one misses it."""
    right, low = place.width - 1, place.height - 1
    ball_x = _bouncing(seconds * place.width * 0.8 + place.width / 2, right)
    ball_y = _bouncing(seconds * place.height * 0.9, low)
    half = place.height // 8
    missed = seconds > PONG_S - 0.6
    left_bat = min(low - half, max(half, ball_y))
    right_bat = half if missed else left_bat
    bats = frozenset(
        (column, middle + step)
        for column, middle in ((0, left_bat), (right, right_bat))
        for step in range(-half, half + 1)
    )
    return bats | {(ball_x, ball_y)}


def _bouncing(way: float, last: int) -> int:
    """Where something is that runs to and fro between 0 and `last`, after `way` lights."""
    folded = way % (2 * last)
    return round(min(folded, 2 * last - folded))


def _resetting(place: EyeLayout, seconds: float) -> Lights:
    return _passing(place, _RESETTING, seconds / RESETTING_S)


def _passing(place: EyeLayout, text: str, share: float) -> Lights:
    """A text that comes in at the right and goes out at the left, `share` of its way."""
    scale = max(1, min(2, (place.height - 2) // HEIGHT))
    way = place.width + width_of(text, scale=scale)
    return _text(place, text, place.width - round(share * way), scale)


def _text(place: EyeLayout, text: str, left: int, scale: int) -> Lights:
    top = (place.height - HEIGHT * scale) // 2
    return frozenset(
        (x + left, y + top)
        for x, y in text_lights(text, scale=scale)
        if 0 <= x + left < place.width
    )


ERROR_S, PONG_S = 2.0, 2.5
RESETTING_S = (24 + width_of(_RESETTING, scale=2)) / _SCROLL_HZ

#: The film: how long each scene is, in seconds, and what draws it.
SCENES: tuple[tuple[float, Callable[[EyeLayout, float], Lights]], ...] = (
    (1.0, _noise),
    (1.5, _crosses),
    (2.0, _wander),
    (ERROR_S, _error),
    (PONG_S, _pong),
    (RESETTING_S, _resetting),
)
#: How long it is, in seconds.
CRASH_S = sum(length for length, _ in SCENES)


# --------------------------------------------------------------------------------------------------

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
        mouth: 0 (closed, not drawn) to 1 (wide open).
    """

    x: float = 0.0
    y: float = 0.0
    emotion: str = NEUTRAL
    intensity: float = 0.0
    lid: float = 1.0
    crash: float | None = None
    mouth: float = 0.0


def draw(state: FaceState, shape: FaceShape) -> LightFrame:
    """The picture of a state. Values out of range are clamped, NaN is the value at rest."""
    place = eye_layout(shape)
    if state.crash is not None and not state.crash >= CRASH_S:
        return frame_of(place, crash_film(place, state.crash))
    step = round(_within(state.intensity, 0.0, 1.0) * STEPS)
    eyes, rest = _grown(place, state.emotion)[step]
    closing = squeezed(eyes, _within(state.lid, 0.0, 1.0, 1.0))
    across, down = _gaze(place, eyes | rest, state)
    mouth = open_mouth(place, _within(state.mouth, 0.0, 1.0))
    return frame_of(place, ((x + across, y + down) for x, y in closing | rest | mouth))


def prepare(shape: FaceShape) -> None:
    """Work out every emotion's pictures now, so that no later `draw` takes longer than others."""
    for emotion in EMOTIONS:
        _grown(eye_layout(shape), emotion)


def _within(value: float, low: float, high: float, otherwise: float = 0.0) -> float:
    return otherwise if math.isnan(value) else min(high, max(low, value))


# -- emotions -----------------------------------------------------------------------------------

#: Lights of the eyes (what a lid closes), and of the rest: brows, mouth.
Parts = tuple[Lights, Lights]


@lru_cache(maxsize=64)
def _grown(place: EyeLayout, emotion: str) -> tuple[Parts, ...]:
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


def _parts(place: EyeLayout, emotion: str, share: float) -> Parts:
    """What the table says of an emotion that is `share` (0..1) strong, inside the matrix."""
    if emotion == "crash":
        eyes, rest = (cross(place) if share >= 0.5 else draw_eyes(place, OPEN)), frozenset[Light]()
    else:
        look = OPEN.towards(EYE_SHAPES.get(emotion, OPEN), share)
        eyes, rest = draw_eyes(place, look), draw_brows(place, look) | draw_mouth(place, look)
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


def _gaze(place: EyeLayout, lights: Lights, state: FaceState) -> Light:
    """By how many columns and rows the face moves; none of it leaves the matrix."""
    if not lights:
        return 0, 0
    columns, rows = [x for x, _ in lights], [y for _, y in lights]
    return (
        _moved(
            _within(state.x, -1.0, 1.0),
            REACH[0] * place.radius,
            min(columns),
            place.width - 1 - max(columns),
        ),
        _moved(
            _within(-state.y, -1.0, 1.0),
            REACH[1] * place.radius,
            min(rows),
            place.height - 1 - max(rows),
        ),
    )


def _moved(share: float, reach: float, before: int, after: int) -> int:
    """Whole lights, so that the eyes keep their form on their way."""
    return round(share * min(reach, before if share < 0 else after))
