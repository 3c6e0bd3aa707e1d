"""Half blocks: what the cells show, what is painted, and what it costs."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.console.camera.camera_pictures import Pixels, noisy, room_picture
from woz_tui.console.camera import half_blocks as c
from woz_tui.console.camera.half_blocks import COSTS, NOISE, HalfBlockCanvas
from woz_tui.console.camera.picture_sizes import (
    CellArea,
    PictureError,
    area_for,
    resized,
    shrunk_size,
    unpacked,
)
from woz_tui.protocol.camera_pictures import PictureShown

ALL = 1 << 30
DEPTHS = (1 << 24, 256, 16)


def colours_of(canvas: HalfBlockCanvas) -> Pixels:
    """What a terminal shows, two pixels a cell."""
    made = np.zeros((2 * canvas.rows, canvas.columns, 3), np.uint8)
    for y in range(canvas.rows):
        for x in range(canvas.columns):
            upper, lower = canvas.cell(x, y)
            made[2 * y, x] = c.rgb_of(upper, canvas.colours)
            made[2 * y + 1, x] = c.rgb_of(lower, canvas.colours)
    return made


def painted(canvas: HalfBlockCanvas, picture: Pixels, allowance: int = ALL) -> int:
    """Show a picture of the canvas's size; how many cells are painted."""
    return sum(one.width for one in canvas.paint(picture.tobytes(), allowance))


@pytest.mark.parametrize(("depth", "mean", "most"), [(1 << 24, 4, 8), (256, 17, 60), (16, 45, 140)])
def test_the_colours_are_the_pictures(depth: int, mean: int, most: int) -> None:
    picture = room_picture(60, 40)
    canvas = HalfBlockCanvas(60, 20, depth)
    painted(canvas, picture)
    differ = np.abs(colours_of(canvas).astype(int) - picture)
    assert differ.mean() <= mean
    assert np.percentile(differ, 99) <= most


@pytest.mark.parametrize("depth", [*DEPTHS, 0])
def test_a_camera_that_sees_the_same_costs_nothing(depth: int) -> None:
    canvas = HalfBlockCanvas(40, 15, depth)
    assert painted(canvas, noisy(room_picture(40, 30), 0)) > 0
    assert [painted(canvas, noisy(room_picture(40, 30), n)) for n in range(1, 20)] == [0] * 19


def test_what_moves_is_painted_and_nothing_else() -> None:
    canvas = HalfBlockCanvas(40, 15, 1 << 24)
    picture = room_picture(40, 30)
    painted(canvas, picture)
    picture[10:14, 20:23] = (0, 255, 0)
    (stretches) = canvas.paint(picture.tobytes(), ALL)
    assert {(one.y, one.x, one.right) for one in stretches} == {(5, 20, 23), (6, 20, 23)}


@given(st.integers(0, 3000), st.integers(0, 99))
def test_a_picture_never_costs_more_than_it_may_and_arrives_in_the_end(
    allowance: int, seed: int
) -> None:
    picture = np.random.default_rng(seed).integers(0, 256, (12, 10, 3), np.uint8)
    canvas = HalfBlockCanvas(10, 6, 1 << 24)
    most = max(1, allowance // COSTS[1 << 24])
    for _ in range(60 // min(most, 60) + 1):
        assert painted(canvas, picture, allowance) <= most
    off = np.abs(colours_of(canvas).astype(int) - picture).sum(axis=2)
    assert off.max() <= NOISE + 3 * 7


def test_a_slow_line_gets_first_what_has_changed_most() -> None:
    canvas = HalfBlockCanvas(10, 5, 1 << 24)
    picture = np.full((10, 10, 3), 100, np.uint8)
    painted(canvas, picture)
    picture[2, 3] = (150, 150, 150)
    picture[6, 7] = (255, 255, 255)
    (one,) = canvas.paint(picture.tobytes(), COSTS[1 << 24])
    assert (one.y, one.x, one.right) == (3, 7, 8)


@given(*[st.integers(0, 255)] * 3)
def test_256_colours_are_about_what_was_meant(red: int, green: int, blue: int) -> None:
    number = c.of_256(red, green, blue)
    assert 16 <= number <= 255
    got = c.rgb_of(number, 256)
    assert max(abs(a - b) for a, b in zip(got, (red, green, blue), strict=True)) <= 64
    assert 0 <= c.of_16(red, green, blue) <= 15


def test_without_colours_bright_is_dense() -> None:
    canvas = HalfBlockCanvas(10, 1, 0)
    assert [canvas.sign(x, 0) for x in range(10)] == [" "] * 10
    picture = np.repeat(np.arange(10, dtype=np.uint8)[None, :, None] * 28, 2, axis=0)
    painted(canvas, np.repeat(picture, 3, axis=2))
    assert "".join(canvas.sign(x, 0) for x in range(10)) == c.RAMP


@given(*[st.integers(1, 30)] * 4)
def test_stretching_takes_the_pixel_that_covers_most(
    width: int, height: int, columns: int, rows: int
) -> None:
    picture = np.random.default_rng(0).integers(0, 256, (height, width, 3), np.uint8)
    out = np.frombuffer(resized(picture.tobytes(), width, height, columns, rows), np.uint8)
    y, x = np.arange(rows) * height // rows, np.arange(columns) * width // columns
    assert (out.reshape(rows, columns, 3) == picture[y][:, x]).all()


@given(*[st.integers(1, 2000)] * 2, *[st.integers(1, 200)] * 2)
def test_a_picture_takes_the_cells_that_its_shape_needs(
    width: int, height: int, columns: int, rows: int
) -> None:
    room_ = area_for(width, height, CellArea(columns, rows))
    assert 1 <= room_.columns <= columns
    assert 1 <= room_.rows <= rows
    wide, high = room_.pixels
    scale = min(columns * 8 / width, rows * 16 / height)
    assert abs(wide - width * scale) <= 8
    assert abs(high - height * scale) <= 16
    small = shrunk_size(wide, high, 1000)
    assert small[0] * small[1] <= max(1000, 16 * 12, 16 * small[1], 12 * small[0])


@pytest.mark.parametrize("data", ["", "!", "AAAA", "eJwDAAAAAAE=", "eJxjYGBgAAAABAAB"])
def test_a_picture_that_cannot_be_read(data: str) -> None:
    with pytest.raises(PictureError):
        unpacked(PictureShown(ref=1, width=2, height=2, data=data))
