"""What a robot file may say about a camera."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from woz_drivers.camera.blob import ColourRule
from woz_drivers.camera.picture_source import PictureSource
from woz_tui.drivers.fields import Doc, OneOf, Range


@dataclass(frozen=True, slots=True)
class FrameSettings:
    """Which pictures are saved as files beside the log; people are on them."""

    at_once: Annotated[
        bool, Doc("from the beginning of the session; else a key with `save_frames` switches it on")
    ] = False
    most: Annotated[float, Range(0, 120, "Hz"), Doc("pictures a second at most; 0: all")] = 0.0
    megabytes: Annotated[int, Range(1, 10_000_000), Doc("so much in a session at most")] = 2_000
    leave_free: Annotated[
        int, Range(0, 10_000_000, "MB"), Doc("so much of the disk is left to the log")
    ] = 500


@dataclass(frozen=True, slots=True)
class CameraSettings(PictureSource):
    """Where pictures come from, their shape, and what is looked for in them."""

    pace: Annotated[
        str,
        OneOf(("as-fast", "real")),
        Doc("as-fast: a picture counts when it comes, right for cameras; real: a file is a film"),
    ] = "as-fast"
    factor: Annotated[
        float, Range(1, 10), Doc("green counts if it is more than this times red and blue")
    ] = 1.3
    brightness: Annotated[int, Range(0, 255), Doc("darker green does not count")] = 40
    smallest: Annotated[int, Range(1, 100_000), Doc("smallest number of pixels of an object")] = 1
    largest: Annotated[bool, Doc("only the largest patch counts; else all green together")] = True
    publish: Annotated[float, Range(0.5, 10, "Hz"), Doc("readings a second, for the log")] = 10.0
    frames: Annotated[
        FrameSettings | None,
        Doc("keep pictures as files beside the log: verb `save_frames`; mind your ethics approval"),
    ] = None

    @property
    def rule(self) -> ColourRule:
        """What is looked for, in pictures as they are decoded."""
        smallest = -(-self.smallest // self.layout.thinned**2)
        return ColourRule(self.factor, self.brightness, smallest, self.largest)
