"""Distances out of a sensor's bytes, or why there are none: for session and `woz doctor` alike."""

from __future__ import annotations

from collections.abc import Iterator

from woz_drivers.rangefinder.settings import RangefinderSettings
from woz_drivers.rangefinder.wire import Measurement

#: So many of the last bytes are shown.
_SHOWN = 16
_NOTHING = "point it at a wall; `ceiling` says what nothing in range is worth"


class DistanceReader:
    """What comes over one connection.

    Attributes:
        accepted: How many distances were taken.
        refused: How many were not: nothing was in range, it is none that can be, or it jumps.
    """

    def __init__(self, settings: RangefinderSettings) -> None:
        self._settings = settings
        self._decoder = settings.decoder()
        self._filter = settings.filter()
        self._out_of_range = 0
        self._last_bytes = b""
        #: Why the last value was refused; the first: unless one was taken since.
        self._why = self._last_why = ("", "")
        self.accepted = self.refused = 0

    @property
    def malformed(self) -> int:
        """How many frames or lines were none."""
        return self._decoder.bad

    @property
    def bad(self) -> int:
        """How many frames were thrown away: malformed, or out of range."""
        return self._decoder.bad + self._out_of_range

    def feed(self, data: bytes) -> Iterator[tuple[float, float]]:
        """Each distance that is taken, in metres, and the device's own number."""
        self._last_bytes = (self._last_bytes + data)[-_SHOWN:]
        for measurement in self._decoder.feed(data):
            metres = self._taken(measurement)
            if metres is not None:
                self.accepted += 1
                self._why, self._last_bytes = ("", ""), b""
                yield metres, measurement.raw

    def _taken(self, measurement: Measurement) -> float | None:
        metres, ceiling = measurement.metres, self._settings.ceiling
        stands_for_far = metres is not None and ceiling is not None and metres >= ceiling
        if metres is None or (measurement.why and not stands_for_far):
            self._refuse(measurement.why, _NOTHING)
            return None
        verdict = self._filter.judge(metres)
        if verdict.why == "range":
            self._out_of_range += 1
            self._refuse(*self._beyond(metres))
        elif verdict.why == "jump":
            self._refuse("the distance jumps", "is it one sensor? see `jump` and `column`")
        return verdict.metres

    def _refuse(self, what: str, remedy: str) -> None:
        self.refused += 1
        self._why = self._last_why = (what, remedy)

    def _beyond(self, metres: float) -> tuple[str, str]:
        settings = self._settings
        allowed = f"{settings.nearest:g} to {settings.farthest:g} m"
        what = f"{metres:.2f} m is out of range ({allowed})"
        if metres == 0:
            return f"{what}: so sensors say that they hear no echo", "point it at a wall"
        return what, "check `unit`, and what the sensor says when it hears no echo"

    def no_distance(self) -> tuple[str, str]:
        """Why none was taken since the last one that was, and what to do about it."""
        settings = self._settings
        if not self._last_bytes:
            return f"{settings.port} sends nothing", "check the sensor's power and wiring"
        if self._why[0]:
            return self._why
        return self._unreadable()

    def main_trouble(self) -> tuple[str, str]:
        """Why most of what was not taken was not, and what to do about it."""
        return self._last_why if self.refused >= self.malformed else self._unreadable()

    def _unreadable(self) -> tuple[str, str]:
        if self._decoder.trouble[0]:
            return self._decoder.trouble
        settings = self._settings
        expected = f"{settings.framing} at {settings.real_baud} baud"
        what = f"what comes is not {expected}: {self._last_bytes!r}"
        return what, "check framing and baud; an Arduino ends a line with println"
