from __future__ import annotations

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.console import bodies
from woz_tui.console.bodies import link_views
from woz_tui.console.bodies.face_lights import brightness_look, frame_of, light_rows, size
from woz_tui.console.bodies.link_views import ABOVE, LAYERS, SIDE, Pose, draw_view, projections
from woz_tui.console.drawing.cells import Row, length
from woz_tui.console.drawing.dot_canvas import DotCanvas
from woz_tui.console.drawing.glyphs import ASCII, UNICODE
from woz_tui.console.state.driver_outlines import BodyOutline, outlines_of
from woz_tui.motion.kinematics import KinematicChain
from woz_tui.motion.light_frames import LightFrame as Lights
from woz_tui.motion.light_frames import blank
from woz_tui.protocol.messages import Json

SIZES = {SIDE: (28, 10), ABOVE: (20, 10)}
FLAT = {SIDE: lambda point: (point[0], point[2]), ABOVE: lambda point: (-point[1], point[0])}
FRAMES = st.builds(
    lambda width, rows: Lights(width, tuple(row % (1 << width) for row in rows)),
    st.integers(8, 64),
    st.lists(st.integers(0, (1 << 64) - 1), min_size=1, max_size=40),
)


def outline() -> BodyOutline:
    found = outlines_of({"body": bodies.EYEPI})["body"]
    assert isinstance(found, BodyOutline)
    return found


def text(rows: list[Row]) -> str:
    return "\n".join("".join(piece for piece, _ in row) for row in rows)


# -- the face -----------------------------------------------------------------------------------


def lights_of_halves(shown: str, width: int, height: int) -> Lights:
    """What an eye reads from half blocks."""
    rows = []
    for line in shown.splitlines():
        rows.append(int("".join(str(int(sign in "▀█")) for sign in line), 2))
        rows.append(int("".join(str(int(sign in "▄█")) for sign in line), 2))
    return Lights(width, tuple(rows[:height]))


def lights_of_braille(shown: str, width: int, height: int) -> Lights:
    """What an eye reads from braille, eight lights a sign."""
    order = ((0, 0x01), (0, 0x08), (1, 0x02), (1, 0x10), (2, 0x04), (2, 0x20), (3, 0x40), (3, 0x80))
    rows = [""] * (4 * len(shown.splitlines()))
    for number, line in enumerate(shown.splitlines()):
        for sign in line:
            bits = 0 if sign == " " else ord(sign) - 0x2800
            for down, bit in order:
                rows[4 * number + down] += str(int(bool(bits & bit)))
    return Lights(width, tuple(int(row[:width], 2) for row in rows[:height]))


@pytest.mark.toolkit("F1", "V1")
@given(FRAMES)
def test_the_face_on_the_screen_is_the_frame_bit_by_bit(frame: Lights) -> None:
    large = light_rows(frame, UNICODE, "face-4", compact=False)
    compact = light_rows(frame, UNICODE, "face-4", compact=True)
    assert lights_of_halves(text(large), frame.width, frame.height) == frame
    assert lights_of_braille(text(compact), frame.width, frame.height) == frame
    for rows, small in ((large, False), (compact, True)):
        columns, lines = size(frame.width, frame.height, compact=small)
        assert [length(row) for row in rows] == [columns] * lines


@pytest.mark.toolkit("F1")
def test_a_matrix_of_24_by_16_takes_24_by_8_cells_or_12_by_4() -> None:
    assert size(24, 16, compact=False) == (24, 8)
    assert size(24, 16, compact=True) == (12, 4)


@given(FRAMES)
def test_in_ascii_every_light_still_shows(frame: Lights) -> None:
    for compact in (False, True):
        drawn = text(light_rows(frame, ASCII, "face-4", compact=compact))
        assert drawn.isascii()
        assert (drawn.strip() == "") == (not any(frame.rows))


def test_brightness_is_one_of_four_looks() -> None:
    looks = [brightness_look(share / 100) for share in range(101)]
    assert looks == sorted(looks)
    assert set(looks) == {"face-1", "face-2", "face-3", "face-4"}
    assert brightness_look(7.0) == "face-4"


def test_a_face_that_makes_no_sense_is_dark() -> None:
    face_shown = bodies.face()
    assert frame_of(face_shown, *bodies.LIGHTS) == bodies.discs()
    assert frame_of(None, 24, 16) == blank(24, 16)
    broken = type(face_shown)(driver="body", width=2, rows="ff zz", emotion="", intensity=0.0)
    assert frame_of(broken, 24, 16) == blank(24, 16)


# -- the links ------------------------------------------------------------------------------------


ANGLES = st.fixed_dictionaries(
    {"pitch": st.floats(-90, 90), "middle": st.floats(0, 90), "top": st.floats(0, 90)}
)


@pytest.mark.toolkit("V1", "V3")
@given(ANGLES)
def test_links_are_where_forward_kinematics_puts_them(angles: dict[str, float]) -> None:
    body = outline()
    points = KinematicChain.of_outline(bodies.EYEPI).points(angles)
    for view, sight in projections(body, SIZES).items():
        drawn = draw_view(body, Pose(angles, angles), sight, SIZES[view]).dots("links", "joints")
        ends = [FLAT[view](point) for point in points]
        exact = [((x - sight.left) * sight.scale, (sight.top - y) * sight.scale) for x, y in ends]
        for x, y in exact:
            near = min(max(abs(x - dot[0]), abs(y - dot[1])) for dot in drawn)
            assert near <= 1.0, "a joint has no dot within rounding"
        links = draw_view(body, Pose(angles, None), sight, SIZES[view]).dots("links")
        for dot in links:
            assert min(_away(dot, a, b) for a, b in itertools.pairwise(exact)) <= 1.5


def _away(dot: tuple[int, int], a: tuple[float, float], b: tuple[float, float]) -> float:
    """How far a dot is from a line between two places."""
    along = (b[0] - a[0], b[1] - a[1])
    size = along[0] ** 2 + along[1] ** 2
    share = ((dot[0] - a[0]) * along[0] + (dot[1] - a[1]) * along[1]) / size if size else 0.0
    share = min(1.0, max(0.0, share))
    off = (dot[0] - a[0] - share * along[0], dot[1] - a[1] - share * along[1])
    return float((off[0] ** 2 + off[1] ** 2) ** 0.5)


@given(ANGLES)
def test_whatever_is_reached_is_on_the_sheet(angles: dict[str, float]) -> None:
    body = outline()
    for view, sight in projections(body, SIZES).items():
        columns, lines = SIZES[view]
        for point in body.chain.points(angles):
            x, y = sight.dot(point)
            assert 0 <= x < 2 * columns
            assert 0 <= y < 4 * lines


@pytest.mark.toolkit("V1")
def test_the_scale_is_the_same_in_both_views_and_whatever_the_robot_does() -> None:
    side, above = (projections(outline(), SIZES)[view] for view in (SIDE, ABOVE))
    assert side.scale == above.scale
    assert projections(outline(), SIZES)[SIDE] == side


@pytest.mark.toolkit("V2", "R3")
@pytest.mark.parametrize(
    ("angles", "view", "eyes"),
    [
        # All zero: the middle link lies forward, the eyes are 0.15 m before the base.
        ({"pitch": 0.0, "middle": 0.0, "top": 0.0}, SIDE, (0.15, 0.09)),
        # Turned to its left: what was before it is at its left.
        ({"pitch": 90.0, "middle": 0.0, "top": 0.0}, ABOVE, (-0.13, 0.02)),
        ({"pitch": -90.0, "middle": 0.0, "top": 0.0}, ABOVE, (0.13, 0.02)),
        # The middle link upright, the top one turned back down: eyes forward at 0.17 m.
        ({"pitch": 0.0, "middle": 90.0, "top": 90.0}, SIDE, (0.07, 0.17)),
    ],
)
def test_the_reference_poses(
    angles: dict[str, float], view: str, eyes: tuple[float, float]
) -> None:
    body = outline()
    sight = projections(body, SIZES)[view]
    x, y = (eyes[0] - sight.left) * sight.scale, (sight.top - eyes[1]) * sight.scale
    dot = sight.dot(body.chain.points(angles)[-1])
    assert abs(dot[0] - x) <= 0.51
    assert abs(dot[1] - y) <= 0.51


@pytest.mark.toolkit("R5", "V3")
def test_where_it_shall_be_is_drawn_dim_beside_where_it_is() -> None:
    body = outline()
    sight = projections(body, SIZES)[SIDE]
    here = {"pitch": 0.0, "middle": 20.0, "top": 20.0}
    there = {"pitch": 0.0, "middle": 80.0, "top": 40.0}
    both = draw_view(body, Pose(here, there), sight, SIZES[SIDE])
    alone = draw_view(body, Pose(there, None), sight, SIZES[SIDE])
    assert both.dots("wanted") == alone.dots("links")
    assert both.dots("links") != both.dots("wanted")
    looks = {look for row in both.rows(UNICODE) for _, look in row}
    assert {"strong", "muted", "run", "faint"} <= looks
    only = draw_view(body, Pose(None, there), sight, SIZES[SIDE])
    assert only.dots("links") == alone.dots("links")
    assert draw_view(body, Pose(None, None), sight, SIZES[SIDE]).dots("links", "joints") == set()


def test_where_the_eyes_look_is_marked() -> None:
    body = outline()
    sight = projections(body, SIZES)[SIDE]
    level = {"pitch": 0.0, "middle": 0.0, "top": 0.0}
    eyes = sight.dot(body.chain.points(level)[-1])
    gaze = draw_view(body, Pose(level, None), sight, SIZES[SIDE]).dots("gaze")
    assert {y for _, y in gaze} == {eyes[1]}
    assert min(x for x, _ in gaze) == eyes[0]
    assert max(x for x, _ in gaze) >= eyes[0] + link_views.GAZE - link_views.SPARSE


def test_views_in_ascii() -> None:
    body = outline()
    pose = Pose(dict.fromkeys(body.home, 30.0), dict(body.home))
    for view, sight in projections(body, SIZES).items():
        rows = draw_view(body, pose, sight, SIZES[view]).rows(ASCII)
        assert text(rows).isascii()
        assert "O" in text(rows)
        assert all(length(row) == SIZES[view][0] for row in rows)


def test_nothing_is_drawn_outside_the_sheet() -> None:
    dots = DotCanvas(3, 2, LAYERS)
    dots.line((-50, -50), (60, 60), "links")
    assert dots.dots("links") == {(n, n) for n in range(6)}
    assert [length(row) for row in dots.rows(UNICODE)] == [3, 3]


@pytest.mark.parametrize(
    "told",
    [
        "no outline",
        {"kind": "body"},
        {"kind": "body", "joints": [{"name": "a"}]},
        {"kind": "body", "joints": "x", "eyes": None, "view": 3},
        {"kind": "hologram", "joints": []},
        {"kind": "panel", "controls": [{"name": 1}]},
    ],
)
def test_outlines_that_cannot_be_read_are_left_out(told: Json) -> None:
    found = outlines_of({"bad": told, "body": bodies.EYEPI})
    assert list(found) == ["body"]
    assert outlines_of({}) == {}
