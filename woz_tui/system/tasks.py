"""Tasks that run beside others: ended together, and no error of theirs is lost."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Coroutine, Iterable
from typing import Any, ClassVar, TypeVar

log = logging.getLogger(__name__)

#: A timer that fires so much too late: this process has stood still. What others have said
#: meanwhile it reads within the other time. In seconds.
STOOD_STILL_S, READ_AGAIN_S = 0.02, 0.1

_T = TypeVar("_T")


async def end_tasks(*tasks: asyncio.Task[Any] | None) -> None:
    """Cancel tasks and return when all have ended. What one of them had failed with before is in
    the program's log: nobody else waited for it.
    """
    there = [task for task in tasks if task is not None and task is not asyncio.current_task()]
    for task in there:
        if not task.done():
            task.cancel()
        elif not task.cancelled() and (error := task.exception()) is not None:
            log.error("%s had failed", task.get_name(), exc_info=error)
    await asyncio.gather(*there, return_exceptions=True)


async def until_first_ends(*work: Coroutine[Any, Any, Any]) -> Any:
    """Run all at once until the first of them ends; then the others are cancelled.

    Returns what the first one returned, or raises what it raised; of several that end in the same
    moment an error counts. Of what others raise while they end nobody hears.
    """
    tasks = [asyncio.ensure_future(each) for each in work]
    try:
        ended, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
    failed = [task for task in ended if task.exception() is not None]
    return (failed or [*ended])[0].result()


async def wait_at_most(
    ends: Iterable[asyncio.Future[Any]], seconds: float, again_s: float = READ_AGAIN_S
) -> None:
    """Return when all have ended or `seconds` (none: at once) have passed. A process that stood
    still at that moment waits `again_s` more: it has not read yet what ended them meanwhile.
    """
    loop, waited_for = asyncio.get_running_loop(), set(ends)
    due = loop.time() + seconds
    if waited_for:
        await asyncio.wait(waited_for, timeout=max(0.0, seconds))
        if loop.time() - due > STOOD_STILL_S:
            await asyncio.wait(waited_for, timeout=again_s)


class TaskSet:
    """Tasks that nobody waits for. An error that is not `expected` is in the program's log."""

    expected: ClassVar[tuple[type[Exception], ...]] = ()

    def __init__(self, what: str) -> None:
        self._what = what
        self._tasks: set[asyncio.Task[Any]] = set()

    def __bool__(self) -> bool:
        return bool(self._tasks)

    def start(self, work: Coroutine[Any, Any, _T], name: str = "") -> asyncio.Task[_T]:
        """Begin one more, by a name of its own or that of all."""
        task = asyncio.get_running_loop().create_task(work, name=name or self._what)
        self._tasks.add(task)
        task.add_done_callback(self._ended)
        return task

    def cancel(self) -> None:
        """Give all up, without waiting for their end."""
        for task in tuple(self._tasks):
            task.cancel()

    async def settled(self, within: float | None = None) -> None:
        """Return when none is left, or after `within` seconds."""
        loop = asyncio.get_running_loop()
        until = None if within is None else loop.time() + within
        while self._tasks and (until is None or loop.time() < until):
            await asyncio.wait(self._tasks, timeout=until and until - loop.time())

    async def close(self, within: float = 0.0) -> None:
        """Return when none is left; after `within` seconds they are given up."""
        await self.settled(within)
        self.cancel()
        await self.settled()

    def _ended(self, task: asyncio.Task[Any]) -> None:
        self._tasks.discard(task)
        error = None if task.cancelled() else task.exception()
        if error is not None and not isinstance(error, self.expected):
            log.error("%s failed", self._what, exc_info=error)
