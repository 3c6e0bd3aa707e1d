"""What the robot's memory holds, whatever that is, as values with a meaning or as nothing."""

from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from woz_drivers.naoqi_robot import memory, senses
from woz_drivers.naoqi_robot.camera import CameraFrame, frame

LEAVES = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.floats(),
    st.text(max_size=8),
    st.binary(max_size=8),
    st.sampled_from([10**400, -(10**400), 2.0**60]),
)
#: Whatever another version of NAOqi might put there.
ANYTHING = st.recursive(
    LEAVES, lambda inner: st.lists(inner, max_size=6) | st.tuples(inner, inner), max_leaves=20
)

NUMBERS = st.floats(allow_nan=True) | st.integers() | st.none()
PLACE = st.lists(NUMBERS, min_size=3, max_size=7)
#: Nearly what ALFaceDetection writes.
FACES = st.tuples(
    PLACE,
    st.lists(
        st.tuples(
            st.lists(NUMBERS, min_size=4, max_size=6),
            st.lists(LEAVES | st.lists(LEAVES, max_size=4), max_size=5),
        )
        | ANYTHING,
        max_size=4,
    ),
)


@given(ANYTHING)
def test_no_value_of_the_memory_raises_and_every_number_is_in_its_range(value: Any) -> None:
    assert memory.number(value) is None or math.isfinite(memory.number(value) or 0)
    metres = memory.sonar(value)
    assert metres is None or 0 < metres <= memory.SONAR_REACH_M
    for share in (memory.battery(value), memory.loudness(value)):
        assert share is None or 0 <= share <= 1
    far = senses.metres(value)
    assert far is None or 0 < far <= senses.REACH_M
    assert senses.looks(value) in (None, True, False)
    ids = senses.visible(value)
    assert ids is None or all(one >= 0 for one in ids)


@given(ANYTHING | FACES)
def test_no_face_raises(value: Any) -> None:
    found = senses.face(value)
    assert found is None or found.name == found.name.strip()
    assert found is None or found.score is None or 0 <= found.score <= 1


@given(ANYTHING | st.tuples(PLACE, PLACE, PLACE, PLACE))
def test_no_sound_raises_and_each_has_a_direction(value: Any) -> None:
    found = memory.sound(value)
    assert found is None or -180 <= found.degrees <= 180


@given(
    ANYTHING | st.tuples(*[NUMBERS | ANYTHING] * 4, NUMBERS, NUMBERS, st.binary(max_size=64)),
)
def test_no_picture_raises_and_each_has_all_its_pixels(value: Any) -> None:
    found = frame(value)
    if isinstance(found, CameraFrame):
        assert len(found.rgb) == 3 * found.width * found.height
    else:
        assert found


@given(
    st.lists(st.integers(0, 9), max_size=10),
    st.dictionaries(st.integers(0, 9), st.floats(0.1, 20.0) | ANYTHING),
)
def test_nobody_is_nearer_than_the_nearest(ids: list[int], far: dict[int, Any]) -> None:
    values = {senses.distance_key(one): value for one, value in far.items()}
    found = senses.nearest(ids, values)
    known = [one for one in ids if one in far]
    if found is None:
        assert not known
        return
    assert found.id in known
    measured = [value for one in known if (value := senses.metres(far[one])) is not None]
    assert found.distance == (min(measured) if measured else None)


@pytest.mark.parametrize(
    ("value", "metres"),
    [(0.3, 0.3), (5, 5.0), (0.0, None), (-1.0, None), (11.0, None), (True, None), ("1", None)],
)
def test_the_sonar(value: Any, metres: float | None) -> None:
    assert memory.sonar(value) == metres


@pytest.mark.parametrize(
    ("energy", "loudness"),
    [(0.0, 0.0), (3276.8, 0.1), (32768.0, 1.0), (99999.0, 1.0), (-1.0, None), ("x", None)],
)
def test_energy_counts_up_to_full_scale(energy: Any, loudness: float | None) -> None:
    assert memory.loudness(energy) == loudness


def test_a_sounds_direction_counts_from_the_robot_not_from_its_head() -> None:
    head = [0.0, 0.0, 1.2, 0.0, 0.0, math.radians(30)]
    seen = [[100, 5], [math.radians(20), 0.1, 0.8, 0.5], head, head]
    found = memory.sound(seen)
    assert found is not None
    assert found.degrees == pytest.approx(50)
    assert found.stamp == (100.0, 5.0)
    without_head = memory.sound([[100, 5], [math.radians(-20), 0.1, 0.8]])
    assert without_head is not None
    assert without_head.degrees == pytest.approx(-20)


def test_behind_is_half_a_turn_at_most() -> None:
    found = memory.sound([[1, 0], [math.radians(200), 0.0, 1.0]])
    assert found is not None
    assert found.degrees == pytest.approx(-160)


@pytest.mark.parametrize(
    ("value", "ids"),
    [([], ()), ([7, 8, 7], (7, 8)), ((3.0,), (3,)), ([1.5], None), ([-1], None), ([True], None)],
)
def test_who_is_visible(value: Any, ids: tuple[int, ...] | None) -> None:
    assert senses.visible(value) == ids


def test_not_more_people_than_fit_into_a_question() -> None:
    assert len(senses.visible(list(range(1000))) or ()) == 20


def _face(size: float, name: str, score: float = 0.6) -> list[Any]:
    return [[0, 0.1, 0.1, size, size], [12, score, name, [0.0] * 14]]


@pytest.mark.parametrize(
    ("value", "name", "score"),
    [
        ([], "", None),
        (None, "", None),
        ([[1, 2], [_face(0.2, "V1"), [2, ["V1"]]], [0.0] * 6], "V1", 0.6),
        ([[1, 2], [_face(0.1, "far"), _face(0.3, "near"), [3, ["far", "near"]]]], "near", 0.6),
        ([[1, 2], [_face(0.2, "", 0.0), [2, ["V7"]]]], "V7", 0.0),
        ([[1, 2], [_face(0.2, "", 0.0), [4]]], "", 0.0),
        ([[1, 2], [[_face(0.2, "x")[0], [[12, 0.4, "old"]]], []]], "old", 0.4),
        ([[1, 2], [[_face(0.2, "x")[0], []], []]], "", None),
        ([[1, 2], []], "", None),
    ],
)
def test_whose_face_it_is(value: Any, name: str, score: float | None) -> None:
    assert senses.face(value) == senses.RecognisedFace(name, score)


@pytest.mark.parametrize(
    "value",
    ["V1", 5, [1, 2], [[1, 2], "V1"], [[1, 2], [5, 6]], [[1], [[[0, 0, 0, 1, 1], [1, 2, 3]]]]],
)
def test_what_is_no_face_is_said_to_be_none(value: Any) -> None:
    assert senses.face(value) is None


def test_a_picture_in_the_other_order_of_colours() -> None:
    found: CameraFrame | str = frame([2, 1, 3, 13, 10, 500_000, b"\1\2\3\4\5\6", 0])
    assert found == CameraFrame(2, 1, b"\3\2\1\6\5\4", 10.5)


@pytest.mark.parametrize(
    ("said", "words"),
    [
        (None, "gives no picture"),
        ([0, 0, 3, 11, 0, 0, b""], "no size"),
        ([1, 1, 1, 0, 0, 0, b"\0"], "unknown kind"),
        ([1, 1, 3, 11, 0, 0, b"\0\0"], "broken: 2 bytes for 1 x 1"),
        ([1, 1, 3, 11, 0, 0, [1, 2, 3]], "no pixels"),
    ],
)
def test_why_there_is_no_picture(said: Any, words: str) -> None:
    found = frame(said)
    assert isinstance(found, str)
    assert words in found
