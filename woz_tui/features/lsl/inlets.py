"""Streams of other programs: each is looked for, taken, found to be lost and looked for again.

A thread each, because pylsl waits. Names, texts and rates are anybody's in the network: only
streams that the file names are taken, and of these no more than the session can use.
"""

from __future__ import annotations

import asyncio
import math
import threading
import time
from collections.abc import Callable, Sequence
from typing import Any

from woz_tui.features.lsl.kinds import LslClock, LslFound, LslLost, TakenStream
from woz_tui.features.lsl.library import clock_offset, text_of
from woz_tui.system.text_cleaning import one_line

#: Called with a stream's name, a value and its stamp on this computer's clock of LSL.
Took = Callable[[str, "str | float", float], None]
Told = Callable[[LslFound | LslLost | LslClock], None]

#: One look for a stream, and the time after which one that was never there counts as lost.
RESOLVE_S, MISSING_S = 1.0, 5.0
#: So often its clock is told, and so long its computer may not answer before it counts as lost.
CLOCK_S, SILENT_S = 10.0, 8.0
#: Markers a second, and at once, that are taken of one stream.
RATE, AT_ONCE = 50.0, 100.0
#: Characters of a text.
MOST_TEXT = 200
_PULL_S, _OPEN_S, _MOST_SAMPLES = 0.1, 5.0, 256


class Inlets:
    """The streams that a session takes.

    Args:
        lsl: The module `pylsl`.
        took: Called in the loop with what came.
        told: Called in the loop when a stream is there or lost, and how its clock stands.
    """

    def __init__(self, lsl: Any, took: Took, told: Told) -> None:
        self._lsl = lsl
        self._took = took
        self._told = told
        self._taken: dict[TakenStream, TakenInlet] = {}

    def take(self, streams: Sequence[TakenStream]) -> None:
        """From here on these are taken, and no others."""
        for stream in [each for each in self._taken if each not in streams]:
            self._taken.pop(stream).end()
        loop = asyncio.get_running_loop()
        for stream in streams:
            if stream not in self._taken:
                inlet = TakenInlet(self._lsl, stream, loop, self._took, self._told)
                self._taken[stream] = inlet
                inlet.start()

    def close(self) -> None:
        """Take none any more; waits for their threads."""
        for inlet in self._taken.values():
            inlet.end()
        for inlet in self._taken.values():
            inlet.join()
        self._taken.clear()


class TakenInlet(threading.Thread):
    """One stream that is taken."""

    def __init__(
        self,
        lsl: Any,
        stream: TakenStream,
        loop: asyncio.AbstractEventLoop,
        took: Took,
        told: Told,
    ) -> None:
        super().__init__(name=f"lsl {stream.stream}", daemon=True)
        self._lsl = lsl
        self._stream = stream
        self._loop = loop
        self._took = took
        self._told = told
        self._over = threading.Event()
        #: Whether the log knows that it is there; None: neither way.
        self._there: bool | None = None
        self._allowed, self._allowed_at = AT_ONCE, 0.0
        self._last = -math.inf
        self._too_fast = 0

    def end(self) -> None:
        """Take it no more."""
        self._over.set()

    def run(self) -> None:
        """Look for it, take it, until `end`."""
        looked = time.monotonic()
        while not self._over.is_set():
            infos = self._lsl.resolve_bypred(predicate(self._stream), 1, RESOLVE_S)
            if not infos:
                if self._there is None and time.monotonic() - looked >= MISSING_S:
                    self._lost("there is no such stream")
                continue
            info = max(infos, key=lambda each: float(each.created_at()))
            try:
                self._take(info)
            except (RuntimeError, TimeoutError):  # the first has all that pylsl raises besides
                self._lost("its program has ended, or its computer is not reached")

    def _take(self, info: Any) -> None:
        """Until it is lost, which raises, or `end`."""
        inlet = self._lsl.StreamInlet(info, recover=False, as_numpy=True)
        inlet.open_stream(_OPEN_S)
        offset, uncertainty, measured = clock_offset(self._lsl, inlet, _OPEN_S)
        self._found(info)
        heard = told = time.monotonic()
        self._clock(offset, uncertainty)
        while not self._over.is_set():
            samples, stamps = inlet.pull_chunk(_PULL_S, _MOST_SAMPLES)
            if len(samples):
                self._found(info)
            for sample, stamp in zip(samples, stamps, strict=False):
                self._sample(sample[0], float(stamp) + offset)
            now, before = time.monotonic(), measured
            offset, uncertainty, measured = clock_offset(self._lsl, inlet, _PULL_S)
            if measured != before or len(samples):
                heard = now
                self._found(info)
            elif now - heard >= SILENT_S:
                self._lost("its computer or program does not answer")
            if now - told >= CLOCK_S:
                told = now
                self._clock(offset, uncertainty)

    def _sample(self, value: Any, stamp: float) -> None:
        """One value; of what comes too fast some are left out."""
        if self._stream.use == "reading":
            number = number_of(value)
            if number is None or stamp - self._last < self._stream.every_us / 1e6:
                return
            self._last = stamp
            self._call(self._took, self._stream.stream, number, stamp)
            return
        now = time.monotonic()
        self._allowed = min(AT_ONCE, self._allowed + (now - self._allowed_at) * RATE)
        self._allowed_at = now
        if self._allowed < 1:
            self._too_fast += 1
            return
        self._allowed -= 1
        number = None if isinstance(value, bytes | str) else number_of(value)
        text = f"{number:g}" if number is not None else one_line(text_of(value))[:MOST_TEXT]
        self._call(self._took, self._stream.stream, text, stamp)

    # -- what the loop is told --------------------------------------------------------------------

    def _found(self, info: Any) -> None:
        if self._there:
            return
        self._there = True
        found = LslFound(
            stream=self._stream.stream,
            type=one_line(info.type())[:MOST_TEXT],
            source_id=one_line(info.source_id())[:MOST_TEXT],
            uid=info.uid(),
            host=one_line(info.hostname())[:MOST_TEXT],
        )
        self._call(self._told, found)

    def _lost(self, why: str) -> None:
        if self._there is not False:
            self._there = False
            self._call(self._told, LslLost(stream=self._stream.stream, why=why))

    def _clock(self, offset: float, uncertainty: float) -> None:
        clock = LslClock(
            stream=self._stream.stream,
            offset_us=round(offset * 1e6, 1),
            uncertainty_us=round(uncertainty * 1e6, 1),
            too_fast=self._too_fast,
        )
        self._call(self._told, clock)

    def _call(self, call: Callable[..., None], *args: Any) -> None:
        if not self._over.is_set():
            self._loop.call_soon_threadsafe(call, *args)


def predicate(stream: TakenStream) -> str:
    """Which streams are meant, as liblsl wants it (XPath 1.0)."""
    wanted = {"name": stream.stream, "source_id": stream.source_id, "type": stream.type}
    return " and ".join(f"{field}={_quoted(text)}" for field, text in wanted.items() if text)


def _quoted(text: str) -> str:
    if "'" not in text:
        return f"'{text}'"
    return '"' + text.replace('"', "") + '"'


def number_of(value: Any) -> float | None:
    """A number that is one."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        return None
    return number if math.isfinite(number) else None
