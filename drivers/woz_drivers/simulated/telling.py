"""What the simulated microphone tells of a visitor's voice, and what it keeps to itself while it is
unplugged.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

from woz_drivers.simulated.hearing import Speech
from woz_tui.core.driver import Outlet
from woz_tui.core.messages import SpeechEnded, SpeechStarted, SpeechText


class Teller:
    """Speech as messages. `clock_us` gives the clock at a second of the simulated world."""

    def __init__(self, driver: str, outlet: Outlet, clock_us: Callable[[float], int]) -> None:
        self._driver = driver
        self._outlet = outlet
        self._clock_us = clock_us
        self._open = 0
        self._began = 0
        self._understood: set[int] = set()

    def tell(self, speech: Iterable[Speech]) -> None:
        """What happened, in order."""
        for one in speech:
            if one.what == "started":
                self._start(one)
            elif one.what == "ended" and one.segment == self._open:
                self._end(one.ended, one.loudest, "")
                self._understood.add(one.segment)
            elif one.what == "text" and one.segment in self._understood:
                self._understood.discard(one.segment)
                took_us = self._clock_us(one.t) - self._clock_us(one.ended)
                self._outlet.tell(
                    SpeechText(
                        driver=self._driver, segment=one.segment, text=one.text, took_us=took_us
                    )
                )

    def break_off(self, t: float, why: str) -> None:
        """The microphone is gone, and whoever spoke will never be heard to have ended."""
        if self._open:
            self._end(t, None, f"the sound broke off: {why}")
        self._understood.clear()

    def _start(self, one: Speech) -> None:
        self._open = one.segment
        self._began = self._t(one.began)
        self._outlet.tell(
            SpeechStarted(driver=self._driver, segment=one.segment, began=self._began)
        )

    def _end(self, t: float, loudest: float | None, detail: str) -> None:
        segment, self._open = self._open, 0
        self._outlet.tell(
            SpeechEnded(
                driver=self._driver,
                segment=segment,
                began=self._began,
                ended=self._t(t),
                loudest=loudest,
                detail=detail,
            )
        )

    def _t(self, t: float) -> int:
        return self._outlet.t(self._clock_us(t))
