"""A camera's pictures: for people, only while somebody watches, and kept as files."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Awaitable, Callable
from pathlib import Path

from woz_drivers.pictures import picture_files
from woz_tui.drivers.background import apart
from woz_tui.drivers.contract import DeviceLostError, DriverContext, DriverError
from woz_tui.protocol.camera_pictures import PICTURE, WATCHED, CameraWatched, Picture

#: How often it is looked whether somebody watches, and the pause after a trouble, in seconds.
_LOOK_S, _TROUBLED_S = 0.1, 2.0
#: Of the pictures that are wanted a second so many times as many are offered: who asks at any
#: moment gets one that is young.
_AHEAD = 2.0


class LivePictures:
    """The feed `picture` of a driver; whoever makes one has a camera."""

    def __init__(self, context: DriverContext) -> None:
        self._context = context
        self._pictures = context.feed(PICTURE)
        self._watched = context.feed(WATCHED)
        self._offered_us: int | None = None
        self._trouble = ""

    @property
    def wanted(self) -> CameraWatched | None:
        """What those who watch want now; None: nobody watches."""
        wish = self._watched.latest().value
        if not isinstance(wish, CameraWatched) or wish.until_us <= self._context.clock.now_us():
            return None
        return wish if wish.rate > 0 and math.isfinite(wish.rate) else None

    def due(self) -> CameraWatched | None:
        """What they want, if it is time for one; it is offered then. For a camera that sends
        pictures by itself.
        """
        now_us, wish = self._context.clock.now_us(), self.wanted
        last = self._offered_us
        if wish is None or (last is not None and now_us - last < 1_000_000 / (_AHEAD * wish.rate)):
            return None
        self._offered_us = now_us
        return wish

    def offer(self, width: int, height: int, rgb: bytes) -> None:
        """Show a picture that came just now."""
        self._pictures.put(Picture(self._context.clock.now_us(), width, height, rgb))
        self._trouble = ""

    async def serve(
        self,
        show: Callable[[CameraWatched], Awaitable[None]],
        let_go: Callable[[], Awaitable[None]] | None = None,
    ) -> None:
        """For a camera that is asked: `show` asks for a picture and offers it, again and again
        while somebody watches, and `let_go` is called while nobody does or there is trouble. A
        `DriverError` of `show` is told once, but that of a lost robot, which its line tells.
        """
        loop = asyncio.get_running_loop()
        while True:
            begun, wish = loop.time(), self.wanted
            pause_s = _LOOK_S
            if wish is not None:
                try:
                    await show(wish)
                    pause_s = max(0.0, begun + 1 / wish.rate - loop.time())
                except DriverError as error:
                    pause_s, wish = _TROUBLED_S, None
                    if not isinstance(error, DeviceLostError) and self._trouble != error.what:
                        self._trouble = error.what
                        text = f"no camera picture: {error.what}"
                        self._context.notice("warning", text, error.remedy)
            if wish is None and let_go is not None:
                await let_go()
            await asyncio.sleep(pause_s)


async def kept_picture(
    context: DriverContext, folder: str, suffix: str, content: Callable[[], bytes]
) -> str:
    """Keep a picture that came just now in `folder`, as the settings have it (empty: the session's
    media folder); its file as the log names it. `content` runs in a thread. Raises `DriverError`.
    """
    name, media = f"picture-{picture_files.stamp(context.clock.wall())}", context.media

    def keep() -> Path:
        place = context.folder / Path(folder).expanduser() if folder else media
        return picture_files.keep(place, name, suffix, content())

    return str(Path(folder or media.name) / (await apart(keep)).name)
