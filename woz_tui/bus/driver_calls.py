"""Calling a driver, so that nothing it raises reaches further than the task it is called in."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from typing import TypeVar

from woz_tui.drivers.contract import DriverError

T = TypeVar("T")


async def guarded(call: Callable[[], Awaitable[T]]) -> T:
    """Await `call()`; whatever it raises stays inside the caller's task.

    `SystemExit` and `KeyboardInterrupt` (a maker's library that calls `sys.exit`) would end the
    robot process from inside a task, so they become ordinary failures too.
    """
    try:
        return await call()
    except (SystemExit, KeyboardInterrupt) as error:
        raise DriverError(f"the driver raised {type(error).__name__}") from error
