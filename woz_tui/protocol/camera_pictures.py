"""Camera pictures: from a driver to whoever watches, by two feeds, and from there to a console.

They are not messages: nobody wants two megabytes a second in a log or on the stream. A driver with
a camera puts a `Picture` into its feed `PICTURE` whenever it has one, and takes pictures only while
its feed `WATCHED` holds a `CameraWatched` that is not over. A driver that names the feed `PICTURE`
has a camera; it does so when it is made, or when it is opened.

A console asks for each picture (`requests.AskPicture`) and gets it as a `PictureShown`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from woz_tui.protocol.envelope import Answer

#: Names of the feeds, both of the driver that has the camera.
PICTURE, WATCHED = "picture", "picture.watched"
#: Pixels a side that may be asked for, and pictures a second.
MOST_PIXELS, MOST_RATE = 1920, 30.0

#: `rgb`: three bytes a pixel, packed with zlib, in base64. `png`: a PNG file of few colours, in
#: base64. `sixel`: a whole DEC sixel sequence.
PictureFormat = Literal["rgb", "png", "sixel"]


@dataclass(frozen=True, slots=True)
class Picture:
    """`height` rows of `width` pixels, three bytes each: red, green, blue. `t_us` of the clock."""

    t_us: int
    width: int
    height: int
    rgb: bytes


@dataclass(frozen=True, slots=True)
class CameraWatched:
    """Somebody watches until `until_us` of the clock, and wants pictures at least `width` wide (as
    far as the camera can) and `rate` a second at most.
    """

    until_us: int
    width: int
    rate: float


class PictureShown(Answer, frozen=True, kw_only=True, tag="picture"):
    """The answer to an `AskPicture`; not part of the session's stream and never logged.

    `data` holds `width` x `height` pixels in `format`, taken at `t` (microseconds on the messages'
    axis); `number` counts the camera's pictures. The camera's own are `camera_width` x
    `camera_height`. Without a new picture within a second `data` is empty and `why` says so.
    `cameras`: the drivers of this session that have one; `driver` is whose picture this is.
    """

    ref: int
    driver: str = ""
    cameras: list[str] = []
    number: int = 0
    t: int = 0
    width: int = 0
    height: int = 0
    camera_width: int = 0
    camera_height: int = 0
    format: PictureFormat = "rgb"
    data: str = ""
    why: str = ""
