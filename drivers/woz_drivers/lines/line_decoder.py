"""Lines of text out of a device's bytes, in pieces of any size."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, TypeVar

#: What a line says.
T = TypeVar("T")
#: A line longer than this, in bytes, is noise.
MAX_LINE = 160
_LINES_REMEDY = "check framing and baud; an Arduino ends a line with println"


class LineError(ValueError):
    """A line that says nothing; `remedy`: what to do about it."""

    def __init__(self, what: str, remedy: str) -> None:
        super().__init__(what)
        self.remedy = remedy


class LineDecoder(Generic[T]):
    """Text that ends with CR, LF or both.

    `read(line)` gives what a line says, or raises `LineError`. `first_line`: whether the line under
    way at the moment of connecting can be trusted; a tail such as `23` of `123` cannot be told from
    a reading.
    """

    def __init__(self, read: Callable[[bytes], T], first_line: bool) -> None:
        self.bad = 0
        self.trouble = ("", "")
        self._read = read
        self._line = bytearray()
        self._skipping = not first_line

    def feed(self, data: bytes) -> list[T]:
        """What the lines say that `data` completes, in order."""
        found: list[T] = []
        for byte in data:
            if byte in b"\r\n":
                measurement = self._end_of_line()
                if measurement is not None:
                    found.append(measurement)
            elif not self._skipping:
                self._line.append(byte)
                if len(self._line) > MAX_LINE:
                    self._is_bad(f"no line ends within {MAX_LINE} bytes", _LINES_REMEDY)
                    self._line.clear()
                    self._skipping = True
        return found

    def _end_of_line(self) -> T | None:
        line = bytes(self._line).strip()
        self._line.clear()
        if self._skipping:
            self._skipping = False
            return None
        if not line:
            return None
        try:
            return self._read(line)
        except LineError as error:
            self._is_bad(str(error), error.remedy)
            return None

    def _is_bad(self, what: str, remedy: str) -> None:
        self.bad += 1
        self.trouble = (what, remedy)
