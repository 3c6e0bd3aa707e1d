"""The camera of another driver of the same robot, such as a Pepper's: raw pictures of one size."""

from __future__ import annotations

import asyncio

import numpy as np

from woz_drivers.programs.byte_stream import StreamListener
from woz_tui.drivers.contract import DriverContext, DriverError
from woz_tui.protocol.camera_pictures import PICTURE, WATCHED, CameraWatched, Picture
from woz_tui.system.tasks import end_tasks

#: How often is looked for a new picture, and for how long the camera is asked for more, in seconds.
_LOOK_S, _WATCHES_S = 0.02, 2.0
#: Without a new picture for so long it is told of, and then given up for lost, in seconds.
_STALE_S, _LOST_S = 1.0, 5.0


class FeedCamera:
    """Fetches the pictures of `driver` between `start` and `close`, as RGB of `size`."""

    def __init__(
        self,
        driver: str,
        size: tuple[int, int],
        rate: float,
        context: DriverContext,
        listener: StreamListener,
    ) -> None:
        self._driver = driver
        self._size = size
        self._rate = rate
        self._clock = context.clock
        self._pictures = context.feed(PICTURE, of=driver)
        self._watched = context.feed(WATCHED, of=driver)
        self._listener = listener
        self._task: asyncio.Task[None] | None = None

    def start(self) -> None:
        """Begin to watch."""
        self._task = asyncio.create_task(self._watch(), name=f"pictures of {self._driver}")

    async def close(self) -> None:
        """Watch no longer."""
        await end_tasks(self._task)
        self._task = None

    async def _watch(self) -> None:
        self._listener.begun()
        serial, came_us = self._pictures.latest().serial, self._clock.now_us()
        while True:
            now_us = self._clock.now_us()
            self._want(now_us)
            latest = self._pictures.latest()
            if latest.serial != serial and isinstance(latest.value, Picture):
                serial, came_us = latest.serial, now_us
                try:
                    data = fitted(latest.value, *self._size)
                except ValueError as error:
                    self._listener.silent(f"{self._driver} sends a picture that is none: {error}")
                else:
                    self._listener.output(data)
            elif now_us - came_us >= _LOST_S * 1e6:
                self._listener.ended(
                    DriverError(f"{self._driver} sends no pictures", "is it connected?")
                )
                came_us = now_us  # told once, and again after the same time
            elif now_us - came_us >= _STALE_S * 1e6:
                self._listener.silent(f"{self._driver} sends no pictures")
            await asyncio.sleep(_LOOK_S)

    def _want(self, now_us: int) -> None:
        """Ask for pictures, and for no fewer and no smaller ones than a console does."""
        width, rate = self._size[0], self._rate
        wish = self._watched.latest().value
        if isinstance(wish, CameraWatched) and wish.until_us > now_us:
            if wish.width >= width and wish.rate >= rate:
                return
            width, rate = max(width, wish.width), max(rate, wish.rate)
        self._watched.put(CameraWatched(now_us + round(_WATCHES_S * 1e6), width, rate))


def fitted(picture: Picture, width: int, height: int) -> bytes:
    """A picture scaled to this size, all of it, with black where its shape is another. Raises
    `ValueError` if its bytes are none.
    """
    if not 0 < 3 * picture.width * picture.height == len(picture.rgb):
        raise ValueError(f"{len(picture.rgb)} bytes for {picture.width} x {picture.height}")
    if (picture.width, picture.height) == (width, height):
        return picture.rgb
    pixels = np.frombuffer(picture.rgb, np.uint8).reshape(picture.height, picture.width, 3)
    scale = min(width / picture.width, height / picture.height)
    columns, rows = (max(1, round(one * scale)) for one in (picture.width, picture.height))
    found = np.zeros((height, width, 3), np.uint8)
    left, top = (width - columns) // 2, (height - rows) // 2
    found[top : top + rows, left : left + columns] = pixels[
        np.minimum(np.arange(rows) / scale, picture.height - 1).astype(int)
    ][:, np.minimum(np.arange(columns) / scale, picture.width - 1).astype(int)]
    return found.tobytes()
