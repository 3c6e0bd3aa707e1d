"""The program that finds faces, beside the robot process: pictures in, a line for each out.

    python -m woz_drivers.faces.face_finder --models FOLDER --width 640 --height 480 ... < raw

It reads raw pictures from stdin and writes one JSON object a line to stdout: `faces`, a list with
the fields of `SeenFace` each, and `ms`, how long the picture took. Any other program that does so
can take its place (setting `program`).
"""

from __future__ import annotations

import argparse
import contextlib
import os
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

import msgspec

from woz_drivers.camera.raw_pictures import FORMATS, PictureLayout
from woz_drivers.faces import models
from woz_drivers.faces.face_geometry import points_of, pose_of
from woz_drivers.faces.face_lines import FacesLine, SeenFace
from woz_drivers.faces.face_networks import (
    FaceNetworks,
    FoundFace,
    PictureSampler,
    interpreted,
)
from woz_tui.drivers.contract import DriverError
from woz_tui.system.extras import install_command


def seen(face: FoundFace) -> SeenFace:
    """A face as it is told."""
    pose = pose_of(face)
    left, top, right, bottom = (round(float(one), 1) for one in face.box.box)
    points = [] if face.mesh is None else points_of(face.mesh)
    return SeenFace(
        left=left,
        top=top,
        right=right,
        bottom=bottom,
        score=round(face.box.score, 3),
        width=round(pose.width, 2),
        yaw=_rounded(pose.yaw),
        pitch=_rounded(pose.pitch),
        roll=_rounded(pose.roll),
        eyes_yaw=round(pose.eyes_yaw, 2),
        points=[(round(x, 1), round(y, 1)) for x, y in points],
    )


def _rounded(angle: float | None) -> float | None:
    return None if angle is None else round(angle, 2)


def answer(networks: FaceNetworks, data: bytes, closely: int) -> bytes:
    """The line for a picture."""
    began = time.perf_counter()
    faces = [seen(face) for face in networks.find(data, closely)]
    took = (time.perf_counter() - began) * 1000
    return msgspec.json.encode(FacesLine(faces=faces, ms=round(took, 2))) + b"\n"


def _run(pictures: BinaryIO, lines: int, networks: FaceNetworks, size: int, closely: int) -> None:
    while len(data := pictures.read(size)) == size:
        os.write(lines, answer(networks, data, closely))


@contextlib.contextmanager
def _silence() -> Iterator[None]:
    """Keeps what the run time says of itself from standard error: the last line there is told as
    the reason if this program ends.
    """
    kept, nothing = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, 2)
    try:
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(nothing)


def main() -> int:
    """Work until stdin ends."""
    parser = argparse.ArgumentParser(prog="python -m woz_drivers.faces.face_finder")
    parser.add_argument("--models", type=Path, default=models.default_folder())
    parser.add_argument("--width", type=int, required=True)
    parser.add_argument("--height", type=int, required=True)
    parser.add_argument("--format", choices=FORMATS, required=True)
    parser.add_argument("--stride", type=int, required=True)
    parser.add_argument("--closely", type=int, default=3)
    parser.add_argument("--far", action="store_true")
    parser.add_argument("--mirror", action="store_true")
    parser.add_argument("--flip", action="store_true")
    words = parser.parse_args()
    layout = PictureLayout(words.width, words.height, words.format, words.stride)
    # Nothing but our lines may come out of stdout, whatever the run time has to say.
    lines = os.dup(1)
    os.dup2(2, 1)
    try:
        with _silence():
            found = [interpreted(str(path)) for path in models.checked(words.models)]
    except DriverError as error:
        sys.stderr.write(f"{error.what}: {error.remedy}\n")
        return 1
    except ImportError as error:
        sys.stderr.write(f"{error}: {install_command('faces')}\n")
        return 1
    sampler = PictureSampler(layout, mirrored=words.mirror, flipped=words.flip)
    networks = FaceNetworks(sampler, *found, far=words.far)
    _run(sys.stdin.buffer, lines, networks, layout.size, words.closely)
    return 0


if __name__ == "__main__":
    sys.exit(main())
