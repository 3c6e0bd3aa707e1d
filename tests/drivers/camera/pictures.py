"""Pictures with something green in them, and a pipe that is a camera."""

from __future__ import annotations

import numpy as np
from woz_drivers.camera.raw_pictures import Picture

from tests.fakes.piped_command import PipedCommand

GREEN = (20, 200, 30)


def picture(width: int = 20, height: int = 15, grey: int = 90) -> Picture:
    """Nothing but grey."""
    return np.full((height, width, 3), grey, np.uint8)


def with_block(x: int, y: int, size: int = 1, width: int = 20, height: int = 15) -> Picture:
    """A green square whose upper left pixel is (x, y)."""
    made = picture(width, height)
    made[y : y + size, x : x + size] = GREEN
    return made


def planes(made: Picture, stride: int) -> bytes:
    """A picture of even size as yuv420 (BT.601, limited range), rows padded with noise."""
    red, green, blue = made.astype(float).transpose(2, 0, 1)
    y = 16 + 0.257 * red + 0.504 * green + 0.098 * blue
    u = 128 - 0.148 * red - 0.291 * green + 0.439 * blue
    v = 128 + 0.439 * red - 0.368 * green - 0.071 * blue
    padded = []
    for plane, row in ((y, stride), (u[::2, ::2], stride // 2), (v[::2, ::2], stride // 2)):
        rows = np.full((plane.shape[0], row), 77, np.uint8)
        rows[:, : plane.shape[1]] = np.rint(plane)
        padded.append(rows.tobytes())
    return b"".join(padded)


class PipedCamera(PipedCommand):
    """A pipe that is a camera."""

    def send(self, *pictures: Picture | bytes) -> None:
        """Deliver pictures, or pieces of them."""
        super().send(b"".join(bytes(one) for one in pictures))
