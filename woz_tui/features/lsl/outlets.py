"""The session's streams: markers in short words, the log's lines, chosen sensors.

All have no nominal rate: readers that smooth the stamps of a rate (pyxdf) would move them by tens
of milliseconds. A stamp is the event's own time, on CLOCK_MONOTONIC, which is LSL's clock.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from woz_tui import __version__
from woz_tui.features.lsl.kinds import EVENTS, MARKERS, LslStream
from woz_tui.protocol import messages as m

#: Their types.
_TYPES = {MARKERS: "Markers", EVENTS: "Events"}


@dataclass(slots=True)
class SentStream:
    """A stream that is sent, and whether somebody takes it."""

    name: str
    type: str
    outlet: Any
    source_id: str
    uid: str
    taken: bool = False

    def told(self) -> LslStream:
        """As the log has it."""
        return LslStream(
            stream=self.name,
            type=self.type,
            source_id=self.source_id,
            uid=self.uid,
            taken=self.taken,
        )


@dataclass(slots=True)
class Outlets:
    """The streams of one session.

    Attributes:
        lsl: The module `pylsl`.
        name: What the streams' names begin with.
        session: The session's code.
        about: What each stream's description says of it.
        stamp: From a time `t` to LSL's clock, in seconds.
    """

    lsl: Any
    name: str
    session: str
    about: dict[str, str]
    stamp: Callable[[int], float]
    streams: dict[str, SentStream] = field(default_factory=dict)

    def open(self, sensors: Sequence[str], units: dict[str, str]) -> None:
        """Make the streams that are wanted and not there, and drop those of other sensors."""
        wanted = {MARKERS: "", EVENTS: "", **{name: units.get(name, "") for name in sensors}}
        for key in [key for key in self.streams if key not in wanted]:
            del self.streams[key]
        for key, unit in wanted.items():
            if key not in self.streams:
                self.streams[key] = self._made(key, unit)

    def _made(self, key: str, unit: str) -> SentStream:
        lsl = self.lsl
        kind = _TYPES.get(key) or key.rpartition(".")[2].capitalize()
        form = lsl.cf_string if key in _TYPES else lsl.cf_double64
        source_id = f"woz-{self.session}-{key}"
        title = f"{self.name}-{key}"
        info = lsl.StreamInfo(title, kind, 1, lsl.IRREGULAR_RATE, form, source_id)
        described = info.desc()
        channel = described.append_child("channels").append_child("channel")
        channel.append_child_value("label", key)
        channel.append_child_value("type", kind)
        if unit:
            channel.append_child_value("unit", unit)
        maker = described.append_child("acquisition")
        maker.append_child_value("manufacturer", "woz-tui")
        maker.append_child_value("model", __version__)
        woz = described.append_child("woz")
        for name, value in self.about.items():
            woz.append_child_value(name, value)
        outlet = lsl.StreamOutlet(info)
        return SentStream(title, kind, outlet, source_id, outlet.get_info().uid())

    def push(self, key: str, value: str | float, t: int) -> None:
        """Send a value with its moment `t`; one of a stream that is not there is dropped."""
        stream = self.streams.get(key)
        if stream is not None:
            stream.outlet.push_sample([value], self.stamp(t))

    def push_reading(self, reading: m.Reading) -> None:
        """A sensor's value; one that is missing is NaN."""
        if reading.sensor in self.streams:
            value = math.nan if reading.value is None else reading.value
            self.push(reading.sensor, value, reading.t)

    def changed(self) -> Iterator[SentStream]:
        """Streams that somebody takes since the last call, or nobody any more."""
        for stream in self.streams.values():
            taken = bool(stream.outlet.have_consumers())
            if taken != stream.taken:
                stream.taken = taken
                yield stream
