"""Sizes, colours and formats of pictures, read back by decoders written from the specifications."""

from __future__ import annotations

import base64
import io

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from PIL import Image

from tests.console.camera.camera_pictures import Pixels, room_picture
from tests.console.camera.sixel_reader import read_sixel
from woz_tui.host.picture_encoding import encoded, fitting, png, quantised, scaled, sixels
from woz_tui.protocol.camera_pictures import Picture

sides = st.integers(1, 25)
pictures = hnp.arrays(np.uint8, st.tuples(sides, sides, st.just(3)), elements=st.integers(0, 255))


@given(st.integers(1, 3000), st.integers(1, 3000), sides, sides)
def test_what_fits_fills_one_side_and_keeps_its_proportions(
    width: int, height: int, most_width: int, most_height: int
) -> None:
    wide, high = fitting(width, height, most_width, most_height)
    assert 1 <= wide <= most_width
    assert 1 <= high <= most_height
    assert wide == most_width or high == most_height
    exact = min(most_width / width, most_height / height)
    assert abs(wide - width * exact) <= 1 or wide == 1
    assert abs(high - height * exact) <= 1 or high == 1


@given(pictures, sides, sides)
def test_a_smaller_picture_has_the_means_of_what_it_covers(
    made: Pixels, width: int, height: int
) -> None:
    rows, columns = made.shape[:2]
    out = scaled(made, width, height)
    assert out.shape == (height, width, 3)
    if width > columns or height > rows:
        y, x = height - 1, width - 1
        assert (out[y, x] == made[y * rows // height, x * columns // width]).all()
        return
    for y in {0, height // 2, height - 1}:
        for x in {0, width // 2, width - 1}:
            top, bottom = y * rows // height, max((y + 1) * rows // height, 1)
            left, right = x * columns // width, max((x + 1) * columns // width, 1)
            part = made[top:bottom, left:right].reshape(-1, 3)
            assert np.abs(out[y, x] - part.mean(axis=0)).max() <= 0.5 + 1e-9


@given(pictures, st.integers(2, 64))
def test_sixels_read_back_are_the_colours_that_were_chosen(made: Pixels, most: int) -> None:
    palette, chosen = quantised(made, most)
    assert len(palette) <= most
    back = read_sixel(sixels(made, most))
    assert back.shape == made.shape
    wanted = np.rint(np.rint(palette * 100 / 255) * 255 / 100)[chosen]
    assert np.abs(back.astype(int) - wanted).max() <= 1


@given(pictures)
def test_few_colours_are_kept(made: Pixels) -> None:
    few = made & np.uint8(0x80)  # eight colours at most
    palette, chosen = quantised(few, 64)
    assert np.abs(palette[chosen] - few).max() <= 8


@given(pictures, st.integers(2, 64))
def test_a_png_is_one_to_others(made: Pixels, most: int) -> None:
    with Image.open(io.BytesIO(png(made, most))) as image:
        back = np.asarray(image.convert("RGB"))
    palette, chosen = quantised(made, most)
    assert (back == np.rint(palette)[chosen]).all()


def test_a_room_in_64_colours_still_looks_like_it() -> None:
    made = room_picture(320, 240)
    back = read_sixel(sixels(made))
    assert np.abs(back.astype(int) - made).mean() < 6


@pytest.mark.parametrize("wanted", ["rgb", "png"])
def test_nothing_is_enlarged_that_the_terminal_can_enlarge(wanted: str) -> None:
    made = room_picture(20, 15)
    width, height, data = encoded(Picture(0, 20, 15, made.tobytes()), 640, 480, wanted)  # type: ignore[arg-type]
    assert (width, height) == (20, 15)
    assert len(base64.b64decode(data)) < 2000


def test_a_sixel_picture_fills_the_room() -> None:
    made = room_picture(20, 15)
    width, height, data = encoded(Picture(0, 20, 15, made.tobytes()), 200, 900, "sixel")
    assert (width, height) == (200, 150)
    assert read_sixel(data).shape == (150, 200, 3)


@pytest.mark.parametrize("size", [(0, 0), (2, 2), (1, 0)])
def test_a_picture_of_another_size_than_it_says(size: tuple[int, int]) -> None:
    with pytest.raises(ValueError, match="9 bytes"):
        encoded(Picture(0, *size, bytes(9)), 10, 10, "rgb")
