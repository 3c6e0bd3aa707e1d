"""The camera's pictures for people, while somebody watches."""

from __future__ import annotations

import numpy as np

from woz_drivers.camera.settings import CameraSettings
from woz_tui.drivers.contract import DriverContext
from woz_tui.protocol.camera_pictures import PICTURE, WATCHED, CameraWatched, Picture

#: Of the pictures that are wanted a second so many times as many are offered: who asks at any
#: moment gets one that is young.
_AHEAD = 2.0


class PictureFeed:
    """Puts pictures into the feed `picture`, turned as the settings say; nothing while nobody
    watches, as every picture has to be computed.
    """

    def __init__(self, settings: CameraSettings, context: DriverContext) -> None:
        self._settings = settings
        self._pictures = context.feed(PICTURE)
        self._watched = context.feed(WATCHED)
        self._offered_us: int | None = None

    def look_at(self, data: bytes, now_us: int) -> None:
        """Offer the raw picture `data`, if it is time for one."""
        wish = self._watched.latest().value
        if not isinstance(wish, CameraWatched) or wish.until_us <= now_us:
            return
        last = self._offered_us
        if last is not None and now_us - last < 1_000_000 / (_AHEAD * wish.rate):
            return
        self._offered_us = now_us
        settings = self._settings
        picture = settings.layout.whole(data, wish.width)
        turned = picture[:: -1 if settings.flip else 1, :: -1 if settings.mirror else 1]
        height, width = turned.shape[:2]
        rgb = np.ascontiguousarray(turned).tobytes()
        self._pictures.put(Picture(now_us, width, height, rgb))
