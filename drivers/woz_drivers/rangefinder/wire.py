"""How rangefinders say a distance on the wire: incremental decoders, free of any input or output.

A decoder takes bytes in pieces of any size and gives the measurements they complete. It never
raises, and finds its way back after any noise; what it has to throw away it counts in `bad`.

Sources: MaxBotix data sheets (LV-, XL- and HRXL-MaxSonar, "RS232 serial output"), Benewake
SJ-PM-TFmini-T-01 and TF-Luna A05, DFRobot SEN0313 (A02YYUW), JSN-SR04T-2.0 mode 2.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Protocol

from woz_drivers.lines.line_decoder import LineDecoder, LineError
from woz_drivers.rangefinder.text_lines import distance_in

#: Metres in one unit.
METRES: Mapping[str, float] = {"mm": 0.001, "cm": 0.01, "in": 0.0254, "m": 1.0}
UNITS = tuple(METRES)


@dataclass(frozen=True, slots=True)
class Measurement:
    """One well-formed frame.

    `raw` is the device's number in its own unit, `metres` the same in metres, or None if the
    frame itself says that nothing was measured; then `why` says so in words. With both the number
    stands for nothing in range.
    """

    raw: float
    metres: float | None
    why: str = ""


class DistanceDecoder(Protocol):
    """Bytes in, measurements out.

    Attributes:
        bad: The frames or lines that were thrown away so far.
        trouble: Why the last of these was, if that can be said, and what to do about it.
    """

    bad: int
    trouble: tuple[str, str]

    def feed(self, data: bytes) -> list[Measurement]:
        """The measurements that `data` completes, in order."""
        ...


class FrameDecoder:
    """Binary frames of one length that begin with `header` and hold a checksum.

    `read(frame)` turns a frame whose checksum is right into a measurement. After a wrong one the
    search goes on one byte later, so a true frame behind noise is never lost.
    """

    def __init__(
        self,
        header: bytes,
        length: int,
        read: Callable[[bytes], Measurement],
    ) -> None:
        self.bad = 0
        self.trouble = ("", "")
        self._header = header
        self._length = length
        self._read = read
        self._buffer = bytearray()

    def feed(self, data: bytes) -> list[Measurement]:
        """The measurements that `data` completes, in order."""
        self._buffer += data
        found = []
        while self._find_header() and len(self._buffer) >= self._length:
            frame = bytes(self._buffer[: self._length])
            if sum(frame[:-1]) & 0xFF == frame[-1]:
                found.append(self._read(frame))
                del self._buffer[: self._length]
            else:
                self.bad += 1
                del self._buffer[:1]
        return found

    def _find_header(self) -> bool:
        """Drop what cannot begin a frame; whether a whole header stands in front."""
        start = self._buffer.find(self._header)
        if start < 0:
            start = len(self._buffer) - self._unfinished_header()
        del self._buffer[:start]
        return len(self._buffer) >= len(self._header)

    def _unfinished_header(self) -> int:
        """How many bytes at the end may be the beginning of a header."""
        for length in range(len(self._header) - 1, 0, -1):
            if self._buffer.endswith(self._header[:length]):
                return length
        return 0


@dataclass(frozen=True, slots=True)
class Framing:
    """One way of talking: what it is, its usual rate and unit, and how to decode it.

    `decoder(unit, min_strength, column)` makes a fresh decoder for one connection.
    """

    summary: str
    baud: int
    unit: str
    decoder: Callable[[str, int, int], DistanceDecoder]


# MaxBotix: "R", three digits (LV in inches, XL in cm) or four (HR in mm), on some models followed
# by the proximity flag " P0" or " P1", then a carriage return.
_MAXBOTIX = re.compile(rb"R(?P<number>\d{3,4})(?: P[01])?")

#: What these say when they see nothing, in their units: HRXL up to 5 and to 10 m, XL, LV.
_MAXBOTIX_NOTHING = {"mm": (5000, 9999), "cm": (765, 1068), "in": (254, 255)}
NOTHING = "nothing is in its range"

#: Strengths that mean "saturated" in the TFmini family.
_SATURATED = 0xFFFF
#: From here on, the TFmini family's distances are error codes (-1 weak, -2 saturated, -4 sun).
_LIDAR_ERRORS = 0xFFFC


def _maxbotix(unit: str, _min_strength: int, _column: int) -> DistanceDecoder:
    def read(line: bytes) -> Measurement:
        match = _MAXBOTIX.fullmatch(line)
        if match is None:
            raise LineError("", "")
        raw = int(match["number"])
        nothing = raw in _MAXBOTIX_NOTHING.get(unit, ())
        return Measurement(raw, raw * METRES[unit], NOTHING if nothing else "")

    return LineDecoder(read, first_line=True)


def _plain(unit: str, _min_strength: int, column: int) -> DistanceDecoder:
    def read(line: bytes) -> Measurement:
        number = distance_in(line, column)
        return Measurement(number.value, number.value * METRES[number.unit or unit])

    return LineDecoder(read, first_line=False)


def _tfmini(unit: str, min_strength: int, _column: int) -> DistanceDecoder:
    scale = METRES[unit]

    def read(frame: bytes) -> Measurement:
        raw = int.from_bytes(frame[2:4], "little")
        strength = int.from_bytes(frame[4:6], "little")
        if strength == _SATURATED or raw >= _LIDAR_ERRORS:
            return Measurement(raw, None, "saturated or error code")
        if strength < min_strength:
            return Measurement(raw, None, f"weak echo (strength {strength})")
        if raw == 0:
            return Measurement(raw, None, "no echo")
        return Measurement(raw, raw * scale)

    return FrameDecoder(b"\x59\x59", 9, read)


def _a02(unit: str, _min_strength: int, _column: int) -> DistanceDecoder:
    scale = METRES[unit]

    def read(frame: bytes) -> Measurement:
        raw = int.from_bytes(frame[1:3], "big")
        if raw == 0:
            return Measurement(raw, None, "no echo")
        return Measurement(raw, raw * scale)

    return FrameDecoder(b"\xff", 4, read)


#: Every framing by the name it has in a robot file.
FRAMINGS: Mapping[str, Framing] = {
    "maxbotix": Framing("MaxBotix ultrasonic sensors, text Rddd or Rdddd", 9600, "cm", _maxbotix),
    "lines": Framing("one number a line, as an Arduino prints it", 9600, "cm", _plain),
    "tfmini": Framing("Benewake TFmini and TF-Luna lidars, binary", 115200, "cm", _tfmini),
    "a02": Framing("A02YYUW and JSN-SR04T ultrasonic sensors, binary", 9600, "mm", _a02),
}
