"""Colours of pictures as a terminal has them: 16 million, 256 or 16, or signs of ASCII."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

from rich.color import Color
from rich.style import Style

#: Signs by their brightness on a dark ground, the darkest first.
RAMP = " .:-=+*#%@"
#: The sixteen colours as xterm has them; every terminal has its own idea of them.
_SIXTEEN = (
    (0, 0, 0),
    (205, 0, 0),
    (0, 205, 0),
    (205, 205, 0),
    (0, 0, 238),
    (205, 0, 205),
    (0, 205, 205),
    (229, 229, 229),
    (127, 127, 127),
    (255, 0, 0),
    (0, 255, 0),
    (255, 255, 0),
    (92, 92, 255),
    (255, 0, 255),
    (0, 255, 255),
    (255, 255, 255),
)
#: Steps of a channel in the cube of the 256 colours.
_CUBE = (0, 95, 135, 175, 215, 255)

#: Red, green, blue -> the number by which a cell's colour is known, and whether it has changed.
Number = Callable[[int, int, int], int]


def of_24_bits(red: int, green: int, blue: int) -> int:
    """32 steps a channel: of neighbours nearly alike more are alike, and cost less."""
    return (red & 0xF8) << 16 | (green & 0xF8) << 8 | blue & 0xF8


def of_256(red: int, green: int, blue: int) -> int:
    """The nearest of xterm's 240 fixed colours, for 16 steps a channel."""
    return _nearest_256(red >> 4, green >> 4, blue >> 4)


def of_16(red: int, green: int, blue: int) -> int:
    """The nearest of the sixteen."""
    return _nearest_16(red >> 4, green >> 4, blue >> 4)


def brightness(red: int, green: int, blue: int) -> int:
    """Of ITU-R BT.601, 0 to 255."""
    return (77 * red + 150 * green + 29 * blue) >> 8


@lru_cache(4096)
def _nearest_256(red: int, green: int, blue: int) -> int:
    wanted = (red * 17, green * 17, blue * 17)
    steps = [min(range(6), key=lambda n, c=c: abs(_CUBE[n] - c)) for c in wanted]  # type: ignore[misc]
    cube = 16 + 36 * steps[0] + 6 * steps[1] + steps[2]
    step = min(23, max(0, round((sum(wanted) / 3 - 8) / 10)))
    grey = 8 + 10 * step
    in_cube = _distance(wanted, (_CUBE[steps[0]], _CUBE[steps[1]], _CUBE[steps[2]]))
    return cube if in_cube <= _distance(wanted, (grey, grey, grey)) else 232 + step


@lru_cache(4096)
def _nearest_16(red: int, green: int, blue: int) -> int:
    wanted = (red * 17, green * 17, blue * 17)
    return min(range(16), key=lambda number: _distance(wanted, _SIXTEEN[number]))


def _distance(one: tuple[int, int, int], other: tuple[int, int, int]) -> int:
    """Green counts most and blue least, as eyes see them."""
    red, green, blue = (a - b for a, b in zip(one, other, strict=True))
    return 3 * red * red + 6 * green * green + blue * blue


def rgb_of(number: int, colours: int) -> tuple[int, int, int]:
    """Red, green and blue of a number, for terminals of so many colours."""
    if colours > 256:
        return number >> 16 & 255, number >> 8 & 255, number & 255
    if number < 16:
        return _SIXTEEN[number]
    if number >= 232:
        grey = 8 + 10 * (number - 232)
        return grey, grey, grey
    number -= 16
    return _CUBE[number // 36], _CUBE[number // 6 % 6], _CUBE[number % 6]


@lru_cache(4_096)
def style(upper: int, lower: int, colours: int) -> Style:
    """A half block's colours; of a blank where both are the same."""
    if upper == lower:
        return Style.from_color(None, _colour(lower, colours))
    return Style.from_color(_colour(upper, colours), _colour(lower, colours))


@lru_cache(4_096)
def _colour(number: int, colours: int) -> Color:
    return Color.from_rgb(*rgb_of(number, colours)) if colours > 256 else Color.from_ansi(number)
