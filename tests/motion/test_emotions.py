"""Moods as emotions: every place on the circle, the middle, the corners, and no number at all."""

from __future__ import annotations

import math

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from woz_tui.drivers.contract import RejectedError
from woz_tui.motion.body_verbs import EMOTIONS
from woz_tui.motion.emotions import DIRECTIONS, SECTORS, affect_emotion, emotion_affect, emotion_at

UNIT = st.floats(-1, 1)
#: A share that does not take a mood below what a float can hold.
SHARE = st.floats(1e-6, 1)


def at(degrees: float, length: float = 1.0) -> tuple[float, float]:
    angle = math.radians(degrees)
    return length * math.cos(angle), length * math.sin(angle)


@pytest.mark.toolkit("F4")
@pytest.mark.parametrize(
    ("degrees", "emotions"),
    [
        (0, {"happy"}),
        (45, {"happy", "amazed"}),
        (90, {"amazed"}),
        (135, {"angry"}),
        (180, {"sad", "angry"}),
        (225, {"sad"}),
        (270, {"sleepy"}),
        (315, {"sleepy", "happy"}),
    ],
)
def test_emotions_stand_around_the_circle(degrees: float, emotions: set[str]) -> None:
    emotion, intensity = affect_emotion(*at(degrees, 0.5))
    assert emotion in emotions
    assert intensity == pytest.approx(0.5)


@pytest.mark.toolkit("F4")
@given(UNIT, UNIT, SHARE)
@example(0.5, math.sqrt(3) / 2, 1 / 3)  # on a border, but for rounding
@example(-1.0, -0.0, 0.5)
def test_a_fading_mood_stays_the_same_emotion(valence: float, arousal: float, share: float) -> None:
    if math.hypot(valence, arousal) < 1e-6:
        valence = 0.25
    emotion, intensity = affect_emotion(valence, arousal)
    faded, weaker = affect_emotion(share * valence, share * arousal)
    assert faded == emotion
    assert weaker == pytest.approx(min(1.0, share * math.hypot(valence, arousal)))
    assert 0 < weaker <= intensity <= 1


@pytest.mark.toolkit("F4")
def test_the_middle_is_neutral_and_the_first_step_out_of_it_is_not_another_emotion() -> None:
    assert affect_emotion(0, 0) == affect_emotion(-0.0, -0.0) == ("neutral", 0)
    for degrees in range(-180, 180, 3):
        full, _ = affect_emotion(*at(degrees))
        first, intensity = affect_emotion(*at(degrees, 1 / 64))
        assert first == full
        assert intensity == pytest.approx(1 / 64)


@pytest.mark.toolkit("F4")
@given(UNIT, UNIT)
def test_every_mood_has_one_emotion_and_at_most_full_intensity(
    valence: float, arousal: float
) -> None:
    emotion, intensity = affect_emotion(valence, arousal)
    assert emotion in EMOTIONS
    assert 0 <= intensity <= 1
    assert (emotion == "neutral") == (intensity == 0)


@pytest.mark.toolkit("F4")
def test_corners_are_no_stronger_than_the_edge() -> None:
    assert [affect_emotion(v, a) for v, a in [(1, 1), (-1, 1), (-1, -1), (1, -1)]] == [
        ("happy", 1),
        ("angry", 1),
        ("sad", 1),
        ("sleepy", 1),
    ]
    assert affect_emotion(7, 0) == ("happy", 1)


def test_both_names_of_one_direction_are_one_emotion() -> None:
    assert emotion_at(180) == emotion_at(-180) == emotion_at(540) == "sad"
    assert affect_emotion(-1, 0.0) == affect_emotion(-1, -0.0)


def test_a_border_belongs_to_what_begins_there() -> None:
    starts = [start for start, _ in SECTORS]
    assert starts == sorted(starts)
    for start, emotion in SECTORS:
        assert emotion_at(start) == emotion
        assert emotion_at(start - 0.001) != emotion


@pytest.mark.toolkit("F4", "R4")
@pytest.mark.parametrize("wrong", [math.nan, math.inf, -math.inf])
def test_what_is_no_number_is_refused(wrong: float) -> None:
    for mood in ((wrong, 0.0), (0.0, wrong)):
        with pytest.raises(RejectedError, match="no place on the circle"):
            affect_emotion(*mood)


@pytest.mark.toolkit("F5")
@given(st.sampled_from(sorted(set(DIRECTIONS) - {"friendly"})), st.floats(0.001, 1))
def test_knobs_stand_where_the_emotion_is(emotion: str, intensity: float) -> None:
    seen, strength = affect_emotion(*emotion_affect(emotion, intensity))
    assert seen == emotion
    assert strength == pytest.approx(intensity)


@given(st.sampled_from((*EMOTIONS, "no such")), st.floats(allow_nan=True))
def test_knobs_always_stand_somewhere(emotion: str, intensity: float) -> None:
    assert math.hypot(*emotion_affect(emotion, intensity)) <= 1 + 1e-9
    assert emotion_affect(emotion, 0) == (0, 0)
