"""Cameras' pictures for those who watch: one at a time, for however many ask for it."""

from __future__ import annotations

import asyncio
import base64
from collections.abc import Sequence

from woz_tui.features.page.follower import SessionFollower
from woz_tui.protocol.requests import AskPicture
from woz_tui.system.clock import Clock

#: Seconds for which a picture is given to all who ask: a class's network has much else to carry.
EVERY_S = 2.0
#: Its size at the most, in pixels.
_WIDTH, _HEIGHT = 320, 240


class WatchedPictures:
    """The newest picture of each of these cameras.

    Args:
        session: By which connection it is asked for.
        cameras: Names of their drivers.
        clock: For how old a picture is.
    """

    def __init__(self, session: SessionFollower, cameras: Sequence[str], clock: Clock) -> None:
        self.cameras = tuple(cameras)
        self._session, self._clock = session, clock
        self._newest: dict[str, tuple[int, bytes]] = {}
        self._one = asyncio.Lock()  # a connection gets one after the other

    async def newest(self, camera: str) -> bytes:
        """It as a PNG file. Raises `LookupError`."""
        async with self._one:
            taken_us, picture = self._newest.get(camera, (0, b""))
            if picture and self._clock.now_us() - taken_us < EVERY_S * 1e6:
                return picture
            wanted = AskPicture(
                driver=camera, width=_WIDTH, height=_HEIGHT, format="png", rate=1 / EVERY_S
            )
            shown = await self._session.picture(wanted)
            if shown is None:
                raise LookupError(f"{camera} gives no picture")
            picture = base64.b64decode(shown.data)
            self._newest[camera] = self._clock.now_us(), picture
            return picture
