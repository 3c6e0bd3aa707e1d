"""An event loop whose time jumps: pauses of minutes pass at once, and in the right order.

Only for code that waits for nothing outside the loop (no threads, no sockets), except where nothing
else is to come: then a thread may still call.
"""

from __future__ import annotations

import asyncio
import selectors
from collections.abc import Coroutine
from datetime import UTC, datetime, timedelta
from typing import Any, TypeVar

T = TypeVar("T")

#: So long a thread may take, in real seconds, where all else waits for it.
_OUTSIDE_S = 10.0


class _JumpingSelector(selectors.DefaultSelector):
    """Instead of waiting for `timeout` seconds it tells the loop that they have passed."""

    def __init__(self, loop: VirtualLoop) -> None:
        super().__init__()
        self._loop = loop

    def select(self, timeout: float | None = None) -> list[tuple[selectors.SelectorKey, int]]:
        ready = super().select(0 if timeout is not None else _OUTSIDE_S)
        if not ready and timeout is None:
            raise RuntimeError("everything waits for something that never happens")
        if not ready and timeout is not None and timeout > 0:
            self._loop.jump(timeout)
        return ready


class VirtualLoop(asyncio.SelectorEventLoop):
    """See the module's text."""

    def __init__(self) -> None:
        self._now = 0.0
        super().__init__(_JumpingSelector(self))

    def time(self) -> float:
        return self._now

    def jump(self, seconds: float) -> None:
        # A nanosecond more, so that the timer aimed at is due and not due-but-for-rounding.
        self._now += seconds + 1e-9


class LoopClock:
    """The session's clock on the loop's time."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop
        self._start = datetime(2026, 3, 1, 10, 0, 0, tzinfo=UTC)
        #: How long the process has stood still so far.
        self.stood_still_us = 0

    def now_us(self) -> int:
        return round(self._loop.time() * 1_000_000)

    def boot_us(self) -> int:
        return self.now_us() + self.stood_still_us

    def wall(self) -> datetime:
        return self._start + timedelta(microseconds=self.now_us())


def block(seconds: float) -> None:
    """Take so long, and let nothing else run meanwhile."""
    loop = asyncio.get_running_loop()
    assert isinstance(loop, VirtualLoop)
    loop.jump(seconds)


def stand_still(after: float, seconds: float) -> None:
    """The process gets no turn for so long, and then sees at once what was due meanwhile."""
    asyncio.get_running_loop().call_later(after, block, seconds)


def run_virtual(coroutine: Coroutine[Any, Any, T]) -> T:
    """Run `coroutine` to its end in virtual time."""
    with asyncio.Runner(loop_factory=VirtualLoop) as runner:
        return runner.run(coroutine)
