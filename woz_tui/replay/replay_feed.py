"""Feeds the console from a log: a thread plays it and answers requests.

It has the shape of `woz_tui.console.link.message_feed.MessageFeed`, opens no socket, knows no
driver.
"""

from __future__ import annotations

import functools
import threading
from collections import deque
from collections.abc import Callable

import msgspec

from woz_tui.protocol.messages import Notice
from woz_tui.protocol.requests import Beat, Request
from woz_tui.protocol.welcome import STALE_S
from woz_tui.replay.player import Incoming, ReplayPlayer
from woz_tui.system.clock import Clock, RealClock

#: Seconds between two looks at the time while something is played.
TICK_S = 0.05
#: Lines that are worked ahead while nothing else is to be done.
AHEAD = 2_000
#: Seconds between two looks as long as there are such lines.
AHEAD_S = 0.01


class ReplayFeed:
    """Plays `player` until it is closed.

    Args:
        player: What is played, and how.
        clock: The viewer's time.
    """

    _on_messages: Callable[[list[Incoming]], None]

    def __init__(self, player: ReplayPlayer, clock: Clock | None = None) -> None:
        self.line_ok = self.attached = True
        self.stale_after_s = STALE_S
        self.round_trip_us: int | None = None
        self._player = player
        self._clock = clock or RealClock()
        self._requests: deque[Request] = deque()
        self._news = threading.Condition()
        self._closed = False
        self._ref = 0

    def start(
        self,
        on_messages: Callable[[list[Incoming]], None],
        on_lost: Callable[..., None],
    ) -> None:
        """Begin to play. A replay is never lost: at its end it stands still."""
        self._on_messages = on_messages
        threading.Thread(target=self._run, name="replay", daemon=True).start()

    def ask(self, request: Request) -> int:
        """Hand `request` to the player; safe from any thread, never waits."""
        with self._news:
            self._ref += 1
            if not isinstance(request, Beat):
                self._requests.append(msgspec.structs.replace(request, ref=self._ref))
            self._news.notify()
            return self._ref

    def close(self) -> None:
        """Stop; nothing is delivered from now on."""
        with self._news:
            self._closed = True
            self._news.notify()

    def _run(self) -> None:
        self._perform(self._player.begin)
        more = True
        while True:
            with self._news:
                if not self._requests and not self._closed:
                    idle = None if self._player.still else TICK_S
                    self._news.wait(AHEAD_S if more else idle)
                if self._closed:
                    return
                asked = [*self._requests]
                self._requests.clear()
            for request in asked:
                self._perform(functools.partial(self._player.ask, request))
            if not asked:
                self._perform(self._player.tick)
                more = more and self._player.recording.prepare(AHEAD)

    def _perform(self, work: Callable[[int], list[Incoming]]) -> None:
        """Tell what comes of it. A mistake of the program stops the time, not the thread."""
        try:
            batch = work(self._clock.now_us())
        except Exception as error:  # noqa: BLE001 - it is told; a traceback would spoil the screen
            self._player.paused = True
            text = f"the replay failed: {type(error).__name__}: {error}"
            batch = [Notice(level="error", text=text, t=self._player.t)]
        if batch and not self._closed:
            self._on_messages(batch)
