"""What a robot file may say about a camera."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from woz_drivers import command_lines
from woz_drivers.camera.blob import ColourRule
from woz_drivers.camera.raw_pictures import FORMATS, PictureLayout
from woz_tui.drivers.fields import Doc, OneOf, Range, Section


@dataclass(frozen=True, slots=True)
class CameraSettings(Section):
    """Where pictures come from, their shape, and what is looked for in them."""

    command: Annotated[
        str | tuple[str, ...],
        Doc("program that writes raw pictures to stdout; default: rpicam-vid with the size below"),
    ] = ""
    width: Annotated[int, Range(4, 1920), Doc("pixels a row")] = 320
    height: Annotated[int, Range(4, 1080), Doc("rows")] = 240
    format: Annotated[str, OneOf(FORMATS), Doc("format of a pixel")] = "yuv420"
    stride: Annotated[
        int, Range(0, 16_384), Doc("bytes from one row to the next, where rows are padded; 0: none")
    ] = 0
    rate: Annotated[float, Range(1, 120, "Hz"), Doc("pictures a second")] = 32.0
    pace: Annotated[
        str,
        OneOf(("as-fast", "real")),
        Doc("as-fast: a picture counts when it comes, right for cameras; real: a file is a film"),
    ] = "as-fast"
    mirror: Annotated[bool, Doc("mirror left and right")] = False
    flip: Annotated[bool, Doc("mirror top and bottom, for a camera mounted upside down")] = False
    factor: Annotated[
        float, Range(1, 10), Doc("green counts if it is more than this times red and blue")
    ] = 1.3
    brightness: Annotated[int, Range(0, 255), Doc("darker green does not count")] = 40
    smallest: Annotated[int, Range(1, 100_000), Doc("smallest number of pixels of an object")] = 1
    largest: Annotated[bool, Doc("only the largest patch counts; else all green together")] = True
    publish: Annotated[float, Range(0.5, 10, "Hz"), Doc("readings a second, for the log")] = 10.0

    def problems(self) -> list[tuple[str, str]]:
        """What is wrong between settings: pairs of a setting's name and a sentence."""
        found = []
        if self.stride and self.stride < self._row_bytes:
            found.append(
                ("stride", f"{self.stride} bytes are less than the {self._row_bytes} of a row")
            )
        if not self.command and self.format != "yuv420":
            found.append(("format", "rpicam-vid writes yuv420; others need a command"))
        return found + command_lines.problems(self.command, "command")

    @property
    def words(self) -> tuple[str, ...]:
        """The command. Raises `DriverError` if it is none."""
        if self.command:
            return command_lines.split(self.command, "command")
        size = ("--width", str(self.width), "--height", str(self.height))
        rate = ("--framerate", f"{self.rate:g}")
        return ("rpicam-vid", "-n", "-v", "0", "-t", "0", "--codec", "yuv420", *size, *rate, "-o-")

    @property
    def layout(self) -> PictureLayout:
        """The shape of the pictures."""
        return PictureLayout(self.width, self.height, self.format, self.stride or self._row_bytes)

    @property
    def rule(self) -> ColourRule:
        """What is looked for, in pictures as they are decoded."""
        smallest = -(-self.smallest // self.layout.thinned**2)
        return ColourRule(self.factor, self.brightness, smallest, self.largest)

    @property
    def shape(self) -> str:
        """The pictures in words."""
        return f"{self.width} x {self.height} {self.format}"

    @property
    def _row_bytes(self) -> int:
        return self.width if self.format == "yuv420" else 3 * self.width
