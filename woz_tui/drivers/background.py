"""Work in the background: tasks that nobody waits for, and threads for what may wait for a disk."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable, Coroutine
from typing import Any, TypeVar

from woz_tui.drivers.contract import DriverContext, DriverError
from woz_tui.system.tasks import TaskSet, end_tasks

#: What was begun for a robot may take so long to arrive there when the session is over, in seconds.
FAREWELL_S = 0.5

_T = TypeVar("_T")


def forget_outcome(over: asyncio.Future[Any]) -> None:
    """Nobody asks how it ended: a failure is not reported as one that was forgotten."""
    if not over.cancelled():
        over.exception()


class Background:
    """One task at a time. If it fails the wizard gets a notice: nothing else would show it."""

    def __init__(self, what: str, context: DriverContext) -> None:
        self._what = what
        self._context = context
        self._task: asyncio.Task[None] | None = None

    def start(self, work: Coroutine[Any, Any, None]) -> None:
        """Begin; what was under way is given up."""
        self.cancel()
        task = asyncio.get_running_loop().create_task(work, name=f"robot {self._what}")
        task.add_done_callback(self._ended)
        self._task = task

    def cancel(self) -> None:
        """Give it up, without waiting for its end."""
        if self._task is not None:
            self._task.cancel()

    async def close(self) -> None:
        """Give it up, and return when it has ended."""
        task, self._task = self._task, None
        await end_tasks(task)

    def _ended(self, task: asyncio.Task[None]) -> None:
        error = None if task.cancelled() else task.exception()
        if error is not None:
            text = f"{self._what} ended because of an error in this program: {error!r}"
            self._context.notice("error", text, "connect again; please report it")


class BackgroundTasks(TaskSet):
    """Several tasks at a time, such as what a robot must still hear when a command was cut short.

    That one is cancelled, or fails because the robot is gone, is no surprise and is not told.
    """

    expected = (DriverError, TimeoutError)

    async def close(self, within: float = FAREWELL_S) -> None:
        """Return when none is left; after `within` seconds they are given up."""
        await super().close(within)


async def apart(work: Callable[[], _T]) -> _T:
    """Have a thread of its own do what may wait for a disk; it ends with the work.

    A caller that is cancelled does not wait for it. Raises what `work` raises.
    """
    loop = asyncio.get_running_loop()
    done: asyncio.Future[_T] = loop.create_future()
    done.add_done_callback(forget_outcome)

    def settle(result: _T | None, error: BaseException | None) -> None:
        if done.done():
            return
        if error is not None:
            done.set_exception(error)
        else:
            done.set_result(result)  # type: ignore[arg-type]

    def run() -> None:
        result, error = None, None
        try:
            result = work()
        except Exception as trouble:  # noqa: BLE001 - whoever waits is to know
            error = trouble
        try:
            loop.call_soon_threadsafe(settle, result, error)
        except RuntimeError:
            return  # the loop has closed: nobody waits any more

    threading.Thread(target=run, name="robot file", daemon=True).start()
    return await done
