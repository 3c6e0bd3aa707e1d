"""What the camera sees: a room, and the visitor in it, drawn with numpy."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from naoqi_simulator.visitor import HALF_ACROSS, HALF_UPRIGHT, SimulatedPerson

Picture = NDArray[np.uint8]

_WALL, _FLOOR, _DOOR, _LINE = (168, 176, 184), (112, 96, 84), (140, 110, 80), (150, 158, 166)
_SKIN, _SHIRT, _DARK = (224, 172, 136), (52, 96, 168), (40, 30, 30)
#: Metres: half a face, and where its middle is above the camera.
_FACE_M, _ABOVE_M = 0.11, 0.25


def draw(
    width: int, height: int, person: SimulatedPerson | None, yaw: float, pitch: float
) -> Picture:
    """RGB of `height` x `width` x 3, seen with the head turned (rad, left) and lowered (rad)."""
    x = np.linspace(HALF_ACROSS, -HALF_ACROSS, width)[None, :] + yaw
    y = np.linspace(HALF_UPRIGHT, -HALF_UPRIGHT, height)[:, None] - pitch
    picture = np.empty((height, width, 3), np.uint8)
    picture[:] = _WALL
    picture[np.broadcast_to(y < -0.25, (height, width))] = _FLOOR
    picture[(abs(x - 0.7) < 0.12) & (y > -0.25) & (y < 0.45)] = _DOOR
    # A grid on the wall, so that a turn of the head is seen.
    picture[np.broadcast_to((np.mod(x, 0.2) < 0.006) & (y >= -0.25), (height, width))] = (
        150,
        158,
        166,
    )
    if person is not None:
        _person(picture, x, y, person)
    return picture


def _person(
    picture: Picture, x: NDArray[np.float64], y: NDArray[np.float64], who: SimulatedPerson
) -> None:
    face = math.atan2(_FACE_M, who.distance)
    up = math.atan2(_ABOVE_M, who.distance)
    across, upright = (x - who.angle) / face, (y - up) / face
    picture[(abs(across) < 1.9) & (upright < -1.3) & (upright > -9)] = _SHIRT
    picture[across**2 + (upright / 1.3) ** 2 < 1] = _SKIN
    if who.looking:
        for side in (-0.4, 0.4):
            picture[(across - side) ** 2 + (upright - 0.25) ** 2 < 0.03] = _DARK
    opened = 0.18 if who.talking else 0.05
    picture[(across / 0.4) ** 2 + ((upright + 0.6) / opened) ** 2 < 1] = _DARK
