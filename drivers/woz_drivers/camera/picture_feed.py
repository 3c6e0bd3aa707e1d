"""A camera's pictures for people: only while somebody watches, turned, with frames drawn in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from woz_drivers.camera import raw_pictures
from woz_drivers.camera.picture_source import PictureSource
from woz_drivers.pictures.live_pictures import LivePictures
from woz_tui.drivers.contract import DriverContext

#: A frame's line is this share of the picture's width.
_LINE = 0.006


@dataclass(frozen=True, slots=True)
class PictureMark:
    """A frame around something in the turned picture: shares of its width and height from the
    upper left, and a colour (red, green, blue).
    """

    left: float
    top: float
    right: float
    bottom: float
    colour: tuple[int, int, int]


class PictureFeed:
    """Puts pictures into the feed `picture`, turned as the settings say; nothing while nobody
    watches, as every picture has to be computed.
    """

    def __init__(self, settings: PictureSource, context: DriverContext) -> None:
        self._settings = settings
        self._live = LivePictures(context)

    def look_at(self, data: bytes, marks: Sequence[PictureMark] = ()) -> None:
        """Offer the raw picture `data`, if it is time for one."""
        wish = self._live.due()
        if wish is None:
            return
        settings = self._settings
        picture = settings.layout.for_people(data, wish.width)
        turned = picture[:: -1 if settings.flip else 1, :: -1 if settings.mirror else 1]
        height, width = turned.shape[:2]
        drawn = np.array(turned) if marks else np.ascontiguousarray(turned)
        for mark in marks:
            draw(mark, drawn)
        self._live.offer(width, height, drawn.tobytes())


def draw(mark: PictureMark, picture: raw_pictures.Picture) -> None:
    """Draw a frame into `picture`, as far as it is inside."""
    height, width = picture.shape[:2]
    line = max(1, round(_LINE * width))
    columns = np.clip(np.rint(np.array((mark.left, mark.right)) * width), 0, width).astype(int)
    rows = np.clip(np.rint(np.array((mark.top, mark.bottom)) * height), 0, height).astype(int)
    frame = picture[rows[0] : rows[1], columns[0] : columns[1]]
    for side in (frame[:line], frame[-line:], frame[:, :line], frame[:, -line:]):
        side[:] = mark.colour
