"""What a robot file may say about a face of lights."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from woz_tui.drivers.fields import Doc, OneOf, Port, Range, Sibling

#: What stays on the lights when the session has ended.
AFTERWARDS = ("dark", "asleep", "last")


@dataclass(frozen=True, slots=True)
class LedFaceSettings:
    """Where the lights are, whose face they show, how they are mounted."""

    port: Annotated[
        str, Port(), Doc("serial port, best by its lasting name under /dev/serial/by-id/")
    ]
    follows: Annotated[
        str, Sibling(), Doc("the body whose face it shows; empty: patterns only")
    ] = ""
    baud: Annotated[
        int,
        Range(1200, 4_000_000),
        Doc("bits a second; boards with a USB port of their own take any"),
    ] = 115_200
    width: Annotated[int, Range(8, 128), Doc("lights a row, as one sees it")] = 24
    height: Annotated[int, Range(8, 64), Doc("rows, as one sees it")] = 16
    rotate: Annotated[
        str,
        OneOf(("0", "90", "180", "270")),
        Doc("degrees clockwise by which the matrix was turned when it was mounted"),
    ] = "0"
    mirror: Annotated[bool, Doc("left and right are wired the other way round")] = False
    brightness: Annotated[float, Range(0, 1), Doc("of the brightest face; 1: all it can")] = 1.0
    rate: Annotated[float, Range(1, 30, "Hz"), Doc("at most so many frames a second")] = 30.0
    afterwards: Annotated[str, OneOf(AFTERWARDS), Doc("picture after the end of the session")] = (
        "dark"
    )

    @property
    def wired(self) -> tuple[int, int]:
        """Width and height of the matrix as it is wired."""
        turned = self.rotate in ("90", "270")
        return (self.height, self.width) if turned else (self.width, self.height)
