"""Pictures of people that packages bring, others made of them, and the programs that find and
recognise faces.

`astronaut.png` (scikit-image) has one face that looks into the camera, `group.jpg` (insightface)
has six. The other pictures of scikit-image have none.
"""

from __future__ import annotations

import base64
import cmath
import json
import math
import os
import subprocess
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image, ImageEnhance, ImageFilter
from woz_drivers.camera.raw_pictures import PictureLayout
from woz_drivers.faces.face_geometry import crop_of
from woz_drivers.faces.face_lines import FacesLine, SeenFace, decoded_line
from woz_drivers.faces.face_networks import PictureSampler
from woz_drivers.faces.face_tracks import FaceTrack, FaceTracker
from woz_drivers.faces.settings import FacesSettings

WIDTH, HEIGHT = 640, 480
GREY = (90, 90, 90)
NOBODY = ("chelsea.png", "coffee.png", "motorcycle_left.png", "rocket.jpg")
#: How a picture is changed: name -> (degrees clockwise, scale, darker, blur in pixels, mirrored).
CHANGES: dict[str, tuple[float, float, float, float, bool]] = {
    "as it is": (0, 1, 1, 0, False),
    "mirrored": (0, 1, 1, 0, True),
    "tilted by 15 degrees": (15, 1, 1, 0, False),
    "tilted by -15 degrees": (-15, 1, 1, 0, False),
    "tilted by 30 degrees": (30, 1, 1, 0, False),
    "tilted by -30 degrees": (-30, 1, 1, 0, False),
    "tilted by 45 degrees": (45, 1, 1, 0, False),
    "at 2/3 of the size": (0, 2 / 3, 1, 0, False),
    "at 1/2 of the size": (0, 1 / 2, 1, 0, False),
    "at 1/3 of the size": (0, 1 / 3, 1, 0, False),
    "at 1/4 of the size": (0, 1 / 4, 1, 0, False),
    "at half of the brightness": (0, 1, 0.5, 0, False),
    "at a quarter of the brightness": (0, 1, 0.25, 0, False),
    "at a tenth of the brightness": (0, 1, 0.1, 0, False),
    "blurred by 2 pixels": (0, 1, 1, 2, False),
    "blurred by 4 pixels": (0, 1, 1, 4, False),
    "blurred by 8 pixels": (0, 1, 1, 8, False),
}


def on_grey(*placed: tuple[Image.Image, int, int]) -> Image.Image:
    """A camera's picture with these on it, each about its middle."""
    made = Image.new("RGB", (WIDTH, HEIGHT), GREY)
    for picture, x, y in placed:
        made.paste(picture, (x - picture.width // 2, y - picture.height // 2))
    return made


def fitted(picture: Image.Image, scale: float = 1.0) -> Image.Image:
    """As large as a camera's picture has room for, times `scale`."""
    factor = scale * min(WIDTH / picture.width, HEIGHT / picture.height)
    size = (round(picture.width * factor), round(picture.height * factor))
    return picture.resize(size, Image.Resampling.BOX)


def changed_picture(picture: Image.Image, change: str) -> Image.Image:
    """A camera's picture with `picture` changed so."""
    turned, scale, brightness, blur, mirrored = CHANGES[change]
    made = fitted(picture, scale)
    if mirrored:
        made = made.transpose(Image.Transpose.FLIP_LEFT_RIGHT)
    if turned:
        made = made.rotate(-turned, Image.Resampling.BILINEAR, fillcolor=GREY)
    if brightness != 1:
        made = ImageEnhance.Brightness(made).enhance(brightness)
    if blur:
        made = made.filter(ImageFilter.GaussianBlur(blur))
    return on_grey((made, WIDTH // 2, HEIGHT // 2))


def open_picture(folder: Path, name: str) -> Image.Image:
    """One of the pictures."""
    return Image.open(folder / name).convert("RGB")


def face_of(folder: Path) -> Image.Image:
    """The astronaut's head alone, 170 pixels square."""
    return open_picture(folder, "astronaut.png").crop((140, 20, 310, 190))


def crossing(folder: Path, pictures: int = 40) -> Iterator[Image.Image]:
    """Two people who cross before the camera in four seconds; the nearer one hides the other."""
    near = face_of(folder).resize((200, 200))
    far = face_of(folder).resize((150, 150)).transpose(Image.Transpose.FLIP_LEFT_RIGHT)
    for n in range(pictures):
        share = n / (pictures - 1)
        left, right = round(110 + share * 420), round(530 - share * 420)
        yield on_grey((far, right, 220), (near, left, 240))


class FindingProgram:
    """Our program that finds faces, run by the peer's Python."""

    def __init__(self, peer: Path, width: int = WIDTH, height: int = HEIGHT) -> None:
        self.settings = settings(peer, width=width, height=height)
        self._ran = subprocess.Popen(
            self.settings.program,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )
        #: What it wrote to standard error, once it has ended.
        self.errors = b""

    def find(self, picture: Image.Image | bytes) -> FacesLine:
        """What it answers."""
        assert self._ran.stdin is not None
        assert self._ran.stdout is not None
        data = picture if isinstance(picture, bytes) else np.asarray(picture).tobytes()
        self._ran.stdin.write(data)
        self._ran.stdin.flush()
        return decoded_line(self._ran.stdout.readline())

    def people(self, picture: Image.Image, pictures: int = 14) -> list[FaceTrack]:
        """Who is there once this has been seen for a second, nearest first."""
        tracker = FaceTracker(1.0)
        there: list[FaceTrack] = []
        for n in range(pictures):
            there = tracker.update(self.find(picture).faces, n * 66_667)
        return sorted(there, key=lambda track: -track.face.width)

    def __enter__(self) -> FindingProgram:
        return self

    def __exit__(self, *failed: object) -> None:
        self._ran.kill()
        _, self.errors = self._ran.communicate()


def settings(
    peer: Path, command: Sequence[str] = ("cat",), width: int = WIDTH, height: int = HEIGHT
) -> FacesSettings:
    """Of a driver whose program is run by the peer's Python."""
    faces_settings = FacesSettings(
        command=tuple(command),
        width=width,
        height=height,
        format="rgb24",
        models=str(peer / "networks"),
        closely=10,
    )
    words = (str(peer / "bin" / "python"), *faces_settings.finder_words[1:])
    return FacesSettings(
        command=tuple(command), width=width, height=height, format="rgb24", program=words
    )


class RecognisingProgram:
    """Our program that recognises faces, run by the peer's Python, with a store in `state`."""

    def __init__(self, peer: Path, state: Path) -> None:
        faces_settings = FacesSettings(models=str(peer / "networks"))
        self._ran = subprocess.Popen(
            (str(peer / "bin" / "python"), *faces_settings.recogniser_words[1:]),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env={**os.environ, "XDG_STATE_HOME": str(state)},
        )
        assert json.loads(self._read())["ready"]

    def learn(self, name: str, picture: Image.Image, face: SeenFace) -> dict[str, Any]:
        """Keep a face under a name."""
        self._ask(do="take", anew=True, crop=_crop(picture, face))
        return self._ask(do="learn", name=name, consented="2026-03-01", log="peer")

    def identify(self, picture: Image.Image, face: SeenFace) -> tuple[str, float]:
        """Whose face it is, empty for a stranger's, and how alike it is to the nearest kept one."""
        answer = self._ask(do="identify", crop=_crop(picture, face))
        return str(answer["name"]), float(answer["likeness"])

    def _ask(self, **request: object) -> dict[str, Any]:
        assert self._ran.stdin is not None
        self._ran.stdin.write(json.dumps({"id": 1, **request}).encode() + b"\n")
        self._ran.stdin.flush()
        answer: dict[str, Any] = json.loads(self._read())
        return answer

    def _read(self) -> bytes:
        assert self._ran.stdout is not None
        return self._ran.stdout.readline()

    def __enter__(self) -> RecognisingProgram:
        return self

    def __exit__(self, *failed: object) -> None:
        self._ran.kill()
        self._ran.communicate()


def _crop(picture: Image.Image, face: SeenFace) -> str:
    sampler = PictureSampler(PictureLayout(WIDTH, HEIGHT, "rgb24", 3 * WIDTH))
    sampler.load(np.asarray(picture).tobytes())
    return base64.b64encode(crop_of(sampler, face.points)).decode()


def faces_in(program: FindingProgram, picture: Image.Image) -> list[SeenFace]:
    """The faces of a picture that can be told apart: with their points, 28 pixels wide or more."""
    faces = (track.face for track in program.people(picture))
    return [one for one in faces if one.points and one.width >= 28]


def _place(face: SeenFace) -> complex:
    """The middle of its points: a second box about the same face has the same."""
    return sum(complex(*one) for one in face.points) / len(face.points)


def moved_place(face: SeenFace, change: str) -> complex:
    """Where a face of the picture as it is lies in the changed one, in pixels."""
    degrees, scale, _, _, mirrored = CHANGES[change]
    centre = complex(WIDTH / 2, HEIGHT / 2)
    off = _place(face) - centre
    off = -off.conjugate() if mirrored else off
    return centre + off * scale * cmath.exp(1j * math.radians(degrees))


def whose(face: SeenFace, people: dict[str, SeenFace], change: str) -> str | None:
    """Which of these people (their faces as it is) a face of the changed picture is."""
    at = _place(face)
    name, off = min(
        ((name, abs(at - moved_place(one, change))) for name, one in people.items()),
        key=lambda it: it[1],
    )
    return name if off < face.width / 2 else None
