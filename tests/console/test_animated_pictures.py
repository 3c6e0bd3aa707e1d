"""The animated pictures in the documentation: what they hold, and that they stay small."""

from __future__ import annotations

import re
from dataclasses import replace
from xml.etree import ElementTree

import pytest

from tools import IMAGES, film
from woz_tui.console.drawing.cells import Row

SVG = "{http://www.w3.org/2000/svg}"
#: What a page may load for one picture.
LARGEST = 400_000


@pytest.mark.toolkit("U1")
@pytest.mark.parametrize("made", film.FILMS, ids=lambda made: made.name)
def test_each_moment_is_a_frame_of_its_own_and_all_of_them_fill_the_time(made: film.Film) -> None:
    short = replace(made, end=made.begin + 2.0)
    root = ElementTree.fromstring(film.svg(short, list(film.frames(short))))
    frames = [group for group in root.iter(f"{SVG}g") if "f" in group.get("class", "").split()]
    assert len(frames) == 2 * film.RATE
    delays = [float(re.findall(r"-?[\d.]+", frame.get("style", ""))[0]) for frame in frames]
    assert delays[0] == 0.0
    assert delays[1:] == pytest.approx(
        [number / film.RATE - 2.0 for number in range(1, len(frames))], abs=1e-3
    )
    known = {group.get("id") for group in root.iter(f"{SVG}g")}
    used = {use.get("href", "").removeprefix("#") for use in root.iter(f"{SVG}use")}
    assert used <= known
    assert not list(root.iter(f"{SVG}script"))


def test_lights_and_dots_are_drawn_where_they_are_in_their_cells() -> None:
    row: Row = ((" ▀", "face-4"), ("⠁⢀", "strong"), (" a  b", "plain"))
    drawn = film.drawn(row)
    assert "M8 0h8v8h-8z" in drawn
    assert "M18 2h0" in drawn
    assert "M30 14h0" in drawn
    assert '<text class="plain" x="40" y="12" textLength="8">a</text>' in drawn
    assert '<text class="plain" x="64" y="12" textLength="8">b</text>' in drawn


@pytest.mark.parametrize("name", [made.name for made in film.FILMS])
def test_the_films_are_small_enough_for_a_page(name: str) -> None:
    path = IMAGES / f"{name}.svg"
    assert path.stat().st_size < LARGEST
    ElementTree.parse(path)
