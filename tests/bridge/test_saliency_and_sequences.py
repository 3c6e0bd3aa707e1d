"""Which place is looked at, and which sequences fit: without a robot and without a clock."""

from __future__ import annotations

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from woz_tui.bridge.saliency import SILENCE_S, SaliencyMap
from woz_tui.bridge.sequence_queue import (
    SOONEST_S,
    NackReason,
    QueuedSequence,
    RequestKind,
    SequenceQueue,
    SequenceRequest,
)
from woz_tui.bridge.topic_table import MIDDLE, SalientPlace

GAZE, SHIFT = SalientPlace(0.5, 0.5, 10000), SalientPlace(-0.5, 0.0, 1000)


def test_a_gaze_wins_over_a_shift_and_the_shift_stays_when_it_is_over() -> None:
    """As EyePi's engine of AsapRealizer says both, again and again."""
    places = SaliencyMap()
    places.put("2", [SHIFT], 0.0)
    assert places.chosen(0.0) == SHIFT
    places.put("1", [GAZE], 1.0)
    places.put("2", [SHIFT], 1.0)
    assert places.chosen(1.0) == GAZE
    places.put("2", [SHIFT], 1.0 + SILENCE_S)
    assert places.chosen(1.0 + SILENCE_S) == SHIFT
    assert places.chosen(1.0 + 2 * SILENCE_S) == MIDDLE


def test_of_equally_heavy_places_the_nearer_one_is_looked_at() -> None:
    places = SaliencyMap()
    left, right = SalientPlace(-0.9, 0, 500), SalientPlace(0.9, 0, 500)
    places.put("camera", [right], 0.0)
    assert places.chosen(0.0) == right
    places.put("camera", [left, right], 0.1)
    assert places.chosen(0.1) == right
    places.put("camera", [left, SalientPlace(0, 0, 0)], 0.2)
    assert places.chosen(0.2) == left


def wanted(kind: int, seconds: float, count: int = 1) -> SequenceRequest:
    """Something that takes two seconds, with its stroke after half of one."""
    return SequenceRequest("s", kind, seconds, count, 2.0, 0.5)


@pytest.mark.parametrize(
    ("kind", "seconds", "count", "start"),
    [
        (RequestKind.START, 0.1, 1, 10.1),
        (RequestKind.START, 3.0, 2, 13.0),
        (RequestKind.STROKE, 3.0, 1, 12.5),
        (RequestKind.END, 5.0, 2, 11.0),
    ],
)
def test_what_is_asked_for_is_where_it_shall_be(
    kind: int, seconds: float, count: int, start: float
) -> None:
    made = SequenceQueue().add(wanted(kind, seconds, count), 10.0)
    assert isinstance(made, QueuedSequence)
    assert made.start == pytest.approx(start)
    assert made.end == pytest.approx(start + 2.0 * count)


@pytest.mark.parametrize(
    ("kind", "seconds", "count", "reason"),
    [
        (RequestKind.START, 0.0, 1, NackReason.TOO_SOON),
        (RequestKind.STROKE, 0.5, 1, NackReason.TOO_SOON),
        (RequestKind.END, 2.0, 1, NackReason.TOO_SOON),
        (RequestKind.END, -0.1, 1, NackReason.INVALID),
        (0, 1.0, 1, NackReason.INVALID),
        (9, 1.0, 1, NackReason.INVALID),
        (RequestKind.START, 1.0, 0, NackReason.INVALID),
        (RequestKind.START, 1.0, -1, NackReason.INVALID),
    ],
)
def test_what_cannot_be_has_its_reason(
    kind: int, seconds: float, count: int, reason: NackReason
) -> None:
    assert SequenceQueue().add(wanted(kind, seconds, count), 10.0) is reason


def test_two_at_a_time_are_not_fluent_and_one_after_the_other_is() -> None:
    queue = SequenceQueue()
    first = queue.add(wanted(RequestKind.START, 1.0), 0.0)
    assert isinstance(first, QueuedSequence)
    assert queue.add(wanted(RequestKind.START, 2.9), 0.0) is NackReason.FLUENCY
    assert queue.add(wanted(RequestKind.START, 0.5, count=5), 0.0) is NackReason.FLUENCY
    assert isinstance(queue.add(wanted(RequestKind.START, 3.0), 0.0), QueuedSequence)
    queue.remove(first)
    assert isinstance(queue.add(wanted(RequestKind.START, 0.9), 0.0), QueuedSequence)


REQUESTS = st.builds(
    SequenceRequest,
    st.just("s"),
    st.integers(0, 5),
    st.floats(-10, 100),
    st.integers(-1, 5),
    st.floats(0.01, 10),
    st.floats(0, 10),
)


@pytest.mark.hypothesis
@given(requests=st.lists(st.tuples(REQUESTS, st.floats(0, 50)), max_size=20))
def test_whatever_is_asked_for_what_is_accepted_never_meets(
    requests: list[tuple[SequenceRequest, float]],
) -> None:
    queue = SequenceQueue()
    for request, now in requests:
        made = queue.add(request, now)
        if isinstance(made, QueuedSequence):
            assert made.start >= now + SOONEST_S - 1e-5
    ordered = sorted(queue.sequences, key=lambda one: one.start)
    assert all(one.end <= other.start + 1e-5 for one, other in itertools.pairwise(ordered))
