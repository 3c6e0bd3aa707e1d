"""Calls of threads on their way into the event loop: bounded, and a part of them at a time."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import threading
from collections import deque
from collections.abc import Callable

#: Calls that may wait; of a thread that makes more, those that need not be kept are dropped.
CAPACITY = 1000
#: How many of them are made before the loop has another turn.
A_TURN = 50

log = logging.getLogger(__name__)


class ThreadCalls:
    """Makes calls in the loop that runs now, in their order.

    Args:
        who: Makes them; for the program's log.
    """

    def __init__(self, who: str) -> None:
        self._who = who
        self._loop = asyncio.get_running_loop()
        self._thread = threading.get_ident()
        self._waiting: deque[Callable[[], object]] = deque()
        self._due = False
        self._dropped = 0

    def make(self, call: Callable[[], object], *, keep: bool) -> None:
        """Make `call` now or, from another thread, soon; only what is to be kept always is."""
        if threading.get_ident() == self._thread:
            call()
            return
        if len(self._waiting) >= CAPACITY and not keep:
            self._dropped += 1
            return
        self._waiting.append(call)
        with contextlib.suppress(RuntimeError):  # the loop has closed: the session is over
            if not self._due:
                self._due = True
                self._loop.call_soon_threadsafe(self._deliver)

    def _deliver(self) -> None:
        self._due = False
        try:
            for _ in range(min(len(self._waiting), A_TURN)):
                self._waiting.popleft()()
        finally:  # one that raises does not hold up the others
            if self._waiting and not self._due:
                self._due = True
                self._loop.call_soon(self._deliver)
        if self._dropped and not self._waiting:
            dropped, self._dropped = self._dropped, 0
            log.warning("%s sends too many messages: %d were dropped", self._who, dropped)
