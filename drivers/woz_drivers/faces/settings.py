"""What a robot file may say about faces."""

from __future__ import annotations

import math
import pathlib
import sys
from dataclasses import dataclass
from typing import Annotated

from woz_drivers.camera.picture_source import PictureSource
from woz_drivers.faces import models
from woz_drivers.programs import command_lines
from woz_tui.drivers.fields import Doc, Path, Range, Seconds, Sibling


@dataclass(frozen=True, slots=True)
class FacesSettings(PictureSource):
    """Where pictures come from, how the camera sees, and what counts as a look at the robot."""

    camera: Annotated[
        str, Sibling(), Doc("driver of the same robot whose camera it is, such as a Pepper")
    ] = ""
    width: Annotated[int, Range(4, 1920), Doc("pixels a row")] = 640
    height: Annotated[int, Range(4, 1080), Doc("rows")] = 480
    rate: Annotated[float, Range(1, 120, "Hz"), Doc("pictures a second")] = 15.0
    field_of_view: Annotated[
        float, Range(10, 170, "deg"), Doc("how much the camera sees from left to right")
    ] = 60.0
    distance_factor: Annotated[
        float, Range(0.2, 5), Doc("distances are multiplied by it; `calibrate_distance` finds it")
    ] = 1.0
    neutral_yaw: Annotated[
        float, Range(-90, 90, "deg"), Doc("gaze at the robot; `calibrate_gaze` finds it")
    ] = 0.0
    neutral_pitch: Annotated[
        float, Range(-90, 90, "deg"), Doc("gaze at the robot; `calibrate_gaze` finds it")
    ] = 10.0
    gaze_within: Annotated[
        float, Range(1, 90, "deg"), Doc("who looks no farther past the robot looks at it")
    ] = 15.0
    hold: Annotated[
        float, Seconds(0, 10), Doc("somebody whose face is not found is there for so long")
    ] = 1.0
    closely: Annotated[
        int, Range(0, 10), Doc("of so many faces, the largest, the gaze is looked at")
    ] = 3
    far: Annotated[
        bool, Doc("look twice for small and far faces, which takes half as long again")
    ] = True
    publish: Annotated[float, Range(0.5, 30, "Hz"), Doc("readings a second")] = 10.0
    models: Annotated[
        str,
        Path(),
        Doc("folder of the networks; default: where the fetching command puts them"),
    ] = ""
    program: Annotated[
        str | tuple[str, ...],
        Doc("program that finds faces in raw pictures from stdin; default: ours"),
    ] = ""
    identity: Annotated[
        bool, Doc("recognise people who have consented (extra `faces-identity`)")
    ] = False
    alike: Annotated[
        float, Range(0.1, 0.95), Doc("faces so alike or more are one person's (cosine)")
    ] = 0.45
    recogniser: Annotated[
        str | tuple[str, ...],
        Doc("program that recognises faces, with a store of its own; default: ours"),
    ] = ""

    def problems(self) -> list[tuple[str, str]]:
        """What is wrong between settings: pairs of a setting's name and a sentence."""
        # Not `super()`: a dataclass with slots is another class than the one that is written here.
        found = PictureSource.problems(self)
        if self.camera and (self.command or self.device):
            found.append(("camera", "pictures come from it: leave command and device out"))
        for name in ("program", "recogniser"):
            found += command_lines.problems(getattr(self, name), name)
        return found

    @property
    def pixels(self) -> str:
        """The format of a pixel."""
        return "rgb24" if self.camera else self.format

    @property
    def source(self) -> str:
        """Where pictures come from, in a word. Raises `DriverError`."""
        return self.camera or self.words[0]

    @property
    def models_folder(self) -> pathlib.Path:
        """Where the networks are."""
        return pathlib.Path(self.models) if self.models else models.default_folder()

    @property
    def finder_words(self) -> tuple[str, ...]:
        """The program that finds faces. Raises `DriverError` if it is none."""
        if self.program:
            return command_lines.split(self.program, "program")
        layout = self.layout
        # -P: no modules of the folder of the experiment.
        return (
            *(sys.executable, "-P", "-m", "woz_drivers.faces.face_finder"),
            *("--models", str(self.models_folder), "--closely", str(self.closely)),
            *("--width", str(layout.width), "--height", str(layout.height)),
            *("--format", layout.format, "--stride", str(layout.stride)),
            *(("--far",) if self.far else ()),
            *(("--mirror",) if self.mirror else ()),
            *(("--flip",) if self.flip else ()),
        )

    @property
    def recogniser_words(self) -> tuple[str, ...]:
        """The program that recognises faces. Raises `DriverError` if it is none."""
        if self.recogniser:
            return command_lines.split(self.recogniser, "recogniser")
        return (
            *(sys.executable, "-P", "-m", "woz_drivers.faces.face_recogniser"),
            *("--models", str(self.models_folder), "--alike", str(self.alike)),
        )

    @property
    def focal(self) -> float:
        """The lens' focal length in pixels."""
        return self.width / 2 / math.tan(math.radians(self.field_of_view / 2))
