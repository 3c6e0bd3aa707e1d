"""Tracks, gaze and who is addressed, on made-up faces."""

from __future__ import annotations

import math
from typing import Any

import pytest
from woz_drivers.faces.face_lines import SeenFace
from woz_drivers.faces.face_tracks import (
    AddressedPerson,
    FaceTrack,
    FaceTracker,
    direction_of,
    distance_of,
    judge_gaze,
)

TICK_US = 100_000
#: 640 pixels and 60 degrees.
FOCAL = 320 / math.tan(math.radians(30))


def face(x: float, side: float = 100, score: float = 0.9, **more: float) -> SeenFace:
    box = {"left": x - side / 2, "right": x + side / 2, "top": 100.0, "bottom": 100 + side}
    seen: dict[str, Any] = box | {"yaw": 0.0, "pitch": 10.0} | more
    return SeenFace(width=side, score=score, **seen)


def ids(there: list[FaceTrack]) -> list[int]:
    return [track.id for track in there]


def course(tracker: FaceTracker, *pictures: list[SeenFace]) -> list[list[int]]:
    """The ids after each of pictures that are a tenth of a second apart."""
    return [ids(tracker.update(faces, n * TICK_US)) for n, faces in enumerate(pictures)]


def test_a_face_keeps_its_number_while_it_moves() -> None:
    moving = [[face(100 + 40 * n)] for n in range(8)]
    assert course(FaceTracker(0.7), *moving)[1:] == [[1]] * 7


def test_what_is_found_in_one_picture_alone_is_nobody() -> None:
    once = [face(100)]
    assert course(FaceTracker(0.7), once, [], [], once, [], [], once) == [[]] * 7


def test_a_doubtful_face_begins_no_track_but_continues_one() -> None:
    doubtful, sure = [face(100, score=0.45)], [face(100)]
    assert course(FaceTracker(0.7), doubtful, doubtful, doubtful) == [[]] * 3
    tracks = course(FaceTracker(0.0), sure, sure, doubtful, doubtful)
    assert tracks == [[], [1], [1], [1]]


def test_who_is_not_found_for_a_moment_is_there_and_has_the_same_number_again() -> None:
    here = [face(100)]
    there = course(FaceTracker(0.7), here, here, [], [], [], [], here)
    assert there[1:] == [[1]] * 6


def test_who_is_gone_for_longer_is_gone_and_somebody_new_later() -> None:
    here = [face(100)]
    there = course(FaceTracker(0.25), here, here, [], [], [], here, here)
    assert there == [[], [1], [1], [1], [], [], [2]]


def test_two_who_cross_keep_their_numbers() -> None:
    """The one behind is hidden for three pictures."""
    pictures = []
    for n in range(17):
        near, far = face(100 + 25 * n, side=120), face(500 - 25 * n, side=80)
        hidden = abs(near.left + 60 - far.left - 40) < 60
        pictures.append([near] if hidden else [near, far])
    assert [len(one) for one in pictures].count(1) == 3
    tracker = FaceTracker(0.7)
    course(tracker, *pictures)
    ends = tracker.update(pictures[-1], 17 * TICK_US)
    assert {one.id: one.face.width for one in ends} == {1: 120, 2: 80}


def test_a_far_smaller_face_at_the_same_place_is_somebody_else() -> None:
    near, far = [face(100, side=200)], [face(100, side=60)]
    assert course(FaceTracker(0.0), near, near, far, far) == [[], [1], [], [2]]


# -- distance and direction ------------------------------------------------------------------------


def test_half_as_wide_is_twice_as_far() -> None:
    one, other = distance_of(face(0, 80), FOCAL), distance_of(face(0, 40), FOCAL)
    assert other == pytest.approx(2 * one)
    assert one == pytest.approx(0.97, abs=0.01)


@pytest.mark.parametrize(("x", "degrees"), [(0, 30), (320, 0), (640, -30)])
def test_the_edges_of_the_picture_are_half_the_field_of_view_away(x: float, degrees: float) -> None:
    assert direction_of(face(x), 640, FOCAL) == pytest.approx(degrees)


# -- gaze ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("seen", "looks"),
    [
        (face(0, yaw=14), True),
        (face(0, yaw=16), False),
        (face(0, yaw=-16), False),
        (face(0, pitch=24), True),
        (face(0, pitch=-6), False),
        (face(0, yaw=25, eyes_yaw=-20), True),
        (face(0, yaw=0, eyes_yaw=20), False),
        (face(0, yaw=11, pitch=21), False),
    ],
)
def test_head_and_eyes_together_decide_who_looks(seen: SeenFace, looks: bool) -> None:
    track = FaceTrack(1, seen, 0)
    judge_gaze(track, (0, 10), 15)
    assert track.looks is looks


def test_a_gaze_at_the_border_does_not_flicker() -> None:
    track = FaceTrack(1, face(0), 0)
    verdicts = []
    for yaw in (0, 16, 19, 21, 19, 16, 14):
        track.face = face(0, yaw=yaw)
        judge_gaze(track, (0, 10), 15)
        verdicts.append(track.looks)
    assert verdicts == [True, True, True, False, False, False, True]


def test_nobody_knows_where_a_face_looks_that_was_not_looked_at_closely() -> None:
    track = FaceTrack(1, SeenFace(left=0, top=0, right=9, bottom=9, width=9), 0, looks=True)
    judge_gaze(track, (0, 10), 15)
    assert track.looks is None


# -- who is addressed ------------------------------------------------------------------------------


def person(number: int, distance: float, looks: bool | None = False) -> FaceTrack:
    return FaceTrack(number, face(0), 0, pictures=2, looks=looks, distance=distance)


def chosen(who: AddressedPerson, there: list[FaceTrack], seconds: float) -> list[int | None]:
    """Who it is at the beginning and after so many seconds."""
    found = [who.update(there, 0), who.update(there, round(seconds * 1e6))]
    return [None if one is None else one.id for one in found]


def test_the_nearest_who_looks_is_addressed() -> None:
    there = [person(1, 0.8), person(2, 1.5, looks=True), person(3, 2.0, looks=True)]
    assert chosen(AddressedPerson(), there, 0) == [2, 2]


def test_if_nobody_looks_it_is_the_nearest_and_it_stays_who_it_was() -> None:
    who = AddressedPerson()
    assert chosen(who, [person(1, 1.2), person(2, 0.9)], 0) == [2, 2]
    assert chosen(who, [person(1, 0.5), person(2, 0.9)], 5) == [2, 2]


def test_somebody_else_has_to_look_from_nearer_for_a_second() -> None:
    who = AddressedPerson()
    first = [person(1, 1.0, looks=True), person(2, 1.1, looks=True)]
    assert chosen(who, first, 0) == [1, 1]
    other = [person(1, 1.2, looks=True), person(2, 1.1, looks=True)]
    assert chosen(who, other, 0.9) == [1, 1]
    assert chosen(who, first, 0.9) == [1, 1]
    assert chosen(who, other, 1.1) == [1, 2]


def test_who_leaves_is_replaced_at_once_and_nobody_is_nobody() -> None:
    who = AddressedPerson()
    who.update([person(1, 1.0, looks=True), person(2, 2.0)], 0)
    assert chosen(who, [person(2, 2.0)], 0) == [2, 2]
    assert chosen(who, [], 0) == [None, None]


def test_the_wizards_choice_holds_until_they_leave() -> None:
    who = AddressedPerson()
    there = [person(1, 1.0, looks=True), person(2, 2.0), person(5, 3.0)]
    who.update(there, 0)
    assert who.next_of(there) == 2
    who.choose(5)
    assert chosen(who, there, 60) == [5, 5]
    assert who.next_of(there) == 1
    assert chosen(who, there[:2], 60) == [1, 1]
    assert not who.by_hand


def test_back_to_the_rule_means_after_a_second_whom_the_rule_wants() -> None:
    who = AddressedPerson()
    there = [person(1, 1.0, looks=True), person(2, 2.0)]
    who.update(there, 0)
    who.choose(2)
    assert chosen(who, there, 3) == [2, 2]
    who.choose(None)
    assert chosen(who, there, 1.1) == [2, 1]
