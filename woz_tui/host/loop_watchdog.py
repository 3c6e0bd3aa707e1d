"""Names who holds up the robot process: nothing else runs in it meanwhile, not even the stop."""

from __future__ import annotations

import asyncio
import faulthandler
import linecache
import logging
import os
import re
import signal
import sys
import sysconfig
import threading
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import FrameType
from typing import Any, NamedTuple

import msgspec

from woz_tui.bus.driver_call import CALLING, LONG_STEPS, DriverCall, LongStep
from woz_tui.bus.hub import Hub
from woz_tui.drivers.contract import Driver
from woz_tui.protocol.messages import AnyMessage, ProcessStalled, SessionEnd
from woz_tui.session.driver_faults import owners_of_file

#: A loop that gives no sign of life for so much longer than usual stands still, in seconds.
STALL_S = 0.25
#: How often it gives one, and how often a thread looks.
BEAT_S = 0.1
#: A standstill that lasts so long is told in the program's log before it is over.
TOLD_S = 2.0
#: A thread that cannot look for so long does not get the interpreter: then C code writes down where
#: all threads are. Each `_ARMED_S` that is put off, while the thread can look.
_DUMP_S, _ARMED_S = 0.6, 0.3
#: So often it is looked where the loop is, while it stands still.
_SIGHTS = 50
#: Longest line of code that is told.
_CODE = 80

_STDLIB = (f"{sysconfig.get_path('stdlib')}/", f"{sysconfig.get_path('platstdlib')}/", "<frozen")
_PACKAGES = tuple(f"{sysconfig.get_path(name)}/" for name in ("purelib", "platlib"))
_THREAD = re.compile(r"^Thread 0x([0-9a-f]+)", re.MULTILINE)
_FRAME = re.compile(r'^  File "(.*)", line (\d+) in (.*)$', re.MULTILINE)

log = logging.getLogger(__name__)


class CodePlace(NamedTuple):
    """A line of code that runs."""

    file: str
    line: int
    function: str


@dataclass(frozen=True, slots=True)
class Sight:
    """What the loop's thread did at a moment: innermost line first; `call` as `CALLING`. `others`:
    the lines of other threads, where these were seen.
    """

    lines: Sequence[CodePlace]
    call: DriverCall | None = None
    others: Sequence[CodePlace] = ()


class LoopWatchdog:
    """Tells of each standstill of the running loop when it is over, until the session ends.

    A thread looks where the loop is. C code that keeps the interpreter's lock stops that thread as
    well; then `faulthandler` writes down where it is.

    Args:
        drivers: Whose code it may be.
        hub: Gets a `ProcessStalled` for each.
    """

    def __init__(self, drivers: Mapping[str, Driver], hub: Hub) -> None:
        self._drivers = drivers
        self._hub = hub
        hub.listen(self._on_message)
        self._loop = asyncio.get_running_loop()
        self._thread = threading.get_ident()
        self._beat_s = time.monotonic()
        self._timer: asyncio.TimerHandle | None = None
        self._turns = -1
        self._spent = (0, 0, 0)
        #: What the thread has seen since the last beat, the oldest first.
        self._sights: list[Sight] = []
        self._continued = False
        self._ended = threading.Event()
        self._dump = os.memfd_create("where threads are", os.MFD_CLOEXEC)
        try:
            self._turns = os.open("/proc/thread-self/schedstat", os.O_RDONLY | os.O_CLOEXEC)
        except OSError:
            log.warning("this kernel does not tell how long a thread waits for a processor")
        signal.signal(signal.SIGCONT, self._on_continue)
        self._beat_s, self._spent = time.monotonic(), self._times()
        self._beat()
        threading.Thread(target=self._look, name="watchdog", daemon=True).start()

    def _on_message(self, message: AnyMessage) -> None:
        if not isinstance(message, SessionEnd):
            return
        self._ended.set()
        faulthandler.cancel_dump_traceback_later()
        signal.signal(signal.SIGCONT, signal.SIG_DFL)
        if self._timer is not None:
            self._timer.cancel()

    # -- in the loop -------------------------------------------------------------------------

    def _beat(self) -> None:
        now, before = time.monotonic(), self._beat_s
        spent, spent_before = self._times(), self._spent
        sights, continued = self._sights, self._continued
        self._beat_s, self._spent = now, spent
        self._sights, self._continued = [], False
        self._timer = self._loop.call_later(BEAT_S, self._beat)
        dumped = self._dumped()  # also where only the other thread was held up: it is over
        if now - before > BEAT_S + STALL_S:
            sights += sights_in(dumped, self._thread)
            others_s = (spent[2] - spent_before[2] - spent[0] + spent_before[0]) / 1e9
            if others_s < (now - before) / 2:  # no other thread kept the interpreter by its work
                sights = [replace(sight, others=()) for sight in sights]
            steps = [step for step in LONG_STEPS if step.ended >= before]
            step = max(steps, key=lambda step: step.seconds, default=None)
            waited_s = (spent[1] - spent_before[1]) / 1e9
            self._tell(now - before, waited_s, sights, step, continued)

    def _tell(
        self,
        gap_s: float,
        waited_s: float,
        sights: Sequence[Sight],
        step: LongStep | None,
        continued: bool,
    ) -> None:
        sight = sight_during(step.of if step else None, sights, self._drivers)
        driver, call = whose(sight, step.of if step else None, self._drivers)
        place = place_in(sight, driver, self._drivers)
        idle = sight is not None and not driver and not place
        why = cause(gap_s, waited_s, continued, idle=idle)
        seconds = max(gap_s - BEAT_S, step.seconds if step else 0.0)
        stall = ProcessStalled(duration_us=round(seconds * 1e6), cause=why)
        if why == "blocked":
            stall = msgspec.structs.replace(stall, driver=driver, call=call, place=place)
        log.warning("%s", sentence(stall))
        self._hub.publish(stall)

    def _times(self) -> tuple[int, int, int]:
        """Nanoseconds for which this thread has run, and waited for a processor; for which all
        threads have run.
        """
        if self._turns < 0:
            return time.thread_time_ns(), 0, time.process_time_ns()
        run, waited, *_ = os.pread(self._turns, 64, 0).split()
        return int(run), int(waited), time.process_time_ns()

    def _dumped(self) -> str:
        size = os.fstat(self._dump).st_size
        if not size:
            return ""
        text = os.pread(self._dump, size, 0).decode(errors="replace")
        os.ftruncate(self._dump, 0)
        os.lseek(self._dump, 0, os.SEEK_SET)
        return text

    def _on_continue(self, number: int, frame: FrameType | None) -> None:
        self._continued = True

    # -- in a thread -------------------------------------------------------------------------

    def _look(self) -> None:
        told_s, armed_s = 0.0, 0.0
        while not self._ended.wait(BEAT_S):
            now, beat_s = time.monotonic(), self._beat_s
            if now - armed_s > _ARMED_S:
                armed_s = now
                faulthandler.dump_traceback_later(_DUMP_S, repeat=True, file=self._dump)
                if self._ended.is_set():  # meanwhile
                    faulthandler.cancel_dump_traceback_later()
            if now - beat_s <= STALL_S:
                continue
            frame, sights = sys._current_frames().get(self._thread), self._sights
            if frame is not None and self._beat_s == beat_s and len(sights) < _SIGHTS:
                sights.append(sight_of(frame))
            if now - beat_s > TOLD_S and told_s != beat_s:
                told_s = beat_s
                sight = sight_during(None, sights, self._drivers)
                driver, call = whose(sight, None, self._drivers)
                place = place_in(sight, driver, self._drivers)
                seconds = round((now - beat_s) * 1e6)
                stall = ProcessStalled(driver=driver, call=call, place=place, duration_us=seconds)
                log.error("%s, and still does", sentence(stall))


def sight_during(
    call: DriverCall | None, sights: Sequence[Sight], drivers: Mapping[str, Driver]
) -> Sight | None:
    """The last sight of this call, as far as can be told; else the last of all."""
    during = [sight for sight in sights if call is not None and sight.call is call]
    if call is not None and not during:
        during = [
            sight
            for sight in sights
            if any(call.driver in owners_of_file(each.file, drivers) for each in sight.lines)
        ]
    return next(iter((*during[-1:], *sights[-1:])), None)


def sight_of(frame: FrameType) -> Sight:
    """What a thread does whose innermost frame this is."""
    lines, call, found = [], None, False
    inner: FrameType | None = frame
    while inner is not None:
        code = inner.f_code
        lines.append(CodePlace(code.co_filename, inner.f_lineno, code.co_name))
        if not found and code.co_name == "_run" and code.co_filename == asyncio.events.__file__:
            context: Any = getattr(inner.f_locals.get("self"), "_context", None)
            call, found = context.get(CALLING) if context is not None else None, True
        inner = inner.f_back
    return Sight(lines, call)


def sights_in(dumps: str, thread: int) -> list[Sight]:
    """What `thread` did, in what `faulthandler` wrote."""
    sights = []
    for dump in dumps.split("Timeout (")[1:][-_SIGHTS:]:
        lines: list[CodePlace] = []
        others: list[CodePlace] = []
        _, *parts = _THREAD.split(dump)
        for number, text in zip(parts[::2], parts[1::2], strict=True):
            found = [CodePlace(file, int(line), name) for file, line, name in _FRAME.findall(text)]
            (lines if int(number, 16) == thread else others).extend(found)
        sights.append(Sight(lines, others=others))
    return sights


def whose(
    sight: Sight | None, step: DriverCall | None, drivers: Mapping[str, Driver]
) -> tuple[str, str]:
    """Which driver's code it is, and in which call; empty: none's, or none of them. `step`: the
    call that is known to have held the loop.
    """
    call = step or (sight.call if sight else None)
    if call is not None:
        return call.driver, "" if call.over and step is None else call.call
    lines = (*sight.lines, *sight.others) if sight else ()
    for place in lines:
        owners = owners_of_file(place.file, drivers)
        if owners:
            return owners[0] if len(owners) == 1 else "", ""
    return "", ""


def place_in(sight: Sight | None, driver: str, drivers: Mapping[str, Driver]) -> str:
    """The innermost line of code that is not Python's own: `driver.py:12 in perform: sleep(4)`.
    Empty: the loop had nothing to do.
    """
    lines = [each for each in sight.lines if not _is_python(each.file)] if sight else []
    if sight and sight.lines and sight.lines[0].function == "select":
        lines = []
    if sight and not lines and driver:
        lines = [each for each in sight.others if driver in owners_of_file(each.file, drivers)]
    if not lines:
        return ""
    place = lines[0]
    code = linecache.getline(place.file, place.line).strip()[:_CODE]
    return f"{Path(place.file).name}:{place.line} in {place.function}{code and f': {code}'}"


def cause(gap_s: float, waited_s: float, continued: bool, *, idle: bool) -> str:
    """Why it stood still: see `ProcessStalled`. Of the `gap_s` between two beats it waited for a
    processor for `waited_s`: is that alone the reason?
    """
    if continued:
        return "stopped"
    if gap_s - waited_s <= BEAT_S + STALL_S:
        return "starved"
    return "stopped" if idle else "blocked"


def sentence(stall: ProcessStalled) -> str:
    """`robot held up the robot process for 4.0 s (perform say, driver.py:12 in ...)`."""
    seconds = f"{stall.duration_us / 1e6:.1f} s"
    where = ", ".join(filter(None, (stall.call, stall.place)))
    behind = f" ({where})" if where else ""
    match stall.cause:
        case "starved":
            return f"the robot process got no processor time for {seconds}"
        case "stopped":
            return f"the robot process was stopped for {seconds}"
    who = stall.driver or "the robot process itself"
    return f"{who} held up the robot process for {seconds}{behind}"


def _is_python(file: str) -> bool:
    return file.startswith(_STDLIB) and not file.startswith(_PACKAGES)
