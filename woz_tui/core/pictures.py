"""Camera pictures inside the robot process: from a driver to whoever watches, by two feeds.

They are not messages: nobody wants two megabytes a second in a log or on the stream. A driver with
a camera puts a `Picture` into its feed `PICTURE` whenever it has one, and takes pictures only while
its feed `WATCHED` holds a `Watched` that is not over.
"""

from __future__ import annotations

from dataclasses import dataclass

#: Names of the feeds, both of the driver that has the camera.
PICTURE, WATCHED = "picture", "picture.watched"


@dataclass(frozen=True, slots=True)
class Picture:
    """`height` rows of `width` pixels, three bytes each: red, green, blue. `t_us` of the clock."""

    t_us: int
    width: int
    height: int
    rgb: bytes


@dataclass(frozen=True, slots=True)
class Watched:
    """Somebody watches until `until_us` of the clock, and wants pictures at least `width` wide (as
    far as the camera can) and `rate` a second at most.
    """

    until_us: int
    width: int
    rate: float
