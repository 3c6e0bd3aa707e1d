"""Sounds that go with a mood: what is measured of them follows the table, and nothing else."""

from __future__ import annotations

import itertools
import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from woz_drivers.sound import pcm_audio
from woz_drivers.sound.emotion_sound import (
    RATE,
    SoundCues,
    cue_table,
    cues,
    emotion_sound,
    mood,
    voiced_level,
)
from woz_drivers.sound.wav import Wav
from woz_drivers.speech.gibberish import phonemes

from tools.emotion_sounds import SoundMeasures, measured
from woz_tui.motion.emotions import DIRECTIONS, FEELINGS, emotion_affect

UNIT = st.floats(-1, 1)


def sound(emotion: str, seconds: float = 3.0, seed: int = 7) -> Wav:
    return emotion_sound(*emotion_affect(emotion, 1.0), seconds, seed)


def measures(valence: float, arousal: float, seed: int) -> SoundMeasures:
    return measured(emotion_sound(valence, arousal, 3.0, seed))


@pytest.mark.toolkit("X5")
def test_the_same_mood_length_and_seed_are_the_same_samples() -> None:
    assert sound("happy") == sound("happy")
    assert sound("happy", seed=8) != sound("happy")


@given(UNIT, UNIT, st.floats(0.2, 10), st.integers(0, 2**31 - 1), st.floats(110, 1760))
def test_any_mood_is_a_sound_of_its_length_that_is_not_cut_off(
    valence: float, arousal: float, seconds: float, seed: int, register: float
) -> None:
    made = emotion_sound(valence, arousal, seconds, seed, register=register)
    samples = pcm_audio.decode(made.data, made.format, made.channels)
    assert made.seconds == pytest.approx(seconds, abs=1 / RATE)
    assert 0 < np.abs(samples).max() < pcm_audio.CLIPPED


@pytest.mark.parametrize("seed", range(5))
def test_arousal_is_faster_louder_and_brighter_whatever_the_valence(seed: int) -> None:
    for valence in (-1.0, 0.0, 1.0):
        steps = [measures(valence, arousal, seed) for arousal in (-1.0, -0.3, 0.4, 1.0)]
        for calm, excited in itertools.pairwise(steps):
            assert excited.notes > calm.notes
            assert excited.level > calm.level
            assert excited.centroid > calm.centroid


@pytest.mark.parametrize("seed", range(5))
def test_valence_is_the_way_that_the_melody_goes_and_not_how_high_it_is(seed: int) -> None:
    bad, good = (measures(valence, 0.0, seed) for valence in (-1.0, 1.0))
    assert bad.rise < 0 < good.rise
    assert cues(-1.0, 0.3).register == cues(1.0, 0.3).register


def test_only_what_is_unpleasant_and_excited_is_rough() -> None:
    depth = {name: cues(*emotion_affect(name, 1.0)).roughness for name in DIRECTIONS}
    assert max(depth, key=depth.__getitem__) == "angry"
    assert depth["happy"] == depth["friendly"] == 0.0


def test_the_mode_is_minor_below_the_middle_and_major_from_there_on() -> None:
    assert [cues(valence, 0.0).third for valence in (-1.0, -0.01, 0.0, 1.0)] == [3, 3, 4, 4]


@pytest.mark.toolkit("X5")
def test_six_emotions_are_six_sounds() -> None:
    made = {name: measured(sound(name)) for name in DIRECTIONS}
    ordered = sorted(made, key=lambda name: made[name].notes)
    assert (ordered[0], ordered[-1]) == ("sleepy", "amazed")
    for one, other in itertools.combinations(made.values(), 2):
        far = abs(one.rise - other.rise) > 1 or abs(one.notes - other.notes) > 0.3
        assert far, (one, other)


@pytest.mark.toolkit("X5")
@pytest.mark.parametrize("emotion", [*DIRECTIONS])
def test_intensity_leads_from_neutral_to_the_whole_emotion(emotion: str) -> None:
    def made(intensity: float) -> Wav:
        return emotion_sound(*mood({"emotion": emotion, "intensity": intensity}), 1.0, 7)

    steps = [made(share) for share in (0.0, 0.5, 1.0)]
    assert len({step.data for step in steps}) == 3
    assert made(0.0).data == emotion_sound(*mood({"emotion": "neutral"}), 1.0, 7).data


def test_every_cue_names_a_source_that_the_table_has() -> None:
    table = cue_table()
    assert {cue.name for cue in table.cues} == {*SoundCues.__dataclass_fields__}
    for cue in table.cues:
        assert cue.sources
        assert {*cue.sources} <= {*table.sources}


def test_a_mood_in_numbers_stands_in_place_of_the_emotion() -> None:
    assert mood({"emotion": "happy", "intensity": 0.5}) == emotion_affect("happy", 0.5)
    assert mood({"emotion": "happy", "valence": -0.5, "arousal": 0.1}) == (-0.5, 0.1)
    assert mood({}) == (0.0, 0.0)
    assert all(mood({"emotion": name})[0] is not None for name in FEELINGS)


def test_how_loud_it_is_follows_its_notes() -> None:
    levels = voiced_level(sound("sad"), 0.04)
    assert len(levels) == 75
    assert max(levels) == 1.0
    assert min(levels) < 0.1


def test_gibberish_is_as_many_syllables_as_the_table_has_and_the_same_by_its_seed() -> None:
    made = cues(*emotion_affect("happy", 1.0))
    assert phonemes(made, 3.0, 1) == phonemes(made, 3.0, 1) != phonemes(made, 3.0, 2)
    assert len(re.findall("[aeiou]", phonemes(made, 3.0, 1))) == made.notes(3.0)
