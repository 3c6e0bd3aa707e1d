"""The rule of green, patches of pixels, and pictures in several formats."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from woz_drivers.camera.blob import Blob, BlobFinder, ColourRule
from woz_drivers.camera.raw_pictures import HIGHEST, WIDEST, PictureLayout
from woz_drivers.camera.settings import CameraSettings
from woz_drivers.programs.byte_stream import ChunkCutter

from tests.drivers.camera.pictures import GREEN, picture, planes, with_block

PLAIN = BlobFinder(ColourRule())
LARGEST = BlobFinder(ColourRule(largest=True))
masks = arrays.arrays(np.bool_, arrays.array_shapes(min_dims=2, max_dims=2, max_side=12))


@pytest.mark.toolkit("O2")
@pytest.mark.parametrize(
    ("colour", "counts"),
    [
        ((100, 130, 100), False),
        ((100, 131, 100), True),
        ((101, 131, 100), False),
        ((0, 1, 0), True),
        ((0, 0, 0), False),
        ((200, 255, 200), False),
        ((255, 255, 255), False),
        ((190, 255, 190), True),
    ],
)
def test_which_colours_count(colour: tuple[int, int, int], counts: bool) -> None:
    made = np.array([[colour]], np.uint8)
    assert bool(PLAIN.counting(made)[0, 0]) is counts


@pytest.mark.toolkit("O2")
def test_the_factor_is_exact_for_all_colours() -> None:
    red, green = np.meshgrid(np.arange(256), np.arange(256))
    made = np.stack((red, green, red), axis=-1).astype(np.uint8)
    assert np.array_equal(PLAIN.counting(made), 10 * green > 13 * red)


def test_dark_green_is_noise() -> None:
    bright = BlobFinder(ColourRule(brightness=40))
    assert bright.find(np.array([[(0, 39, 0)]], np.uint8)) is None
    assert bright.find(np.array([[(0, 40, 0)]], np.uint8)) == Blob(0, 0, 1)


@pytest.mark.toolkit("O3")
@pytest.mark.parametrize("finder", [PLAIN, LARGEST])
def test_the_middle_of_what_counts(finder: BlobFinder) -> None:
    assert finder.find(with_block(7, 3)) == Blob(7, 3, 1)
    assert finder.find(with_block(4, 9, 3)) == Blob(5, 10, 9)
    assert finder.find(picture()) is None


@pytest.mark.toolkit("O3")
def test_two_equal_things_have_one_middle_unless_the_largest_is_wanted() -> None:
    made = with_block(2, 5, 3)
    made[5:8, 12:15] = GREEN
    assert PLAIN.find(made) == Blob(8, 6, 18)
    assert LARGEST.find(made) == Blob(3, 6, 9)
    made[8, 13] = GREEN
    found = LARGEST.find(made)
    assert found is not None
    assert (found.size, round(found.x)) == (10, 13)


@pytest.mark.toolkit("O3")
def test_too_small_is_nothing() -> None:
    assert BlobFinder(ColourRule(smallest=10)).find(with_block(4, 9, 3)) is None
    assert BlobFinder(ColourRule(smallest=9)).find(with_block(4, 9, 3)) is not None


@pytest.mark.toolkit("O3")
@given(masks)
def test_the_largest_patch_is_the_one_a_flood_finds(
    mask: np.ndarray[tuple[int, int], np.dtype[np.bool_]],
) -> None:
    made = picture(mask.shape[1], mask.shape[0])
    made[mask] = GREEN
    left = {(int(y), int(x)) for y, x in zip(*np.nonzero(mask), strict=True)}
    patches = []
    while left:
        edge, patch = [left.pop()], set()
        while edge:
            y, x = edge.pop()
            patch.add((y, x))
            around = {(y + b, x + a) for a in (-1, 0, 1) for b in (-1, 0, 1)} & left
            left -= around
            edge += around
        patches.append(patch)
    found = LARGEST.find(made)
    if found is None:
        assert not patches
        return
    assert found.size == max(map(len, patches))
    middles = [
        (sum(x for _, x in one) / len(one), sum(y for y, _ in one) / len(one))
        for one in patches
        if len(one) == found.size
    ]
    assert any(found.x == pytest.approx(x) and found.y == pytest.approx(y) for x, y in middles)


@pytest.mark.toolkit("O1")
@pytest.mark.parametrize("size", [(20, 15), (160, 120), (640, 480), (641, 483), (7, 5)])
def test_pictures_of_any_size(size: tuple[int, int]) -> None:
    width, height = size
    side = max(1, width // 8)
    made = with_block(width // 2, height // 4, side, width, height)
    found = LARGEST.find(made)
    assert found is not None
    assert found.x == pytest.approx(width // 2 + (side - 1) / 2, abs=3 if width > 160 else 1e-9)
    assert found.y == pytest.approx(height // 4 + (side - 1) / 2, abs=3 if width > 160 else 1e-9)
    assert found.size == pytest.approx(side * side, rel=0.15)


@pytest.mark.parametrize(("name", "order"), [("rgb24", 1), ("bgr24", -1)])
def test_rows_may_be_padded(name: str, order: int) -> None:
    made = with_block(7, 3)
    rows = np.full((15, 64), 9, np.uint8)
    rows[:, :60] = made[:, :, ::order].reshape(15, 60)
    layout = PictureLayout(20, 15, name, 64)
    assert layout.size == 15 * 64
    assert np.array_equal(layout.decode(rows.tobytes()), made)


@pytest.mark.parametrize("stride", [32, 64])
def test_planes_of_brightness_and_colour(stride: int) -> None:
    made = with_block(12, 4, 6, 32, 24)
    layout = PictureLayout(32, 24, "yuv420", stride)
    data = planes(made, stride)
    assert layout.size == len(data)
    decoded = layout.decode(data)
    assert decoded.shape == (12, 16, 3)
    assert np.abs(decoded.astype(int) - made[::2, ::2].astype(int)).max() <= 4
    assert PLAIN.find(decoded) == Blob(7, 3, 9)


@given(st.integers(1, 50), st.lists(st.binary(max_size=120), max_size=20))
def test_pictures_are_cut_out_of_a_stream_however_it_is_split(
    size: int, pieces: list[bytes]
) -> None:
    cut: list[bytes] = []
    cutter = ChunkCutter(size, cut.append)
    for piece in pieces:
        cutter.feed(piece)
    whole = b"".join(pieces)
    assert b"".join(cut) == whole[: len(whole) // size * size]
    assert all(len(one) == size for one in cut)


@pytest.mark.toolkit("O1")
@pytest.mark.parametrize(("width", "height"), [(640, 480), (1280, 720), (1920, 1080)])
def test_a_large_picture_is_thinned_before_its_colours_are_computed(
    width: int, height: int
) -> None:
    camera = CameraSettings(width=width, height=height, smallest=900)
    layout = camera.layout
    found = []
    for size in (40, 24):
        made = with_block(width - 100, 60, size, width, height)
        decoded = layout.decode(planes(made, width))
        assert decoded.shape[0] <= HIGHEST
        assert decoded.shape[1] <= WIDEST
        found.append(BlobFinder(camera.rule).find(decoded))
    blob, none = found
    assert none is None, "576 pixels are less than 900"
    assert blob is not None
    rows, columns = decoded.shape[:2]
    assert (2 * blob.x + 1) / columns - 1 == pytest.approx(2 * (width - 80) / width - 1, abs=0.02)
    assert (2 * blob.y + 1) / rows - 1 == pytest.approx(2 * 80 / height - 1, abs=0.03)
    assert blob.size / (rows * columns) == pytest.approx(1600 / (width * height), rel=0.35)
