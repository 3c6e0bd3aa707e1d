"""What comes from the feed's thread, until the screen takes it in its own."""

from __future__ import annotations

import asyncio
import contextlib
import contextvars
import functools
from collections import deque
from collections.abc import Callable, Iterator

from woz_tui.console.message_feed import Incoming


class Inbox:
    """Batches of messages and losses of the connection.

    Args:
        wake: Called in the screen's thread when something has come after a silence.
    """

    def __init__(self, wake: Callable[[], None]) -> None:
        self._wake = wake
        self._batches: deque[list[Incoming]] = deque()
        self._losses: deque[str] = deque()
        self._loop: asyncio.AbstractEventLoop | None = None
        self._surroundings: contextvars.Context | None = None

    def open(self) -> None:
        """The screen's loop runs; called in it, where a dialog will find its app."""
        self._loop = asyncio.get_running_loop()
        self._surroundings = contextvars.copy_context()

    def __bool__(self) -> bool:
        """Whether there is anything to take."""
        return bool(self._batches or self._losses)

    # -- in any thread --------------------------------------------------------------------------

    def heard(self, batch: list[Incoming]) -> None:
        """Keep a batch for the next painting; wake the screen if it has been still."""
        idle = not self._batches
        self._batches.append(batch)
        if idle:
            self._call(self._wake)

    def cut(self, why: str) -> None:
        """The connection is lost."""
        self._losses.append(why)
        self._call(self._wake)

    def elsewhere(self, callback: Callable[..., None]) -> Callable[..., None]:
        """`callback`, to be called from any thread."""
        return functools.partial(self._call, callback)

    def _call(self, callback: Callable[..., None], *args: object) -> None:
        if self._loop is not None:
            with contextlib.suppress(RuntimeError):  # the loop has closed: nothing to show
                self._loop.call_soon_threadsafe(callback, *args, context=self._surroundings)

    # -- in the screen's thread -----------------------------------------------------------------

    def batches(self) -> Iterator[list[Incoming]]:
        """Take what has come, oldest first."""
        while self._batches:
            yield self._batches.popleft()

    def losses(self) -> Iterator[str]:
        """Take the reasons for which the connection was lost."""
        while self._losses:
            yield self._losses.popleft()
