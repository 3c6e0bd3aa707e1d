"""A face that breaks down: a film in scenes, a pure function of the seconds since it began.

Noise, blinking crosses, eyes that lose each other, an error, a game to pass the time, a restart.
Chance is a fixed sequence, so that every robot, every picture on the console and every replay
breaks down in the same way.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from functools import lru_cache

from woz_tui.motion.eyes import OPEN, Layout, Lights, eye, pair
from woz_tui.motion.glyphs import HEIGHT, width_of, written

#: Pictures of noise a second, crosses and errors that light up a second.
_NOISE_HZ, _CROSS_HZ, _ERROR_HZ = 12, 2, 2
#: Turns a second of the wandering eyes.
_WANDER_HZ = 0.75
#: How far they wander, in radii of an eye.
_WANDER_REACH = 0.9
#: Columns that the last line of text moves on in a second.
_SCROLL_HZ = 24
_ERROR, _RESETTING = "ERROR!", "RESETTING...."


def cross(place: Layout) -> Lights:
    """Two crosses where the eyes are, as large as they."""
    half = max(1.0, place.radius / 3) / place.radius / 2

    def lit(u: float, v: float) -> bool:
        near = abs(abs(u) - abs(v)) < 2 * half if place.radius > 1 else abs(u) == abs(v)
        return near and max(abs(u), abs(v)) <= 1.0

    return pair(place, lit)


def film(place: Layout, seconds: float) -> Lights:
    """The lights at a moment; before the beginning as at it, dark from `CRASH_S` on."""
    left = max(0.0, seconds) if math.isfinite(seconds) else 0.0
    for length, scene in SCENES:
        if left < length:
            return scene(place, left)
        left -= length
    return frozenset()


def _noise(place: Layout, seconds: float) -> Lights:
    return _noisy(place, int(seconds * _NOISE_HZ))


@lru_cache(maxsize=64)
def _noisy(place: Layout, number: int) -> Lights:
    """Half of the lights, others in each picture; the first ones leave some of the eyes."""
    chance = random.Random(number)
    everywhere = [(x, y) for x in range(place.width) for y in range(place.height)]
    share = min(0.5, 0.1 * (number + 1))
    return eye(place, OPEN) ^ frozenset(light for light in everywhere if chance.random() < share)


def _crosses(place: Layout, seconds: float) -> Lights:
    return cross(place) if seconds * _CROSS_HZ % 1 < 0.6 else frozenset()


def _wander(place: Layout, seconds: float) -> Lights:
    """Each eye goes its own way round, as after too many turns."""
    angle = seconds * _WANDER_HZ * math.tau
    room = min(_WANDER_REACH * place.radius, *_room(place))
    across, down = round(room * math.sin(angle)), round(room * (1 - math.cos(angle)) / 2)
    nose = sum(place.columns) / 2
    return frozenset(
        (x + across, y + down) if x < nose else (x - across, y - down) for x, y in eye(place, OPEN)
    )


def _room(place: Layout) -> tuple[float, float, float]:
    """Lights between the eyes and the edges: sideways, above and below."""
    radius = math.ceil(place.radius)
    left, right = place.columns
    side = min(left, place.width - 1 - right, (right - left - 1) / 2)
    return (
        max(0.0, side - radius),
        max(0.0, place.row - radius),
        max(0.0, place.height - 1 - place.row - radius),
    )


def _error(place: Layout, seconds: float) -> Lights:
    """`ERROR!`, blinking, if it fits; else it passes by."""
    scale = max(1, min(place.width // width_of(_ERROR), place.height // HEIGHT))
    if width_of(_ERROR, scale=scale) > place.width + 1:
        return _passing(place, _ERROR, seconds / ERROR_S)
    left = (place.width + 1 - width_of(_ERROR, scale=scale)) // 2
    return _text(place, _ERROR, left, scale) if seconds * _ERROR_HZ % 1 < 0.75 else frozenset()


def _pong(place: Layout, seconds: float) -> Lights:
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


def _resetting(place: Layout, seconds: float) -> Lights:
    return _passing(place, _RESETTING, seconds / RESETTING_S)


def _passing(place: Layout, text: str, share: float) -> Lights:
    """A text that comes in at the right and goes out at the left, `share` of its way."""
    scale = max(1, min(2, (place.height - 2) // HEIGHT))
    way = place.width + width_of(text, scale=scale)
    return _text(place, text, place.width - round(share * way), scale)


def _text(place: Layout, text: str, left: int, scale: int) -> Lights:
    top = (place.height - HEIGHT * scale) // 2
    return frozenset(
        (x + left, y + top) for x, y in written(text, scale=scale) if 0 <= x + left < place.width
    )


ERROR_S, PONG_S = 2.0, 2.5
RESETTING_S = (24 + width_of(_RESETTING, scale=2)) / _SCROLL_HZ

#: The film: how long each scene is, in seconds, and what draws it.
SCENES: tuple[tuple[float, Callable[[Layout, float], Lights]], ...] = (
    (1.0, _noise),
    (1.5, _crosses),
    (2.0, _wander),
    (ERROR_S, _error),
    (PONG_S, _pong),
    (RESETTING_S, _resetting),
)
#: How long it is, in seconds.
CRASH_S = sum(length for length, _ in SCENES)
