"""Pictures of the simulated robot's camera: a wall, a floor, and the visitor if one is there."""

from __future__ import annotations

import math
from dataclasses import dataclass

from woz_drivers.pictures.live_pictures import LivePictures
from woz_tui.drivers.contract import DriverContext

#: Pixels of a picture, and degrees that it shows from left to right.
WIDTH, HEIGHT, VIEW = 96, 72, 60.0
#: Metres: the camera's height above the floor, a person's, half a head's width, half a body's.
_EYE, _TALL, _HEAD, _BODY = 1.4, 1.75, 0.10, 0.24
#: Where the wall meets the floor, as a row.
_SKIRTING = 54
_WALL, _FLOOR, _SKIN, _COAT, _DARK = (
    (186, 178, 160),
    (104, 84, 66),
    (222, 176, 146),
    (58, 92, 150),
    (40, 34, 32),
)

Colour = tuple[int, int, int]


@dataclass(frozen=True, slots=True)
class DrawnPerson:
    """Somebody `distance` metres away, `side` degrees to the left."""

    distance: float
    side: float
    looking: bool
    talking: bool


class SimulatedCamera:
    """Gives pictures while somebody watches, as a camera does."""

    def __init__(self, context: DriverContext) -> None:
        self._live = LivePictures(context)

    def show(self, person: DrawnPerson | None) -> None:
        """Give a picture, if one is wanted now."""
        if self._live.due() is not None:
            self._live.offer(WIDTH, HEIGHT, scene_picture(person))


def scene_picture(person: DrawnPerson | None) -> bytes:
    """`HEIGHT` rows of `WIDTH` pixels, three bytes each."""
    rows = [_room(y) for y in range(HEIGHT)]
    if person is not None:
        _draw(rows, person)
    return b"".join(rows)


def _room(y: int) -> bytearray:
    """A row of the empty room: lit from the left."""
    ground = _WALL if y < _SKIRTING else _FLOOR
    return bytearray(
        channel * (400 - x) // 400 for x in range(0, 2 * WIDTH, 2) for channel in ground
    )


def _draw(rows: list[bytearray], person: DrawnPerson) -> None:
    metre = WIDTH / (2 * math.tan(math.radians(VIEW / 2)) * max(0.3, person.distance))
    across = (
        WIDTH / 2 * (1 - math.tan(math.radians(person.side)) / math.tan(math.radians(VIEW / 2)))
    )
    crown = HEIGHT / 2 - (_TALL - _EYE) * metre
    head, body = _HEAD * metre, _BODY * metre
    face = crown + 1.3 * head
    _ellipse(rows, (across, face + 1.4 * head + 2.2 * body), (body, 2.3 * body), _COAT)
    _ellipse(rows, (across, face), (head, 1.3 * head), _SKIN)
    _ellipse(rows, (across, crown + 0.4 * head), (0.95 * head, 0.5 * head), _DARK)
    if person.looking:
        for eye in (-0.4, 0.4):
            _ellipse(rows, (across + eye * head, face), (0.16 * head, 0.16 * head), _DARK)
    if person.talking:
        _ellipse(rows, (across, face + 0.7 * head), (0.35 * head, 0.22 * head), _DARK)


def _ellipse(
    rows: list[bytearray], middle: tuple[float, float], half: tuple[float, float], colour: Colour
) -> None:
    """Fill what of an ellipse is inside the picture."""
    for y in range(max(0, math.ceil(middle[1] - half[1])), HEIGHT):
        off = (y - middle[1]) / half[1]
        if off >= 1:
            return
        wide = half[0] * math.sqrt(max(0.0, 1 - off * off))
        begin = max(0, round(middle[0] - wide))
        end = min(WIDTH, round(middle[0] + wide) + 1)
        if begin < end:
            rows[y][3 * begin : 3 * end] = bytes(colour) * (end - begin)
