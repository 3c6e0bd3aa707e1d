"""Errors of a driver's own code that nobody waits for: each told once, and counted."""

from __future__ import annotations

import asyncio
import contextlib
import functools
import logging
import sys
import threading
import traceback
from collections import Counter
from collections.abc import Callable, Coroutine, Mapping, Sequence
from contextvars import Context
from pathlib import Path
from types import CodeType, FrameType, TracebackType
from typing import Any, Protocol

from woz_tui.bus.lane import IN_HOST_LOG
from woz_tui.config.study_words import PERCEIVED
from woz_tui.drivers.contract import Driver, Health, HealthStatement
from woz_tui.drivers.driver_call import CALLING
from woz_tui.protocol.messages import DriverFaulted, Notice
from woz_tui.protocol.sentence import Sentence
from woz_tui.system.clock import Clock, RealClock
from woz_tui.system.thread_calls import ThreadCalls

#: A task whose error nobody has asked for by then is one that nobody waits for, in seconds.
UNREAD_S = 1.0
#: A driver that says again how it is, and has had no error for so long, is well again.
QUIET_S = 10.0
#: What is said of a task that the garbage collector took while it waited.
THROWN_AWAY = "a task that nobody keeps was thrown away before its end"
#: An error's words may quote whatever was asked of the driver, and what it senses.
TELLS = ("request", *PERCEIVED)

log = logging.getLogger(__name__)


class FaultListener(Protocol):
    """Is told of faults: the session's hub."""

    def publish(self, message: DriverFaulted | Notice) -> object:
        """Tell everybody."""


class DriverFaults:
    """Publishes what went wrong in a driver's own tasks, timers, callbacks, threads and `__del__`.

    Args:
        hub: Gets a `DriverFaulted` for the first error at each place in a driver's code, and again
            with its count when there have been 10, 100, 1000 ...; a `Notice` where it can be
            several drivers', or where nobody knows whose it is.
        clock: Time.
        trace: Says where the traceback is.
    """

    def __init__(self, hub: FaultListener, clock: Clock, trace: str = IN_HOST_LOG) -> None:
        self._hub = hub
        self._clock = clock
        self._remedy = trace
        self._drivers: Mapping[str, Driver] = {}
        self._loop = asyncio.get_running_loop()
        self._calls = ThreadCalls(Sentence("session.error", "an error"))
        #: How often, by driver and place.
        self._counts: Counter[tuple[str, str]] = Counter()
        #: Places in nobody's code of which Python has written down an error.
        self._written: set[str] = set()
        #: Those that the driver's health shows now.
        self._shown: set[tuple[str, str]] = set()
        self._last_us: dict[str, int] = {}
        self._handler: Callable[..., object] | None = None
        self._factory: Any = None
        self._thread_hook = threading.excepthook
        self._unraisable_hook = sys.unraisablehook

    # -- telling -----------------------------------------------------------------------------

    def report(self, driver: str, place: str, words: str, trace: str) -> None:
        """An error at `place` of its code; `trace` is for the program's log. From any thread."""
        self._report([driver], place, words, trace)

    def _report(self, owners: Sequence[str], place: str, words: str, trace: str) -> None:
        tell = functools.partial(self._tell, owners, place, words, trace)
        self._calls.make(tell, keep=False)

    def _report_later(
        self,
        owners: Sequence[str],
        place: str,
        words: str,
        trace: str,
        as_before: Callable[[], object],
    ) -> None:
        """In the loop's next turn: what is found with garbage may be found inside a lock of the
        log. Of what is nobody's Python writes down by itself (`as_before`) where it came from, once
        for each place.
        """
        if not owners:
            trace = ""
            if place not in self._written:
                self._written.add(place)
                as_before()
        with contextlib.suppress(RuntimeError):  # the loop has closed: the session is over
            tell = functools.partial(self._tell, owners, place, words, trace)
            self._loop.call_soon_threadsafe(tell, context=Context())

    def _tell(self, owners: Sequence[str], place: str, words: str, trace: str) -> None:
        who = " or ".join(owners)
        key = who, place
        self._counts[key] += 1
        count = self._counts[key]
        times = f", {count} times" if count > 1 else ""
        said = f"{words} ({place}{times})"
        round_number = str(count).strip("0") == "1"
        if round_number:
            again = " so far" if count > 1 else trace and f"\n{trace}"
            log.error("%s: an error in its own code: %s%s", who or "a library", said, again)
        if len(owners) == 1:
            self._last_us[who] = self._clock.now_us()
            if round_number or key not in self._shown:
                self._shown.add(key)
                remedy = f"this is an error in the driver; {self._remedy}"
                self._hub.publish(
                    DriverFaulted(driver=who, detail=said, remedy=remedy, tells=TELLS)
                )
        elif round_number:
            nobody = Sentence("session.error_in_code", "An error in the code of no driver")
            text = Sentence("session.said_of", "{who}: {what}", who=who or nobody, what=said)
            self._hub.publish(
                Notice(
                    level="error" if who else "warning",
                    text=text,
                    remedy=self._remedy,
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
        factory: Any = self._make_task
        self._loop.set_task_factory(factory)
        threading.excepthook = self._on_thread_error
        self._unraisable_hook, sys.unraisablehook = sys.unraisablehook, self._on_unraisable

    def end(self) -> None:
        """Leave everything as it was."""
        self._loop.set_exception_handler(self._handler)
        self._loop.set_task_factory(self._factory)
        threading.excepthook = self._thread_hook
        sys.unraisablehook = self._unraisable_hook

    def raised(self, error: BaseException, driver: str = "") -> bool:
        """Tell of an error; False if it is no driver's. From any thread."""
        place, owners = self._owners(error.__traceback__)
        if driver:
            owners = [driver]
        if owners:
            self._report(owners, place, *_words_and_trace(error))
        return bool(owners)

    def _make_task(
        self, loop: asyncio.AbstractEventLoop, coro: Coroutine[Any, Any, Any], **more: Any
    ) -> asyncio.Task[Any]:
        """A task: of the driver in whose code it is made, if it is made in one."""
        task: asyncio.Task[Any]
        if self._factory is not None:
            task = self._factory(loop, coro, **more)
        else:
            task = _OwnedTask(coro, loop=loop, **more)
        if (call := CALLING.get()) is not None:
            if isinstance(task, _OwnedTask):
                task.driver = call.driver
            task.add_done_callback(self._task_ended, context=Context())
        return task

    def _task_ended(self, task: asyncio.Future[Any]) -> None:
        if not task.cancelled() and _unread(task):
            self._loop.call_later(UNREAD_S, self._look_again, task)

    def _look_again(self, task: asyncio.Future[Any]) -> None:
        if _unread(task) and (error := task.exception()) is not None:
            self.raised(error, _driver_of(task))

    def _on_loop_error(self, loop: asyncio.AbstractEventLoop, details: dict[str, Any]) -> None:
        error = details.get("exception")
        future = details.get("task") or details.get("future")
        as_before = functools.partial(
            self._handler or type(loop).default_exception_handler, loop, details
        )
        if future is not None:  # it is garbage, of whatever runs at the moment
            self._on_garbage(future, error, as_before)
            return
        context = getattr(details.get("handle"), "_context", None)
        call = context.get(CALLING) if context is not None else CALLING.get()
        if not isinstance(error, Exception) or not self.raised(error, call.driver if call else ""):
            as_before()

    def _on_garbage(
        self,
        future: asyncio.Future[Any],
        error: BaseException | None,
        as_before: Callable[[], object],
    ) -> None:
        words, trace = THROWN_AWAY, ""
        if error is None:
            coroutine = future.get_coro() if isinstance(future, asyncio.Task) else None
            place, owners = self._owners_of_code(getattr(coroutine, "cr_code", None))
        else:
            place, owners = self._owners(error.__traceback__)
            words, trace = _words_and_trace(error)
        if driver := _driver_of(future):
            owners = [driver]
        self._report_later(owners, place, words, trace, as_before)

    def _on_thread_error(self, args: threading.ExceptHookArgs) -> None:
        error = args.exc_value
        if isinstance(error, Exception):
            place, owners = self._owners(args.exc_traceback)
            words, trace = _words_and_trace(error)
            self._report_later(
                owners, place, words, trace, functools.partial(self._thread_hook, args)
            )
        else:
            self._thread_hook(args)

    def _on_unraisable(self, args: sys.UnraisableHookArgs) -> None:
        """An error in a `__del__` and the like, which Python can hand to nobody."""
        place, owners = self._owners(args.exc_traceback)
        if not place:
            place, owners = self._owners_of_code(getattr(args.object, "__code__", None))
        error = args.exc_value if args.exc_value is not None else args.exc_type()
        words, trace = _words_and_trace(error)
        self._report_later(
            owners, place, words, trace, functools.partial(self._unraisable_hook, args)
        )

    # -- whose it is -------------------------------------------------------------------------

    def _owners(self, trace: TracebackType | None) -> tuple[str, list[str]]:
        """The innermost place in a driver's code, and whose that can be; the innermost of all if
        it is nobody's.
        """
        frames = [*traceback.walk_tb(trace)]
        for frame, line in reversed(frames):
            if owners := owners_of(frame, self._drivers):
                return place_of(frame, line), owners
        return (place_of(*frames[-1]) if frames else ""), []

    def _owners_of_code(self, code: CodeType | None) -> tuple[str, list[str]]:
        """The same of code that does not run any more; None: it is not known."""
        if code is None:
            return "", []
        place = f"{Path(code.co_filename).name}:{code.co_firstlineno} in {code.co_name}"
        return place, owners_of_file(code.co_filename, self._drivers)


class _OwnedTask(asyncio.Task[Any]):
    """A task that knows in whose code it was made, also as garbage, which no mapping holds."""

    driver = ""


class _DriversTell:
    """Is told of errors where there is no session: the driver that they are of says it."""

    def __init__(self, drivers: Mapping[str, Driver]) -> None:
        self._drivers = drivers

    def publish(self, message: DriverFaulted | Notice) -> None:
        """What is nobody's, or of several drivers whom it names, one of them says."""
        if isinstance(message, Notice):
            for each in [*self._drivers.values()][:1]:
                each.context.notice(
                    message.level, message.text, message.remedy, tells=(*message.tells,)
                )
        elif (driver := self._drivers.get(message.driver)) is not None:
            driver.context.publish(
                HealthStatement(
                    Health.FAULTED, message.detail, message.remedy, tells=(*message.tells,)
                )
            )


def tell_faults(drivers: Mapping[str, Driver], trace: str = IN_HOST_LOG) -> None:
    """From here on drivers that are served to a session elsewhere tell it of their own errors.
    `trace` says where the tracebacks are.
    """
    DriverFaults(_DriversTell(drivers), RealClock(), trace).begin(drivers)


def _driver_of(future: asyncio.Future[Any]) -> str:
    return future.driver if isinstance(future, _OwnedTask) else ""


def _words_and_trace(error: BaseException) -> tuple[str, str]:
    return f"{type(error).__name__}: {error}", "".join(traceback.format_exception(error))


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
