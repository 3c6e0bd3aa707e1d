"""Work in the background: one task of a part, and threads for what may wait for a disk."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable, Coroutine
from typing import Any, TypeVar

from woz_tui.drivers.contract import DriverContext

_T = TypeVar("_T")


class Background:
    """One task at a time. If it fails the wizard gets a notice: nothing else would show it."""

    def __init__(self, what: str, context: DriverContext) -> None:
        self._what = what
        self._context = context
        self._task: asyncio.Task[None] | None = None

    @property
    def running(self) -> bool:
        """Whether there is one."""
        return self._task is not None and not self._task.done()

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
        if task is not None and not task.done():
            task.cancel()
            await asyncio.wait([task])

    def _ended(self, task: asyncio.Task[None]) -> None:
        error = None if task.cancelled() else task.exception()
        if error is not None:
            text = f"{self._what} ended because of an error in this program: {error!r}"
            self._context.notice("error", text, "connect again; please report it")


async def apart(work: Callable[[], _T]) -> _T:
    """Have a thread of its own do what may wait for a disk; it ends with the work.

    A caller that is cancelled does not wait for it. Raises what `work` raises.
    """
    loop = asyncio.get_running_loop()
    done: asyncio.Future[_T] = loop.create_future()
    done.add_done_callback(lambda over: over.cancelled() or over.exception())

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
