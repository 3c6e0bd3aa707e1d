"""Faces as pictures: emotions, how strong, where they look, lids; on any matrix."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tools import face_sheet
from woz_tui.motion.body_shape import FaceShape
from woz_tui.motion.body_verbs import EMOTIONS
from woz_tui.motion.face_drawing import (
    CRASH_S,
    OPEN,
    STEPS,
    FaceState,
    draw,
    draw_eyes,
    eye_layout,
    prepare,
    squeezed,
)
from woz_tui.motion.light_frames import LightFrame, blank

USUAL = FaceShape()
MOODS = tuple(emotion for emotion in EMOTIONS if emotion not in ("neutral", "crash"))
GRID = [step / 100 for step in range(101)]
NEUTRAL = draw(FaceState(), USUAL)

#: Matrices that exist: chains of 8 x 8 and the 24 x 16 of the usual one, small and large.
SIZES = [(8, 8), (16, 8), (24, 16), (32, 8), (32, 16), (64, 32), (128, 64)]

shapes = st.builds(
    FaceShape,
    width=st.integers(8, 40),
    height=st.integers(8, 24),
    eye_radius=st.floats(1, 20),
    eyes=st.none() | st.tuples(st.floats(-100, 200), st.floats(-100, 200)),
    eye_row=st.none() | st.floats(-50, 100),
)
anything = st.floats(allow_nan=True, allow_infinity=True)
states = st.builds(
    FaceState,
    x=anything | st.floats(-1, 1),
    y=anything | st.floats(-1, 1),
    emotion=st.sampled_from(EMOTIONS),
    intensity=anything | st.floats(0, 1),
    lid=anything | st.floats(0, 1),
    crash=st.none() | anything | st.floats(0, CRASH_S),
)


def columns(frame: LightFrame) -> list[int]:
    """Columns in which a light is on."""
    return [x for x in range(frame.width) if any(frame.lit(x, y) for y in range(frame.height))]


def lights(frame: LightFrame) -> int:
    return sum(row.bit_count() for row in frame.rows)


def middle(frame: LightFrame) -> float:
    """Half-way between the leftmost and the rightmost light."""
    lit = columns(frame)
    return (lit[0] + lit[-1]) / 2


def frame_of_text(*rows: str) -> LightFrame:
    """A frame of 24 columns as a text shows it."""
    return LightFrame(
        24, tuple(int(row.replace(".", "0").replace("#", "1") or "0", 2) for row in rows)
    )


# -- the usual matrix -----------------------------------------------------------------------------


@pytest.mark.toolkit("F1")
def test_a_neutral_face_is_two_discs() -> None:
    assert (NEUTRAL.width, NEUTRAL.height) == (24, 16)
    for x, y in itertools.product(range(24), range(16)):
        near = min(math.hypot(x - 6, y - 7), math.hypot(x - 17, y - 7))
        assert NEUTRAL.lit(x, y) == (near <= 3.2)


@pytest.mark.toolkit("F1")
@given(states, st.sampled_from(SIZES))
def test_the_picture_depends_on_nothing_but_the_state(
    state: FaceState, size: tuple[int, int]
) -> None:
    shape = FaceShape(*size)
    first = draw(state, shape)
    draw(FaceState(0.3, -0.2, "sad", 0.7, 0.1), shape)
    assert draw(state, FaceShape(*size)) == first
    assert (first.width, first.height) == size


@pytest.mark.toolkit("F2")
def test_emotions_are_far_apart() -> None:
    faces = {emotion: draw(FaceState(0, 0, emotion, 1), USUAL) for emotion in EMOTIONS}
    near = {
        (one, other): faces[one].distance(faces[other])
        for one, other in itertools.combinations(EMOTIONS, 2)
    }
    assert min(near.values()) >= 10, near


@pytest.mark.toolkit("F2")
def test_neutral_has_no_intensity() -> None:
    assert {draw(FaceState(0, 0, "neutral", much), USUAL) for much in GRID} == {NEUTRAL}


@pytest.mark.toolkit("F3")
@pytest.mark.parametrize("emotion", MOODS)
def test_intensity_leads_away_from_neutral(emotion: str) -> None:
    faces = [draw(FaceState(0, 0, emotion, much), USUAL) for much in GRID]
    assert faces[0] == NEUTRAL
    away = [face.distance(NEUTRAL) for face in faces]
    assert away == sorted(away)
    assert len(set(faces)) >= 4


@pytest.mark.toolkit("F3")
@pytest.mark.parametrize("emotion", MOODS)
@pytest.mark.parametrize("size", SIZES[2:])
def test_intensity_leads_away_from_neutral_on_other_matrices(
    emotion: str, size: tuple[int, int]
) -> None:
    shape = FaceShape(*size, eye_radius=size[1] / 5)
    faces = [draw(FaceState(0, 0, emotion, step / STEPS), shape) for step in range(STEPS + 1)]
    away = [face.distance(faces[0]) for face in faces]
    assert away == sorted(away)
    assert len(set(faces)) >= (4 if size[1] > 8 else 2)


@pytest.mark.toolkit("F6")
@pytest.mark.parametrize("emotion", EMOTIONS)
def test_eyes_follow_the_knob_and_stay_on_the_matrix(emotion: str) -> None:
    whole = lights(draw(FaceState(0, 0, emotion, 1), USUAL))
    faces = [draw(FaceState(2 * much - 1, 0, emotion, 1), USUAL) for much in GRID]
    places = [middle(face) for face in faces]
    assert places == sorted(places)
    assert places[50] == 11.5
    assert places[0] <= 11.5 - 2 and places[-1] >= 11.5 + 2
    assert {lights(face) for face in faces} == {whole}  # nothing is cut off


@pytest.mark.toolkit("F6")
def test_the_middle_of_a_midi_knob_is_the_middle() -> None:
    assert draw(FaceState(64 / 127 * 2 - 1), USUAL) == draw(FaceState(0.0), USUAL)


@pytest.mark.parametrize("emotion", EMOTIONS)
def test_eyes_go_up_and_down_whole(emotion: str) -> None:
    faces = [draw(FaceState(0, 1 - 2 * much, emotion, 1), USUAL) for much in GRID]
    tops = [next(y for y, row in enumerate(face.rows) if row) for face in faces]
    assert tops == sorted(tops)
    assert tops[0] < tops[-1]
    assert len({lights(face) for face in faces}) == 1


# -- lids -----------------------------------------------------------------------------------------


@pytest.mark.toolkit("L9")
@pytest.mark.parametrize("emotion", [e for e in EMOTIONS if e != "crash"])
@pytest.mark.parametrize("x", [-1.0, 0.0, 0.6])
def test_a_blink_changes_the_height_only(emotion: str, x: float) -> None:
    open_eyes = draw(FaceState(x, 0, emotion, 1), USUAL)
    for lid in GRID:
        face = draw(FaceState(x, 0, emotion, 1, lid), USUAL)
        assert columns(face) == columns(open_eyes)
        assert lights(face) <= lights(open_eyes)


@pytest.mark.toolkit("L9")
@pytest.mark.parametrize("emotion", MOODS)
def test_lids_close_to_a_line_and_never_beyond_the_open_eye(emotion: str) -> None:
    place = eye_layout(USUAL)
    eyes = draw_eyes(place, OPEN)
    heights = [len({y for _, y in squeezed(eyes, lid)}) for lid in GRID]
    assert heights == sorted(heights)
    assert heights[0] == 1
    assert heights[-1] == len({y for _, y in eyes})
    closed = draw(FaceState(0, 0, emotion, 0, 0), USUAL)
    assert [row for row in closed.rows if row] == [int("000111111100001111111000", 2)]


# -- a breakdown ----------------------------------------------------------------------------------


@pytest.mark.toolkit("F7")
def test_a_breakdown_is_a_film_that_ends_with_the_former_face() -> None:
    before = FaceState(0.5, 0, "happy", 0.8)
    stills = [
        draw(FaceState(0.5, 0, "happy", 0.8, 1, crash=tick / 50), USUAL)
        for tick in range(int(CRASH_S * 50))
    ]
    assert len(set(stills)) > 60
    assert blank(24, 16) in stills  # crosses blink
    for over in (CRASH_S, CRASH_S + 1, math.inf):
        assert draw(FaceState(0.5, 0, "happy", 0.8, 1, crash=over), USUAL) == draw(before, USUAL)


@pytest.mark.toolkit("F7")
def test_the_film_tells_its_story_in_order() -> None:
    def still(seconds: float) -> LightFrame:
        return draw(FaceState(crash=seconds), USUAL)

    noise = {still(tick / 12 + 0.01) for tick in range(12)}
    assert len(noise) == 12
    cross = draw(FaceState(0, 0, "crash", 1), USUAL)
    assert still(1.1) == still(1.6) == cross
    assert still(1.4) == blank(24, 16)
    wandering = [still(2.5 + tick / 10) for tick in range(20)]
    assert NEUTRAL in wandering
    assert len(set(wandering)) > 5
    assert {lights(face) for face in wandering} == {lights(NEUTRAL)}  # they lose each other whole
    assert still(4.6) == frame_of_text(
        *[""] * 5,
        ".###.##..##..###.##..#..",
        ".#...#.#.#.#.#.#.#.#.#..",
        ".##..##..##..#.#.##..#..",
        ".#...#.#.#.#.#.#.#.#....",
        ".###.#.#.#.#.###.#.#.#..",
        *[""] * 6,
    )
    assert columns(still(7.0))[0] == 0 and columns(still(7.0))[-1] == 23  # two bats


@pytest.mark.toolkit("F7")
@given(st.floats(0, CRASH_S, exclude_max=True), shapes, states)
def test_a_film_is_the_same_whatever_the_face_was(
    seconds: float, shape: FaceShape, before: FaceState
) -> None:
    assert draw(replace(before, crash=seconds), shape) == draw(FaceState(crash=seconds), shape)


# -- any matrix -----------------------------------------------------------------------------------


@pytest.mark.toolkit("F1", "R4")
@given(states, shapes)
def test_any_state_on_any_matrix_is_a_picture_of_that_size(
    state: FaceState, shape: FaceShape
) -> None:
    face = draw(state, shape)
    assert (face.width, face.height) == (shape.width, shape.height)
    assert all(0 <= row < 1 << shape.width for row in face.rows)


@pytest.mark.toolkit("F6")
@given(shapes, st.floats(-1, 1), st.floats(-1, 1))
def test_open_eyes_are_whole_wherever_they_look(shape: FaceShape, x: float, y: float) -> None:
    ahead = draw(FaceState(), shape)
    assert lights(ahead) >= 2
    assert lights(draw(FaceState(x, y), shape)) == lights(ahead)


@given(shapes, st.sampled_from(EMOTIONS))
def test_gaze_is_monotonic_on_any_matrix(shape: FaceShape, emotion: str) -> None:
    places = [
        middle(face)
        for step in range(-8, 9)
        if columns(face := draw(FaceState(step / 8, 0, emotion, 1), shape))
    ]
    assert places == sorted(places)


def test_an_unknown_emotion_looks_neutral() -> None:
    assert draw(FaceState(0, 0, "bored", 1), USUAL) == NEUTRAL


def test_prepared_faces_are_those_drawn() -> None:
    shape = FaceShape(48, 16)
    prepare(shape)
    assert draw(FaceState(0, 0, "sad", 1), shape) == draw(FaceState(0, 0, "sad", 1.0), shape)


def test_the_documentations_sheet_shows_these_faces() -> None:
    drawn_again = "python -m tools.face_sheet draws it again"
    assert face_sheet.SHEET.read_text("utf-8") == face_sheet.sheet(), drawn_again
