from __future__ import annotations

import socket
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager

import pytest

from tests.replay.logs import KeptSamples, recording_of, story
from woz_tui.console.link.message_feed import Incoming, MessageFeed
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.replay.player import ReplayPlayer, ReplayStart
from woz_tui.replay.recording import Recording
from woz_tui.replay.replay_feed import ReplayFeed
from woz_tui.system.clock import ManualClock

PATIENCE = 40.0


class FeedListener:
    """Hears a feed in its thread."""

    def __init__(self) -> None:
        self.heard: list[Incoming] = []
        self.threads: set[str] = set()

    def __call__(self, batch: list[Incoming]) -> None:
        self.threads.add(threading.current_thread().name)
        self.heard += batch

    def until(self, true: Callable[[Incoming], bool]) -> Incoming:
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            for each in list(self.heard):
                if true(each):
                    return each
            time.sleep(0.005)
        raise AssertionError(f"it never came; there came {self.heard[-5:]}")


@contextmanager
def playing(
    clock: ManualClock, start: ReplayStart | None = None
) -> Iterator[tuple[ReplayFeed, FeedListener]]:
    feed = ReplayFeed(ReplayPlayer(recording_of(story()), start), clock)
    listener = FeedListener()
    feed.start(listener, pytest.fail)
    try:
        yield feed, listener
    finally:
        feed.close()
        feed.close()  # twice does no harm


def _kind(kind: type[m.Message]) -> Callable[[Incoming], bool]:
    return lambda each: isinstance(each, kind)


def test_it_has_the_shape_of_a_feed() -> None:
    feed: MessageFeed = ReplayFeed(ReplayPlayer(recording_of([])))
    assert feed.line_ok


def test_it_plays_in_a_thread_of_its_own_as_the_clock_says() -> None:
    clock = ManualClock()
    with playing(clock) as (_, listener):
        assert isinstance(listener.until(lambda each: isinstance(each, r.Welcome)), r.Welcome)
        clock.advance(6)
        listener.until(_kind(m.Marker))
        assert not any(isinstance(each, m.Mistake) for each in listener.heard)
        clock.advance(10)
        listener.until(_kind(m.Mistake))
        assert listener.threads == {"replay"}


def test_asking_returns_at_once_and_every_request_gets_its_reply() -> None:
    clock = ManualClock()
    with playing(clock, ReplayStart(paused=True)) as (feed, listener):
        refs = [feed.ask(r.AskReplay(what="step")), feed.ask(r.AskAction(action="Hello"))]
        assert refs == [1, 2]
        for ref in refs:
            listener.until(lambda each, ref=ref: isinstance(each, r.Reply) and each.ref == ref)  # type: ignore[misc]
        feed.ask(r.Beat())
        last = feed.ask(r.AskStop(source="key"))
        reply = listener.until(lambda each: isinstance(each, r.Reply) and each.ref == last)
        assert isinstance(reply, r.Reply)
        assert not reply.ok
        assert [each.ref for each in listener.heard if isinstance(each, r.Reply)] == [1, 2, 4]


def test_nothing_comes_after_it_was_closed() -> None:
    clock = ManualClock()
    with playing(clock) as (feed, listener):
        listener.until(lambda each: isinstance(each, r.Welcome))
        feed.close()
        thread = next((t for t in threading.enumerate() if t.name == "replay"), None)
        if thread is not None:
            thread.join(PATIENCE)
        count = len(listener.heard)
        feed.ask(r.AskReplay(what="step"))
        assert len(listener.heard) == count


def test_a_failure_is_told_and_the_keys_still_answer() -> None:
    class Broken(KeptSamples):
        def between(self, after_us: int, until_us: int) -> Iterable[m.Message]:
            raise OSError("the disk does not exist any more")

    lines = [each for each in story() if not codec.is_sample(each)]
    feed = ReplayFeed(
        ReplayPlayer(Recording(lines, Broken([], lines[-1].t))), clock := ManualClock()
    )
    listener = FeedListener()
    feed.start(listener, pytest.fail)
    listener.until(lambda each: isinstance(each, r.Welcome))
    clock.advance(3)
    told = listener.until(_kind(m.Notice))
    assert isinstance(told, m.Notice)
    assert "the disk does not exist any more" in told.text
    ref = feed.ask(r.AskReplay(what="go", to="end"))
    listener.until(lambda each: isinstance(each, r.Reply) and each.ref == ref)
    feed.close()


def test_no_replay_opens_a_socket(monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[object] = []

    class Watched(socket.socket):
        def __init__(self, *args: object, **options: object) -> None:
            opened.append(args)
            raise OSError("no")

    monkeypatch.setattr(socket, "socket", Watched)
    clock = ManualClock()
    with playing(clock) as (feed, listener):
        for request in (r.AskReplay(what="faster"), r.AskAction(action="Hello"), r.AskStop()):
            feed.ask(request)
        clock.advance(60)
        listener.until(_kind(m.SessionEnd))
    assert opened == []
