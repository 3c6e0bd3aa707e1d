"""Pictures as ALVideoDevice gives them (doc.aldebaran.com, "naoqi/vision/alvideodevice")."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from woz_drivers.pepper.link import Said, binary
from woz_drivers.pepper.memory import item, number, within

#: kRGBColorSpace and kBGRColorSpace: three bytes a pixel.
RGB, _BGR = 11, 13
#: Widths in pixels with ALVideoDevice's numbers for them: kQQQVGA, kQQVGA, kQVGA, kVGA, k4VGA.
RESOLUTIONS = ((80, 7), (160, 0), (320, 1), (640, 2), (1280, 3))
VGA = 2
#: No camera of a robot gives more pixels than this in one direction.
_LARGEST = 8192


def resolution(width: int) -> int:
    """The number of the smallest pictures that are at least `width` wide, or of the largest."""
    return next((code for wide, code in RESOLUTIONS if wide >= width), RESOLUTIONS[-1][1])


@dataclass(frozen=True, slots=True)
class Frame:
    """`rgb` as in `core.pictures`; `robot_s`: when the robot took it, by its own clock (Unix)."""

    width: int
    height: int
    rgb: bytes
    robot_s: float | None


def frame(said: Any) -> Frame | str:
    """A picture, or why it is none.

    `[width, height, layers, colour space, s, us, bytes, ...]`; None while the camera has none.
    """
    if said is None or said in ([], ()):
        return "the camera gives no picture"
    width, height = (within(item(said, place), 1, _LARGEST) for place in (0, 1))
    if width is None or height is None:
        return "the camera's picture has no size"
    wide, high = int(width), int(height)
    space = item(said, 3)
    if item(said, 2) != 3 or space not in (RGB, _BGR):
        which = number(space)
        return (
            f"the camera's picture is of an unknown kind{'' if which is None else f' ({which:g})'}"
        )
    try:
        pixels = binary(item(said, 6))
    except (Said, UnicodeEncodeError):
        return "the camera's picture holds no pixels"
    if len(pixels) != 3 * wide * high:
        return f"the camera's picture is broken: {len(pixels)} bytes for {wide} x {high}"
    return Frame(wide, high, _red_first(pixels, space), _taken(item(said, 4), item(said, 5)))


def _red_first(pixels: bytes, space: int) -> bytes:
    if space == RGB:
        return pixels
    turned = bytearray(pixels)
    turned[0::3], turned[2::3] = pixels[2::3], pixels[0::3]
    return bytes(turned)


def _taken(seconds: Any, micros: Any) -> float | None:
    whole, part = number(seconds), within(micros, 0, 1_000_000)
    return None if whole is None or part is None else whole + part / 1_000_000
