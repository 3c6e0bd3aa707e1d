"""Names who holds up the robot process: nothing else runs in it meanwhile, not even the stop."""

from __future__ import annotations

import asyncio
import functools
import linecache
import logging
import signal
import sys
import threading
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from operator import attrgetter
from pathlib import Path
from types import FrameType
from typing import Any, NamedTuple

import msgspec

from woz_tui.bus.hub import Hub
from woz_tui.drivers.contract import Driver
from woz_tui.drivers.driver_call import CALLING, LONG_STEPS, DriverCall
from woz_tui.protocol.messages import ProcessStalled, SessionEnd
from woz_tui.session.driver_faults import owners_of_file
from woz_tui.system.processor_time import STALL_S, ProcessorWaits

#: How often it gives one, and how often a thread looks.
BEAT_S = 0.1
#: A standstill that lasts so long is told in the program's log before it is over.
TOLD_S = 2.0
#: So often it is looked where the loop is, while it stands still.
_SIGHTS = 50
#: Longest line of code that is told.
_CODE = 80

log = logging.getLogger(__name__)


class CodePlace(NamedTuple):
    """A line of code that runs."""

    file: str
    line: int
    function: str


@dataclass(frozen=True, slots=True)
class Sight:
    """What the loop's thread did at a moment: innermost line first; `call` as `CALLING`."""

    lines: Sequence[CodePlace]
    call: DriverCall | None = None


class LoopWatchdog:
    """Tells of each standstill of the running loop when it is over, until the session ends.

    A thread looks where the loop is. C code that keeps the interpreter's lock stops that thread as
    well; then only the call into the driver is known (`LONG_STEPS`), not the line of code.
    (`faulthandler.dump_traceback_later` would tell that, but it reads the frames of threads that
    run, and that ends the process now and then: seen after dozens of SIGCONT.)

    Args:
        drivers: Whose code it may be.
        hub: Gets a `ProcessStalled` for each.
    """

    def __init__(self, drivers: Mapping[str, Driver], hub: Hub) -> None:
        self._drivers = drivers
        self._hub = hub
        hub.listen(self._on_end, SessionEnd)
        self._loop = asyncio.get_running_loop()
        self._thread = threading.get_ident()
        self._beat_s = time.monotonic()
        self._timer: asyncio.TimerHandle | None = None
        self._waits = ProcessorWaits()
        #: What the thread has seen since the last beat, the oldest first.
        self._sights: list[Sight] = []
        self._continued = False
        self._ended = threading.Event()
        signal.signal(signal.SIGCONT, self._on_continue)
        self._beat_s, self._waited_s = self._waits.now()
        self._beat()
        threading.Thread(target=self._look, name="watchdog", daemon=True).start()

    def _on_end(self, message: SessionEnd) -> None:
        self._ended.set()
        signal.signal(signal.SIGCONT, signal.SIG_DFL)
        if self._timer is not None:
            self._timer.cancel()

    # -- in the loop -------------------------------------------------------------------------

    def _beat(self) -> None:
        before, waited_before_s = self._beat_s, self._waited_s
        now, waited_s = self._waits.now()
        sights, continued = self._sights, self._continued
        self._beat_s, self._waited_s = now, waited_s
        self._sights, self._continued = [], False
        self._timer = self._loop.call_later(BEAT_S, self._beat)
        if now - before <= BEAT_S + STALL_S:
            return
        steps = [step for step in LONG_STEPS if step.ended >= before]
        step = max(steps, key=attrgetter("seconds"), default=None)
        sight = sight_during(step.of if step else None, sights, self._drivers)
        driver, call = whose(sight, step.of if step else None, self._drivers)
        place = place_in(sight)
        idle = sight is not None and not driver and not place
        why = cause(now - before, waited_s - waited_before_s, continued, idle=idle)
        seconds = max(now - before - BEAT_S, step.seconds if step else 0.0)
        stall = ProcessStalled(duration_us=round(seconds * 1e6), cause=why)
        if why == "blocked":
            stall = msgspec.structs.replace(stall, driver=driver, call=call, place=place)
        log.warning("%s", sentence(stall))
        self._hub.publish(stall)

    def _on_continue(self, number: int, frame: FrameType | None) -> None:
        self._continued = True

    # -- in a thread -------------------------------------------------------------------------

    def _look(self) -> None:
        reported_s = 0.0
        while not self._ended.wait(BEAT_S):
            now, beat_s = time.monotonic(), self._beat_s
            if now - beat_s <= STALL_S:
                continue
            frame, sights = sys._current_frames().get(self._thread), self._sights
            if frame is not None and self._beat_s == beat_s and len(sights) < _SIGHTS:
                sights.append(sight_of(frame))
            if now - beat_s > TOLD_S and reported_s != beat_s:
                reported_s = beat_s
                sight = sight_during(None, sights, self._drivers)
                driver, call = whose(sight, None, self._drivers)
                place = place_in(sight)
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


def whose(
    sight: Sight | None, step: DriverCall | None, drivers: Mapping[str, Driver]
) -> tuple[str, str]:
    """Which driver's code it is, and in which call; empty: none's, or none of them. `step`: the
    call that is known to have held the loop.
    """
    call = step or (sight.call if sight else None)
    if call is not None:
        return call.driver, "" if call.over and step is None else call.call
    for place in sight.lines if sight else ():
        owners = owners_of_file(place.file, drivers)
        if owners:
            return owners[0] if len(owners) == 1 else "", ""
    return "", ""


def place_in(sight: Sight | None) -> str:
    """The innermost line of code that is not Python's own: `driver.py:12 in perform: sleep(4)`.
    Empty: the loop had nothing to do.
    """
    lines = [each for each in sight.lines if not _is_python(each.file)] if sight else []
    if sight and sight.lines and sight.lines[0].function == "select":
        lines = []
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


@functools.cache
def _is_python(file: str) -> bool:
    """Whether it is code of Python's own, and of no package that lies within that."""
    import sysconfig  # noqa: PLC0415 - most sessions never stall

    library = [f"{sysconfig.get_path(name)}/" for name in ("stdlib", "platstdlib")]
    packages = [f"{sysconfig.get_path(name)}/" for name in ("purelib", "platlib")]
    return file.startswith((*library, "<frozen")) and not file.startswith(tuple(packages))
