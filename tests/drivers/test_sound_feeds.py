"""Live sound in a feed: what a reader gets, what it has lost, and that it is never late."""

from __future__ import annotations

from pathlib import Path

from hypothesis import given
from hypothesis import strategies as st

from woz_tui.drivers.feeds import Feed
from woz_tui.drivers.sound_feeds import (
    FRESH_S,
    HELD_S,
    LISTENED,
    SOUND,
    LiveSound,
    SoundListened,
    SoundOffer,
    SoundReader,
    SoundWindow,
)
from woz_tui.system.clock import ManualClock
from woz_tui.testing import RecordingContext

RATE = 1000


def samples(first: int, count: int) -> bytes:
    """So many frames that say their own number."""
    return b"".join((first + n).to_bytes(2, "little") for n in range(count))


def numbers(pcm: bytes) -> list[int]:
    return [int.from_bytes(pcm[at : at + 2], "little") for at in range(0, len(pcm), 2)]


@given(st.lists(st.tuples(st.integers(1, 60), st.booleans()), min_size=1, max_size=60))
def test_every_frame_is_read_once_in_its_order_or_counted_as_lost(
    steps: list[tuple[int, bool]],
) -> None:
    feed = Feed()
    window, reader = SoundWindow(feed, RATE), SoundReader(feed)
    written = heard = lost = 0
    for count, reads in steps:
        window.add(samples(written, count), 0)
        written += count
        if not reads:
            continue
        taken = reader.take()
        assert taken is not None
        piece, _ = taken
        got = numbers(piece.pcm)
        if heard + lost:
            assert got[0] == heard + lost + piece.lost
            lost += piece.lost
        else:
            lost = got[0]  # a reader begins with the newest
        assert got == list(range(got[0], written))
        assert len(got) <= HELD_S * RATE + 60
        heard += len(got)
        assert heard + lost == written
        assert reader.take() is None


def test_who_reads_too_late_goes_on_with_the_newest() -> None:
    feed = Feed()
    window = SoundWindow(feed, RATE)
    window.add(samples(0, 20), 0)
    reader = SoundReader(feed)
    for first in range(20, 1020, 20):
        window.add(samples(first, 20), first)
    taken = reader.take()
    assert taken is not None
    fresh = round(FRESH_S * RATE)
    assert numbers(taken[0].pcm) == list(range(1020 - fresh, 1020))
    assert taken[0].lost == 1000 - fresh
    assert taken[0].t_us == 1020 - fresh


def test_a_reader_hears_nothing_of_before_it() -> None:
    feed = Feed()
    window = SoundWindow(feed, RATE)
    window.add(samples(0, 100), 0)
    reader = SoundReader(feed)
    assert reader.take() is None
    window.add(samples(100, 10), 0)
    taken = reader.take()
    assert taken is not None
    assert numbers(taken[0].pcm) == list(range(100, 110))


def test_a_reader_within_a_block_gets_the_whole_of_it() -> None:
    feed = Feed()
    window = SoundWindow(feed, RATE)
    window.add(samples(0, 20), 0)
    window.add(samples(20, 20), 0)
    sound = feed.latest().value
    assert isinstance(sound, LiveSound)
    pieces = [sound.after(end) for end in (10, 20, 30)]
    assert [(numbers(piece.pcm)[0], piece.end, piece.lost) for piece in pieces if piece] == [
        (0, 40, 0),
        (20, 40, 0),
        (20, 40, 0),
    ]


def test_a_feed_that_begins_anew_is_followed() -> None:
    feed = Feed()
    SoundWindow(feed, RATE).add(samples(0, 500), 0)
    reader = SoundReader(feed)
    SoundWindow(feed, RATE).add(samples(0, 10), 0)
    taken = reader.take()
    assert taken is not None
    assert (numbers(taken[0].pcm), taken[0].lost) == (list(range(10)), 0)


def test_a_microphone_is_wanted_while_somebody_listens(tmp_path: Path) -> None:
    clock = ManualClock()
    context = RecordingContext(tmp_path, clock)
    offer = SoundOffer(context, RATE)
    wanted = [offer.wanted]
    context.feed(LISTENED).put(SoundListened(1_000_000))
    wanted.append(offer.wanted)
    clock.advance(1.0)
    wanted.append(offer.wanted)
    assert wanted == [False, True, False]
    assert context.feed(SOUND).latest().value is None
    offer.add(samples(0, 3))
    value = context.feed(SOUND).latest().value
    assert isinstance(value, LiveSound)
    assert (value.rate, value.end) == (RATE, 3)
