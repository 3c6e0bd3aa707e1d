"""Errors of a driver's own code that nobody waits for: each told once, and counted."""

from __future__ import annotations

import asyncio
import logging
import sys
import threading
import traceback
from collections import Counter
from collections.abc import Callable, Coroutine, Mapping
from contextvars import Context
from pathlib import Path
from types import FrameType, TracebackType
from typing import Any, Protocol
from weakref import WeakKeyDictionary

from woz_tui.bus.driver_call import CALLING
from woz_tui.bus.lane import IN_HOST_LOG
from woz_tui.config.study import PERCEIVED
from woz_tui.drivers.contract import Driver
from woz_tui.protocol.messages import DriverFaulted, Notice
from woz_tui.system.clock import Clock
from woz_tui.system.thread_calls import ThreadCalls

#: A task whose error nobody has asked for by then is one that nobody waits for, in seconds.
UNREAD_S = 1.0
#: A driver that says again how it is, and has had no error for so long, is well again.
QUIET_S = 10.0
#: An error's words may quote whatever was asked of the driver, and what it senses.
TELLS = ("request", *PERCEIVED)

log = logging.getLogger(__name__)


class FaultListener(Protocol):
    """Is told of faults: the session's hub."""

    def publish(self, message: DriverFaulted | Notice) -> object:
        """Tell everybody."""


class DriverFaults:
    """Publishes what went wrong in a driver's own tasks, timers, callbacks and threads.

    Args:
        hub: Gets a `DriverFaulted` for the first error at each place in a driver's code, and again
            with its count when there have been 10, 100, 1000 ...
        clock: Time.
    """

    def __init__(self, hub: FaultListener, clock: Clock) -> None:
        self._hub = hub
        self._clock = clock
        self._drivers: Mapping[str, Driver] = {}
        self._loop = asyncio.get_running_loop()
        self._calls = ThreadCalls("an error")
        #: How often, by driver and place.
        self._counts: Counter[tuple[str, str]] = Counter()
        #: Those that the driver's health shows now.
        self._shown: set[tuple[str, str]] = set()
        self._last_us: dict[str, int] = {}
        self._tasks: WeakKeyDictionary[asyncio.Future[Any], str] = WeakKeyDictionary()
        self._handler: Callable[..., object] | None = None
        self._factory: Any = None
        self._thread_hook = threading.excepthook

    # -- telling -----------------------------------------------------------------------------

    def report(self, driver: str, place: str, words: str, trace: str) -> None:
        """An error at `place` of its code; `trace` is for the program's log. From any thread."""
        self._calls.make(lambda: self._tell(driver, place, words, trace), keep=False)

    def _tell(self, driver: str, place: str, words: str, trace: str) -> None:
        key = driver, place
        self._counts[key] += 1
        count = self._counts[key]
        self._last_us[driver] = self._clock.now_us()
        round_number = str(count).strip("0") == "1"
        if round_number:
            again = f", {count} times so far" if count > 1 else f"\n{trace}"
            log.error("%s: an error in its own code: %s (%s)%s", driver, words, place, again)
        if round_number or key not in self._shown:
            self._shown.add(key)
            times = f", {count} times" if count > 1 else ""
            self._hub.publish(
                DriverFaulted(
                    driver=driver,
                    detail=f"{words} ({place}{times})",
                    remedy=f"this is an error in the driver; {IN_HOST_LOG}",
                    tells=TELLS,
                )
            )

    def is_over(self, driver: str) -> bool:
        """Whether a fault of its own code is shown that has not been seen for a while."""
        quiet_us = self._clock.now_us() - self._last_us.get(driver, 0)
        return quiet_us > QUIET_S * 1_000_000 and any(key[0] == driver for key in self._shown)

    def clear(self, driver: str) -> None:
        """It has said how it is: no fault is shown any more."""
        self._shown = {key for key in self._shown if key[0] != driver}

    # -- noticing ----------------------------------------------------------------------------

    def begin(self, drivers: Mapping[str, Driver]) -> None:
        """Watch over these from here on, in this loop and in their threads."""
        self._drivers = drivers
        self._handler = self._loop.get_exception_handler()
        self._factory = self._loop.get_task_factory()
        self._thread_hook = threading.excepthook
        self._loop.set_exception_handler(self._on_loop_error)
        factory: Any = self._made
        self._loop.set_task_factory(factory)
        threading.excepthook = self._on_thread_error

    def end(self) -> None:
        """Leave everything as it was."""
        self._loop.set_exception_handler(self._handler)
        self._loop.set_task_factory(self._factory)
        threading.excepthook = self._thread_hook

    def raised(self, error: BaseException, driver: str = "") -> bool:
        """Tell of an error; False if it is no driver's. From any thread."""
        place, owners = self._owners(error.__traceback__)
        if driver:
            owners = [driver]
        words = f"{type(error).__name__}: {error}"
        trace = "".join(traceback.format_exception(error))
        if len(owners) == 1:
            self.report(owners[0], place, words, trace)
        elif owners:
            who = " or ".join(owners)
            log.error("%s: an error in its own code (%s)\n%s", who, place, trace)
            notice = Notice(level="error", text=f"{who}: {words}", remedy=IN_HOST_LOG, tells=TELLS)
            self._calls.make(lambda: self._hub.publish(notice), keep=False)
        return bool(owners)

    def _made(
        self, loop: asyncio.AbstractEventLoop, coro: Coroutine[Any, Any, Any], **more: Any
    ) -> asyncio.Task[Any]:
        """A task: of the driver in whose code it is made, if it is made in one."""
        task: asyncio.Task[Any]
        if self._factory is not None:
            task = self._factory(loop, coro, **more)
        else:
            task = asyncio.Task(coro, loop=loop, **more)
        if (call := CALLING.get()) is not None:
            self._tasks[task] = call.driver
            task.add_done_callback(self._task_ended, context=Context())
        return task

    def _task_ended(self, task: asyncio.Future[Any]) -> None:
        if not task.cancelled() and _unread(task):
            self._loop.call_later(UNREAD_S, self._look_again, task)

    def _look_again(self, task: asyncio.Future[Any]) -> None:
        if _unread(task) and (error := task.exception()) is not None:
            self.raised(error, self._tasks.get(task, ""))

    def _on_loop_error(self, loop: asyncio.AbstractEventLoop, told: dict[str, Any]) -> None:
        error = told.get("exception")
        future = told.get("task") or told.get("future")
        call = None
        if future is None:  # else the loop comes to it in whatever runs at the moment
            context = getattr(told.get("handle"), "_context", None)
            call = context.get(CALLING) if context is not None else CALLING.get()
        owner = self._tasks.get(future, "") if future is not None else call.driver if call else ""
        if isinstance(error, Exception) and self.raised(error, owner):
            return
        if self._handler is not None:
            self._handler(loop, told)
        else:
            loop.default_exception_handler(told)

    def _on_thread_error(self, args: threading.ExceptHookArgs) -> None:
        error = args.exc_value
        if not isinstance(error, Exception) or not self.raised(error):
            self._thread_hook(args)

    # -- whose it is -------------------------------------------------------------------------

    def _owners(self, trace: TracebackType | None) -> tuple[str, list[str]]:
        """The innermost place in a driver's code, and whose that can be; the innermost of all if
        it is nobody's.
        """
        frames: list[FrameType] = []
        lines: list[int] = []
        while trace is not None:
            frames.append(trace.tb_frame)
            lines.append(trace.tb_lineno)
            trace = trace.tb_next
        for frame, line in zip(reversed(frames), reversed(lines), strict=True):
            if owners := owners_of(frame, self._drivers):
                return place_of(frame, line), owners
        return (place_of(frames[-1], lines[-1]) if frames else ""), []


def owners_of(frame: FrameType, drivers: Mapping[str, Driver]) -> list[str]:
    """The driver whose method this is; else those in whose folder its code is."""
    own = frame.f_locals.get("self")
    itself = [name for name, driver in drivers.items() if driver is own]
    return itself or owners_of_file(frame.f_code.co_filename, drivers)


def owners_of_file(path: str, drivers: Mapping[str, Driver]) -> list[str]:
    """Those whose class is in this file, or in its folder, if that is a package."""
    return [name for name, driver in drivers.items() if path.startswith(_code_of(type(driver)))]


def _code_of(driver: type[Driver]) -> str:
    module = sys.modules.get(driver.__module__)
    file = getattr(module, "__file__", None) or "?"
    return f"{Path(file).parent}/" if getattr(module, "__package__", "") else file


def place_of(frame: FrameType, line: int) -> str:
    """`driver.py:12 in read`."""
    return f"{Path(frame.f_code.co_filename).name}:{line} in {frame.f_code.co_name}"


def _unread(task: asyncio.Future[Any]) -> bool:
    """Whether it failed and nobody has asked how."""
    return bool(getattr(task, "_log_traceback", False))
