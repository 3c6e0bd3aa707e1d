"""Key frames, samples and layers: what a move wants at each moment."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from woz_tui.motion.easing import EASINGS, ease, low_pass, swell
from woz_tui.motion.keyframes import KeyFrame, KeyframeMove, LayerSamples, MoveLayer
from woz_tui.motion.move_types import FaceChange, SoundCue

HEAD = MoveLayer(
    "head",
    (
        KeyFrame(1, {"nod": 10}, easing="linear"),
        KeyFrame(2, {"pan": 20}, easing="linear"),
        KeyFrame(4, {"nod": 0, "pan": 0}, easing="linear"),
    ),
)
RECORDED = MoveLayer("recorded", samples=LayerSamples(2, roles={"nod": (0, 4, 4, 0)}))


def move(*layers: MoveLayer, beats: bool = False) -> KeyframeMove:
    return KeyframeMove("test", "a test", layers, beats=beats)


def nod(keyframe_move: KeyframeMove, place: float) -> float:
    return keyframe_move.at(place).roles["nod"]


@pytest.mark.parametrize("name", EASINGS)
def test_easings_lead_from_0_to_1_and_never_back(name: str) -> None:
    values = [ease(name, index / 100) for index in range(-5, 106)]
    assert values[0] == 0 and values[-1] == 1
    assert all(a <= b for a, b in itertools.pairwise(values))


@pytest.mark.parametrize("name", ["smooth", "minimum-jerk"])
def test_soft_easings_begin_and_end_at_rest(name: str) -> None:
    assert ease(name, 0.001) < 1e-4
    assert 1 - ease(name, 0.999) < 1e-4


def test_a_swell_has_no_edge_even_if_its_ramps_are_longer_than_itself() -> None:
    assert [swell(place, 1, 4) for place in (-1, 0, 1, 2)] == [0, 0, 0, 0]
    assert swell(0.5, 1, 0.5) == 1


def test_a_filter_does_not_depend_on_its_steps() -> None:
    value = 0.0
    for _ in range(10):
        value = low_pass(value, 1, 0.3, 0.02)
    assert value == pytest.approx(low_pass(0, 1, 0.3, 0.2))
    assert low_pass(0, 1, 0, 0.02) == 1


def test_a_frame_moves_what_it_names_and_the_rest_stays() -> None:
    keyframe_move = move(HEAD)
    assert [nod(keyframe_move, place) for place in (0, 0.5, 1, 1.5, 2, 3, 4)] == [
        0,
        5,
        10,
        10,
        10,
        5,
        0,
    ]
    assert [keyframe_move.at(place).roles["pan"] for place in (0, 1, 1.5, 2, 3)] == [
        0,
        0,
        10,
        20,
        10,
    ]


def test_before_and_after_it_is_at_its_ends() -> None:
    keyframe_move = move(HEAD)
    assert keyframe_move.length == 4
    assert keyframe_move.at(-1) == keyframe_move.at(math.nan) == keyframe_move.at(0)
    assert keyframe_move.at(9) == keyframe_move.at(4)


def test_a_hold_jumps_at_its_frame() -> None:
    keyframe_move = move(MoveLayer("a", (KeyFrame(1, {"nod": 10}, easing="hold"), KeyFrame(2))))
    assert [nod(keyframe_move, place) for place in (0, 0.999, 1, 2)] == [0, 0, 10, 10]


def test_a_first_frame_at_the_beginning_counts_at_once() -> None:
    keyframe_move = move(
        MoveLayer("a", (KeyFrame(0, {"nod": 6}), KeyFrame(1, {"nod": 8}, easing="linear")))
    )
    assert [nod(keyframe_move, place) for place in (0, 0.5, 1)] == [6, 7, 8]


def test_absolute_joints_take_places_and_begin_with_the_first_they_name() -> None:
    frames = (KeyFrame(1, joints={"top": 40}), KeyFrame(2, joints={"top": 60, "neck": 5}))
    keyframe_move = move(MoveLayer("a", frames, relative=False))
    assert keyframe_move.at(0).places == {"top": 40, "neck": 5}
    assert keyframe_move.at(2).places == {"top": 60, "neck": 5}
    assert keyframe_move.at(1.5).joints == {}


@pytest.mark.toolkit("X2")
def test_layers_play_in_sync_and_are_added() -> None:
    keyframe_move = move(HEAD, RECORDED)
    assert [nod(keyframe_move, place) for place in (0, 0.25, 0.5, 1, 1.25, 1.5, 3)] == [
        0, 2.5 + 2, 5 + 4, 10 + 4, 10 + 2, 10, 5,
    ]  # fmt: skip


@pytest.mark.toolkit("X2")
def test_a_muted_layer_changes_neither_timing_nor_anything_else() -> None:
    long = replace(RECORDED, samples=LayerSamples(1, roles={"nod": (5,) * 10}), muted=True)
    keyframe_move = move(HEAD, long)
    assert keyframe_move.length == 9
    assert [nod(keyframe_move, place) for place in (0.5, 1, 3)] == [5, 10, 5]


@pytest.mark.toolkit("X2")
def test_a_layer_is_blended_by_its_share() -> None:
    assert nod(move(HEAD, replace(RECORDED, share=0.25)), 0.5) == 6
    assert nod(move(HEAD, replace(RECORDED, mix="replace")), 1) == 4
    assert nod(move(HEAD, replace(RECORDED, mix="replace", share=0.5)), 1) == 7
    assert nod(move(HEAD, replace(RECORDED, share=0)), 1) == 10


@pytest.mark.toolkit("X2")
def test_absolute_layers_are_blended_between_each_other() -> None:
    low = MoveLayer("low", samples=LayerSamples(1, joints={"top": (10, 10)}), relative=False)
    high = MoveLayer(
        "high", samples=LayerSamples(1, joints={"top": (50, 50)}), relative=False, share=0.25
    )
    assert move(low, high).at(0.5).places == {"top": 20}
    assert move(high).at(0.5).places == {"top": 50}, "there is nothing below to blend with"


def moods(*frames: KeyFrame, places: tuple[float, ...]) -> list[tuple[str | None, float | None]]:
    keyframe_move = move(MoveLayer("a", frames))
    faces = [keyframe_move.at(place).face or FaceChange() for place in places]
    return [(face.emotion, face.intensity) for face in faces]


def test_an_emotion_comes_on_over_the_way_to_its_frame() -> None:
    frames = (
        KeyFrame(1),
        KeyFrame(2, emotion="happy", intensity=0.8, easing="linear"),
        KeyFrame(3, intensity=0.4, easing="linear"),
    )
    assert moods(*frames, places=(0.5, 1.5, 2, 2.5, 3)) == [
        (None, None), ("happy", 0.4), ("happy", 0.8), ("happy", pytest.approx(0.6)),
        ("happy", 0.4),
    ]  # fmt: skip


def test_one_emotion_goes_before_the_next_comes() -> None:
    frames = (
        KeyFrame(0, emotion="happy"),
        KeyFrame(1, emotion="sad", intensity=0.5, easing="linear"),
        KeyFrame(2, emotion="neutral", easing="linear"),
    )
    assert moods(*frames, places=(0, 0.25, 0.75, 1, 1.5, 2)) == [
        ("happy", 1), ("happy", 0.5), ("sad", 0.25), ("sad", 0.5), ("sad", 0.25), ("neutral", 0),
    ]  # fmt: skip


def test_eyes_and_lids_come_from_where_they_are_when_nobody_says() -> None:
    frames = (KeyFrame(1), KeyFrame(2, x=0.5, lid=0, easing="linear"))
    keyframe_move = move(MoveLayer("a", frames))
    assert keyframe_move.at(0.5).face is None
    assert keyframe_move.at(1.5).face == FaceChange(x=0.25, lid=0.5)


def test_the_upper_layer_s_face_wins() -> None:
    low = MoveLayer("low", (KeyFrame(1, emotion="sad", intensity=1, lid=0.2),))
    high = MoveLayer("high", (KeyFrame(1, emotion="happy", intensity=0.5),))
    assert move(low, high).at(1).face == FaceChange("happy", 0.5, lid=0.2)
    assert move(low, replace(high, muted=True)).at(1).face == FaceChange("sad", 1, lid=0.2)


def test_sounds_are_cues_in_order_but_for_muted_layers() -> None:
    one = MoveLayer("one", (KeyFrame(2, sound="/b.wav"), KeyFrame(3)))
    two = MoveLayer("two", (KeyFrame(1, sound="/a.wav", volume=0.5),), share=0.5)
    assert move(one, two).cues == (SoundCue(1, "/a.wav", 0.25), SoundCue(2, "/b.wav", 1))
    assert move(one, replace(two, muted=True)).cues == (SoundCue(2, "/b.wav", 1),)


values = st.lists(st.floats(-90, 90), min_size=1, max_size=20).map(tuple)


@given(values, st.floats(1, 100), st.floats(-5, 50))
def test_samples_stay_between_their_neighbours(
    given_values: tuple[float, ...], rate: float, place: float
) -> None:
    keyframe_move = move(
        HEAD, MoveLayer("r", samples=LayerSamples(rate, joints={"top": given_values}))
    )
    value = keyframe_move.at(place).joints["top"]
    assert min(given_values) - 1e-9 <= value <= max(given_values) + 1e-9


@given(
    st.lists(
        st.tuples(st.floats(0.01, 2), st.floats(-90, 90), st.sampled_from(sorted(EASINGS))),
        min_size=1,
        max_size=10,
    )
)
def test_frames_reach_what_they_say_and_do_not_overshoot(
    legs: list[tuple[float, float, str]],
) -> None:
    frames, at = [], 0.0
    for seconds, angle, easing in legs:
        at += seconds
        frames.append(KeyFrame(at, {"nod": angle}, easing=easing))
    keyframe_move = move(MoveLayer("a", tuple(frames)))
    angles = [0.0, *(angle for _, angle, _ in legs)]
    for frame in frames:
        assert nod(keyframe_move, frame.at) == pytest.approx(frame.roles["nod"])
    for index in range(101):
        assert min(angles) - 1e-9 <= nod(keyframe_move, at * index / 100) <= max(angles) + 1e-9
