"""What looking at a picture costs, as a share of one core at 32 pictures a second.

    python benchmarks/blob.py [--pictures 2000] [--quick]

From the bytes to the place of the green thing, as the camera driver does it: a picture with one
green ball, one with nothing, and one of pure noise, the worst there is. Time is CPU time of this
thread, so other programs do not count.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

import numpy as np
from woz_drivers.camera.blob import BlobFinder
from woz_drivers.camera.settings import CameraSettings

from benchmarks.figures import Spread, machine, table, verdict

#: Pictures a second, and the share of a core that 20 x 15 may cost.
RATE, GOAL = 32, 0.05
#: Pictures timed together: CPU clocks are coarse.
_BATCH = 20
SIZES = (
    CameraSettings(command="-", width=20, height=15, format="rgb24"),
    CameraSettings(command="-", width=160, height=120, format="rgb24"),
    CameraSettings(command="-", width=320, height=240, format="rgb24"),
    CameraSettings(width=320, height=240),
)


def ball(settings: CameraSettings) -> bytes:
    """A green disc on grey."""
    y, x = np.mgrid[: settings.height, : settings.width]
    disc = np.hypot(x - settings.width / 3, y - settings.height / 2) < settings.height / 5
    if settings.format == "yuv420":
        half = disc[::2, ::2]
        planes = (np.where(disc, 130, 90), np.where(half, 80, 128), np.where(half, 50, 128))
        return b"".join(plane.astype(np.uint8).tobytes() for plane in planes)
    made = np.full((settings.height, settings.width, 3), 90, np.uint8)
    made[disc] = (20, 200, 30)
    return made.tobytes()


def nothing(settings: CameraSettings) -> bytes:
    """One grey."""
    return bytes([120]) * settings.layout.size


def noise(settings: CameraSettings) -> bytes:
    """Every byte by chance."""
    return np.random.default_rng(1).bytes(settings.layout.size)


def looked(settings: CameraSettings, data: bytes, pictures: int) -> list[float]:
    """Microseconds a picture."""
    finder, layout = BlobFinder(settings.rule), settings.layout
    took = []
    for _ in range(max(1, pictures // _BATCH)):
        begun = time.thread_time_ns()
        for _ in range(_BATCH):
            finder.find(layout.decode(data))
        took.append((time.thread_time_ns() - begun) / 1000 / _BATCH)
    return took


SCENES: tuple[tuple[str, Callable[[CameraSettings], bytes]], ...] = (
    ("a ball", ball),
    ("nothing", nothing),
    ("noise", noise),
)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pictures", type=int, default=2000)
    parser.add_argument("--quick", action="store_true", help="few pictures: does it run at all?")
    options = parser.parse_args()
    pictures = 60 if options.quick else options.pictures
    rows, small = [], 0.0
    for settings in SIZES:
        for name, made in SCENES:
            spread = Spread.of(looked(settings, made(settings), pictures))
            share = spread.p50 * RATE / 1e6
            if settings.width == 20 and name == "a ball":
                small = share
            rows.append(
                [
                    f"{settings.shape}, {name}",
                    f"{spread.p50:.0f}",
                    f"{spread.p99:.0f}",
                    f"{share:.2%}",
                ]
            )
    print(machine())
    table(
        f"from bytes to a place, and the share of one core at {RATE} pictures a second",
        ["picture", "us p50", "us p99", "of a core"],
        rows,
    )
    print(f"\n20 x 15 in less than {GOAL:.0%} of a core: {verdict(small, GOAL)}")


if __name__ == "__main__":
    main()
