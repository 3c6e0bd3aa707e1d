"""Calls into drivers: whose code runs at the moment, and how long it holds the event loop."""

from __future__ import annotations

import asyncio
import functools
import types
from collections import deque
from collections.abc import Awaitable, Callable, Generator
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeVar

from woz_tui.drivers.contract import DriverError

T = TypeVar("T")

#: A step that takes so long is one of `LONG_STEPS`, in seconds.
LONG_STEP_S = 0.1


@dataclass(eq=False)
class DriverCall:
    """One call: of which driver, and of what (`perform say`, `stop`, `open`).

    Attributes:
        longest_s: The longest step so far. From one `await` to the next the loop does nothing else.
        over: It has returned. What it began (tasks, timers) may go on.
    """

    driver: str
    call: str
    longest_s: float = 0.0
    over: bool = False

    def step(self, code: Callable[[], T]) -> T:
        """Run a part of it, of which nothing waits."""
        loop = asyncio.get_running_loop()
        began = loop.time()
        try:
            return code()
        finally:
            ended = loop.time()
            self.longest_s = max(self.longest_s, ended - began)
            if ended - began > LONG_STEP_S:
                LONG_STEPS.append(LongStep(self, ended - began, ended))

    @types.coroutine
    def steps(self, call: Awaitable[T]) -> Generator[Any, None, T]:
        """Await it step by step."""
        rest: Any = call.__await__()
        step: Callable[[], Any] = functools.partial(rest.send, None)
        while True:
            try:
                waits_for = self.step(step)
            except StopIteration as end:
                result: T = end.value
                return result
            try:
                yield waits_for
                step = functools.partial(rest.send, None)
            except BaseException as error:  # noqa: BLE001 - the call's own: a cancelling, most often
                step = functools.partial(rest.throw, error)


class LongStep(NamedTuple):
    """A part of a call that held the loop, and when it ended, in the loop's seconds."""

    of: DriverCall
    seconds: float
    ended: float


#: The last ones of this process.
LONG_STEPS: deque[LongStep] = deque(maxlen=8)
#: The call in which a driver began what runs now: tasks and timers have it from who makes them.
CALLING: ContextVar[DriverCall | None] = ContextVar("CALLING", default=None)


async def guarded(call: Callable[[], Awaitable[T]], made: DriverCall) -> T:
    """Await `call()`; whatever it raises stays inside the caller's task.

    `SystemExit` and `KeyboardInterrupt` (a maker's library that calls `sys.exit`) would end the
    robot process from inside a task, so they become ordinary failures too.
    """
    CALLING.set(made)
    try:
        return await made.steps(made.step(call))
    except (SystemExit, KeyboardInterrupt) as error:
        raise DriverError(f"the driver raised {type(error).__name__}") from error
    finally:
        made.over = True
        CALLING.set(None)
