"""What a driver does to the event loop, and errors of its own code that nobody waits for."""

from __future__ import annotations

import asyncio
import threading
import traceback
from collections.abc import Callable, Coroutine
from typing import Any

from woz_tui.system.processor_time import ProcessorWaits

#: How often the loop is asked for a sign of life, in seconds.
BEAT_S = 0.02


class LifeWatch:
    """Watches over the running loop from `begin` to `end`.

    Args:
        wrong: Gets subject, text and remedy of whatever is wrong.
        lag_s: For so long a call may hold up the loop, in seconds; for what the thread waits for a
            processor meanwhile nobody can be blamed.
    """

    def __init__(self, wrong: Callable[[str, str, str], None], lag_s: float) -> None:
        self._wrong = wrong
        self._lag_s = lag_s
        self._loop = asyncio.get_running_loop()
        self._waits = ProcessorWaits()
        self._beat_s, self._waited_s = 0.0, 0.0
        self._timer: asyncio.TimerHandle | None = None
        #: What has been under way since the last sign of life.
        self._doing: list[str] = []
        self._tasks: list[asyncio.Task[Any]] = []
        self._handler = self._loop.get_exception_handler()
        self._factory: Any = self._loop.get_task_factory()
        self._thread_hook = threading.excepthook

    def begin(self) -> None:
        """Watch from here on."""
        self._loop.set_exception_handler(self._on_loop_error)
        factory: Any = self._made
        self._loop.set_task_factory(factory)
        threading.excepthook = self._on_thread_error
        self._beat_s, self._waited_s = self._waits.now()
        self._beat()

    def doing(self, what: str) -> None:
        """Say what begins now."""
        self._doing.append(what)

    def end(self) -> None:
        """Tell what there is to be told, and leave the loop as it was."""
        self._beat()
        if self._timer is not None:
            self._timer.cancel()
        for task in self._tasks:
            # As asyncio itself decides whether to complain of a task that nobody has asked.
            if task.done() and not task.cancelled() and getattr(task, "_log_traceback", False):
                self._raised(f"the task {task.get_name()!r}", task.exception())
        self._loop.set_exception_handler(self._handler)
        self._loop.set_task_factory(self._factory)
        threading.excepthook = self._thread_hook
        self._waits.close()

    def _beat(self) -> None:
        now, waited_s = self._waits.now()
        held_s = (now - self._beat_s) - (waited_s - self._waited_s)
        if held_s > BEAT_S + self._lag_s:
            during = ", ".join(dict.fromkeys(self._doing)) or "the driver's own task or callback"
            self._wrong(
                during,
                f"held up the event loop for {held_s:.1f} s",
                "await it, or call what blocks with asyncio.to_thread",
            )
        self._beat_s, self._waited_s, self._doing = now, waited_s, self._doing[-1:]
        if self._timer is not None:
            self._timer.cancel()
        self._timer = self._loop.call_later(BEAT_S, self._beat)

    # -- errors ------------------------------------------------------------------------------

    def _made(
        self, loop: asyncio.AbstractEventLoop, coro: Coroutine[Any, Any, Any], **more: Any
    ) -> asyncio.Task[Any]:
        task: asyncio.Task[Any]
        if self._factory is None:
            task = asyncio.Task(coro, loop=loop, **more)
        else:
            task = self._factory(loop, coro, **more)
        self._tasks.append(task)
        return task

    def _on_loop_error(self, _: asyncio.AbstractEventLoop, told: dict[str, Any]) -> None:
        error = told.get("exception")
        if isinstance(error, Exception):
            self._raised("a task or callback", error)

    def _on_thread_error(self, args: threading.ExceptHookArgs) -> None:
        name = args.thread.name if args.thread is not None else "?"
        # A thread may tell at any time; findings are kept in the loop.
        self._loop.call_soon_threadsafe(self._raised, f"the thread {name!r}", args.exc_value)

    def _raised(self, where: str, error: BaseException | None) -> None:
        frames = traceback.extract_tb(error.__traceback__ if error is not None else None)
        place = f" at {frames[-1].name}, line {frames[-1].lineno}" if frames else ""
        self._wrong(where, f"raised {error!r}{place}, and nobody waits for it", "catch it there")
