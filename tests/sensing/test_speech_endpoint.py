"""Segments of speech, against the reference rules applied to the whole recording at once."""

from __future__ import annotations

import math
from collections.abc import Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from woz_tui.sensing.speech_endpoint import Endpointer, SpeechEnd, SpeechStart

QUIET, EDGE, LOUD = 0.0, 0.1, 0.2
_LEVELS = st.sampled_from([QUIET, EDGE, LOUD, math.nan, math.inf, None])
_SOUND = st.lists(_LEVELS, max_size=80)
_HANG, _PRE, _ONSET = st.integers(1, 6), st.integers(0, 5), st.integers(1, 4)


def run(
    endpointer: Endpointer, sound: Sequence[float | None]
) -> list[tuple[int, SpeechStart | SpeechEnd]]:
    """What was told, with the number of the chunk at which it was."""
    told = [(number, endpointer.judge(level)) for number, level in enumerate(sound)]
    return [(number, what) for number, what in told if what is not None]


def segments(
    sound: Sequence[float | None], hang: int, pre: int, onset: int
) -> list[tuple[int, int]]:
    """The rules in words, by search; an open segment has the end -1."""
    loud = [level is not None and level > EDGE for level in sound]
    found: list[tuple[int, int]] = []
    at = 0
    while True:
        begins = [i for i in range(at, len(loud) - onset + 1) if all(loud[i : i + onset])]
        if not begins:
            return found
        begin = begins[0]
        first = max(found[-1][1] + 1 if found else 0, begin - pre, 0)
        ends = [
            i
            for i in range(begin + onset + hang - 1, len(loud))
            if not any(loud[i - hang + 1 : i + 1])
        ]
        if not ends:
            return [*found, (first, -1)]
        found.append((first, ends[0]))
        at = ends[0] + 1


@given(_SOUND, _HANG, _PRE, _ONSET)
def test_segments_are_those_of_the_rules(
    sound: Sequence[float | None], hang: int, pre: int, onset: int
) -> None:
    told = run(Endpointer(EDGE, hang, pre, onset=onset), sound)
    begun = [what.first for _, what in told if isinstance(what, SpeechStart)]
    ended = [(what.first, what.last) for _, what in told if isinstance(what, SpeechEnd)]
    wanted = segments(sound, hang, pre, onset)
    assert begun == [first for first, _ in wanted]
    assert ended == [(first, last) for first, last in wanted if last >= 0]


@given(_SOUND, _HANG, _PRE, _ONSET)
def test_the_end_is_told_once_and_with_the_chunk_that_completes_it(
    sound: Sequence[float | None], hang: int, pre: int, onset: int
) -> None:
    told = run(Endpointer(EDGE, hang, pre, onset=onset), sound)
    assert [isinstance(what, SpeechStart) for _, what in told] == [
        index % 2 == 0 for index in range(len(told))
    ]
    for number, what in told:
        if isinstance(what, SpeechEnd):
            assert number == what.last
            assert not what.cut


@given(_SOUND, _HANG, _PRE, _ONSET, st.integers(1, 20))
def test_no_segment_is_longer_than_the_longest_and_none_overlaps(
    sound: Sequence[float | None], hang: int, pre: int, onset: int, more: int
) -> None:
    longest = pre + onset + more
    endpointer = Endpointer(EDGE, hang, pre, onset=onset, longest=longest)
    free = 0
    for _, what in run(endpointer, sound):
        assert what.first >= free
        if isinstance(what, SpeechEnd):
            assert what.last - what.first + 1 <= longest
            free = what.last + 1


@given(_SOUND, _HANG, _PRE, _ONSET)
def test_what_may_be_forgotten_is_never_wanted_again(
    sound: Sequence[float | None], hang: int, pre: int, onset: int
) -> None:
    endpointer = Endpointer(EDGE, hang, pre, onset=onset)
    kept = 0
    for level in sound:
        what = endpointer.judge(level)
        assert what is None or what.first >= kept
        assert endpointer.earliest >= kept
        kept = endpointer.earliest


def test_quiet_before_speech_is_kept_for_the_pre_roll_only() -> None:
    endpointer = Endpointer(EDGE, hang=3, pre=4, onset=2)
    for _ in range(1000):
        endpointer.judge(QUIET)
    assert endpointer.chunks - endpointer.earliest == 4


def test_a_level_on_the_threshold_is_quiet() -> None:
    assert run(Endpointer(EDGE, hang=1, pre=0), [EDGE, EDGE]) == []


def test_pre_roll_and_hang_over_belong_to_the_segment() -> None:
    """Section 3: onset at 5, two chunks of pre-roll; the third quiet chunk ends it."""
    sound: Sequence[float | None] = [QUIET] * 5 + [LOUD] * 2 + [QUIET] * 6
    assert run(Endpointer(EDGE, hang=3, pre=2), sound) == [
        (5, SpeechStart(3)),
        (9, SpeechEnd(3, 9)),
    ]


def test_the_pre_roll_never_reaches_into_the_segment_before() -> None:
    sound: Sequence[float | None] = [LOUD, QUIET, QUIET, QUIET, LOUD, QUIET, QUIET]
    told = run(Endpointer(EDGE, hang=2, pre=3), sound)
    assert [what for _, what in told] == [
        SpeechStart(0),
        SpeechEnd(0, 2),
        SpeechStart(3),
        SpeechEnd(3, 6),
    ]


def test_a_pause_shorter_than_the_hang_over_is_part_of_the_sentence() -> None:
    sound: Sequence[float | None] = [LOUD, QUIET, QUIET, LOUD, QUIET, QUIET, QUIET]
    assert run(Endpointer(EDGE, hang=3, pre=0), sound) == [
        (0, SpeechStart(0)),
        (6, SpeechEnd(0, 6)),
    ]


def test_a_click_is_no_speech_where_an_onset_is_asked_for() -> None:
    assert run(Endpointer(EDGE, hang=2, pre=1, onset=3), [LOUD, LOUD, QUIET] * 5) == []


def test_speech_that_is_still_open_has_no_end() -> None:
    endpointer = Endpointer(EDGE, hang=2, pre=0)
    assert run(endpointer, [LOUD, QUIET]) == [(0, SpeechStart(0))]
    assert endpointer.speaks


def test_whoever_speaks_on_after_the_longest_segment_begins_the_next() -> None:
    told = run(Endpointer(EDGE, hang=2, pre=1, longest=4), [LOUD] * 9)
    assert [what for _, what in told] == [
        SpeechStart(0),
        SpeechEnd(0, 3, cut=True),
        SpeechStart(4),
        SpeechEnd(4, 7, cut=True),
        SpeechStart(8),
    ]


def test_no_chunk_is_lost_where_the_longest_segment_is_cut() -> None:
    """A voice that goes on needs no new onset, whatever that is."""
    told = run(Endpointer(EDGE, hang=2, pre=1, onset=3, longest=5), [LOUD] * 12)
    assert [what for _, what in told] == [
        SpeechStart(0),
        SpeechEnd(0, 4, cut=True),
        SpeechStart(5),
        SpeechEnd(5, 9, cut=True),
        SpeechStart(10),
    ]


def test_sound_that_breaks_off_closes_the_segment() -> None:
    endpointer = Endpointer(EDGE, hang=5, pre=1)
    run(endpointer, [QUIET, QUIET, LOUD, QUIET])
    assert endpointer.close() == SpeechEnd(1, 3, cut=True)
    assert endpointer.close() is None
    assert run(endpointer, [QUIET, LOUD]) == [(1, SpeechStart(4))]


@pytest.mark.parametrize(
    ("hang", "pre", "onset", "longest"),
    [(0, 0, 1, None), (1, -1, 1, None), (1, 0, 0, None), (1, 3, 2, 5)],
)
def test_impossible_numbers_are_refused(
    hang: int, pre: int, onset: int, longest: int | None
) -> None:
    with pytest.raises(ValueError, match=r"hang|longest"):
        Endpointer(EDGE, hang, pre, onset=onset, longest=longest)
