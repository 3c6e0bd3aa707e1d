"""Loudness now and then, cut into speech by the time that passes."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.sensing.visitor_samples import PERIOD, WITH, Visit
from woz_tui.config.engagement import SoundSettings
from woz_tui.sensing.loudness_speech import PUBLISHED_THRESHOLD, LoudnessSpeechDetector
from woz_tui.sensing.model_time import SECOND
from woz_tui.sensing.state_machine import Event, State


def voice_events(
    voice: LoudnessSpeechDetector, *values: object, period: int = PERIOD
) -> list[Event | None]:
    """What each of so many values brings, one period apart."""
    return [voice.add(value, number * period)[1] for number, value in enumerate(values, start=1)]


START, END = Event.SPEECH_START, Event.SPEECH_END


def test_speech_begins_strictly_above_the_threshold() -> None:
    voice = LoudnessSpeechDetector(SoundSettings(threshold=0.1))
    assert voice_events(voice, 0.1, 0.11) == [None, START]


@pytest.mark.parametrize("period", [SECOND // 3, 333_000, 100_000, 20_000, 10_000, 1_000])
def test_a_second_of_quiet_ends_it_whatever_the_rate(period: int) -> None:
    """With the very chunk. Also where stamps are rounded: three times 0.333 s are a second."""
    chunks = round(SECOND / period)
    events = voice_events(
        LoudnessSpeechDetector(SoundSettings(threshold=0.1)), 0.5, *[0.0] * chunks, period=period
    )
    assert events == [START, *[None] * (chunks - 1), END]


@given(st.data(), st.sampled_from([SECOND // 3, 100_000, 10_000]), st.integers(2, 40))
def test_chunks_that_come_a_little_early_or_late_count_as_on_time(
    data: st.DataObject, period: int, chunks: int
) -> None:
    """An eighth of a period, either way, at every chunk."""
    late = st.integers(-period // 8, period // 8)
    times = [number * period + data.draw(late) for number in range(1, chunks + 3)]
    levels = [0.0, 0.5, *[0.0] * chunks]
    voice = LoudnessSpeechDetector(SoundSettings(threshold=0.1, hang_over=chunks * period / SECOND))
    events = [voice.add(level, t)[1] for level, t in zip(levels, times, strict=True)]
    assert events == [None, START, *[None] * (chunks - 1), END]


def test_after_a_hole_in_the_sound_the_hang_over_is_not_cut_short() -> None:
    voice = LoudnessSpeechDetector(SoundSettings(threshold=0.1))
    times = [100_000, 200_000, 1_000_000, 1_100_000, 1_200_000]
    levels = [0.0, 0.5, 0.0, 0.0, 0.0]
    events = [voice.add(level, t)[1] for level, t in zip(levels, times, strict=True)]
    assert events == [None, START, None, None, END]


def test_a_pause_within_a_sentence_does_not_end_it() -> None:
    voice = LoudnessSpeechDetector(SoundSettings(threshold=0.1))
    assert voice_events(voice, 0.5, 0.0, 0.0, 0.5, 0.0, 0.0, math.nan) == [START, *[None] * 5, END]


def test_nothing_and_rubbish_are_no_chunks() -> None:
    voice = LoudnessSpeechDetector(SoundSettings(threshold=0.1))
    assert [voice.add(value, SECOND)[0] for value in (None, "x", -1, 2.0, math.inf)] == [False] * 5
    assert voice.level is None
    assert voice.add(math.nan, SECOND) == (True, None)


def test_the_threshold_is_the_settings_or_what_the_microphone_learnt_or_the_published_one() -> None:
    voice = LoudnessSpeechDetector(SoundSettings())
    assert voice.threshold == PUBLISHED_THRESHOLD == 2400 / 32768
    for junk in (None, math.nan, -1.0, "x", math.inf):
        voice.tell_threshold(junk)
    assert voice.threshold == PUBLISHED_THRESHOLD
    voice.tell_threshold(0.02)
    assert voice.threshold == 0.02
    fixed = LoudnessSpeechDetector(SoundSettings(threshold=0.3))
    fixed.tell_threshold(0.02)
    assert fixed.threshold == 0.3
    fixed.adopt(SoundSettings(threshold=0.2))
    assert fixed.threshold == 0.2
    fixed.adopt(SoundSettings())
    assert fixed.threshold == 0.02, "told meanwhile"


def test_loudness_moves_the_machine() -> None:
    visit = Visit(sound=SoundSettings(threshold=0.1)).engage()
    assert [c.outcome for c in visit.see(2, **WITH, loudness=0.5)] == ["listening"]
    assert [c.outcome for c in visit.see(3, **WITH, loudness=0.01)] == ["done"]
    assert visit.model.state is State.THINKS


def test_a_microphone_that_dies_ends_the_speech() -> None:
    visit = Visit(sound=SoundSettings(threshold=0.1)).engage()
    visit.see(2, **WITH, loudness=0.5)
    assert [c.outcome for c in visit.see(4, **WITH)] == ["done"]


def test_a_microphone_that_cuts_speech_itself_is_believed() -> None:
    visit = Visit(sound=SoundSettings(threshold=0.1)).engage()
    visit.model.cuts = True
    assert visit.see(9, **WITH, loudness=0.5) == []
    assert visit.see(9, **WITH, loudness=0.0) == []
    assert visit.event(Event.SPEECH_START) is not None


def test_speech_while_the_robot_talks_is_not_heard() -> None:
    """The robot's own voice may be what is loud."""
    visit = Visit(sound=SoundSettings(threshold=0.1)).engage()
    visit.event(Event.ROBOT_INITIATIVE)
    assert visit.see(9, **WITH, loudness=0.5) == []
    assert visit.event(Event.SAY_DONE) is not None
    assert visit.see(9, **WITH, loudness=0.0) == []


def test_sound_that_stays_away_ends_speech_after_a_second_at_the_earliest() -> None:
    """A sensor that speaks once in a second is no silence, however brief the hang-over."""
    voice = LoudnessSpeechDetector(SoundSettings(threshold=0.1, hang_over=0.3))
    assert voice.add(0.5, 0)[1] is START
    assert voice.pass_to(SECOND) is None
    assert voice.ends_at() == SECOND + 1
    assert voice.pass_to(SECOND + 1) is END
