"""Where raw pictures come from: a program, a camera of the machine, the size of the pictures."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from woz_drivers.camera.raw_pictures import FORMATS, PictureLayout
from woz_drivers.programs import command_lines
from woz_tui.drivers.fields import Doc, OneOf, Range, Section


@dataclass(frozen=True, slots=True)
class PictureSource(Section):
    """A program that writes raw pictures, and their shape."""

    command: Annotated[
        str | tuple[str, ...],
        Doc("program that writes raw pictures to stdout; default: rpicam-vid with the size below"),
    ] = ""
    device: Annotated[str, Doc("a camera such as /dev/video0: ffmpeg reads it, no command")] = ""
    width: Annotated[int, Range(4, 1920), Doc("pixels a row")] = 320
    height: Annotated[int, Range(4, 1080), Doc("rows")] = 240
    format: Annotated[str, OneOf(FORMATS), Doc("format of a pixel")] = "yuv420"
    stride: Annotated[
        int, Range(0, 16_384), Doc("bytes from one row to the next, where rows are padded; 0: none")
    ] = 0
    rate: Annotated[float, Range(1, 120, "Hz"), Doc("pictures a second")] = 32.0
    mirror: Annotated[bool, Doc("mirror left and right")] = False
    flip: Annotated[bool, Doc("mirror top and bottom, for a camera mounted upside down")] = False

    def problems(self) -> list[tuple[str, str]]:
        """What is wrong between settings: pairs of a setting's name and a sentence."""
        found = []
        if self.stride and self.stride < self._row_bytes:
            found.append(
                ("stride", f"{self.stride} bytes are less than the {self._row_bytes} of a row")
            )
        if self.command and self.device:
            found.append(("device", "it is for ffmpeg; put the device into your command instead"))
        if not self.command and self.format != "yuv420":
            found.append(("format", f"{self.words[0]} writes yuv420; others need a command"))
        return found + command_lines.problems(self.command, "command")

    @property
    def words(self) -> tuple[str, ...]:
        """The command. Raises `DriverError` if it is none."""
        if self.command:
            return command_lines.split(self.command, "command")
        if self.device:
            scaled = ("-vf", f"fps={self.rate:g},scale={self.width}:{self.height}")
            raw = ("-pix_fmt", "yuv420p", "-f", "rawvideo", "-")
            return ("ffmpeg", "-v", "error", "-f", "v4l2", "-i", self.device, *scaled, *raw)
        size = ("--width", str(self.width), "--height", str(self.height))
        rate = ("--framerate", f"{self.rate:g}")
        return ("rpicam-vid", "-n", "-v", "0", "-t", "0", "--codec", "yuv420", *size, *rate, "-o-")

    @property
    def pixels(self) -> str:
        """The format of a pixel."""
        return self.format

    @property
    def layout(self) -> PictureLayout:
        """The shape of the pictures."""
        return PictureLayout(self.width, self.height, self.pixels, self.stride or self._row_bytes)

    @property
    def shape(self) -> str:
        """The pictures in words."""
        return f"{self.width} x {self.height} {self.pixels}"

    @property
    def _row_bytes(self) -> int:
        return self.width if self.pixels == "yuv420" else 3 * self.width
