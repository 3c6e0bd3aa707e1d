"""Distance sensors on a serial port: MaxBotix, TFmini and TF-Luna, A02 and JSN-SR04T, Arduino."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass
from typing import Annotated, Any

from woz_drivers.distance_filter import DistanceFilter, Gates
from woz_drivers.framings import FRAMINGS, UNITS, Decoder, Measurement
from woz_drivers.serial_line import LOSSES, SerialLine, Trouble, explain, open_port
from woz_tui.core.driver import Finding, Health, Outlet, PassiveDriver, Probe
from woz_tui.core.fields import Doc, OneOf, Port, Range, Seconds, Section

SENSOR = "distance"
RATE = "distance.rate"
BAD = "distance.bad"

#: How often staleness is looked at, and how often rate and bad frames are published, in seconds.
_LOOK_S = 0.1
_COUNT_US = 1_000_000
#: How long `woz doctor` listens, in seconds: the slowest sensors speak twice a second.
_LISTEN_S = 1.5


@dataclass(frozen=True, slots=True)
class RangefinderSettings(Section):
    """What a robot file may say about a rangefinder."""

    port: Annotated[
        str, Port(), Doc("serial port, best by its lasting name under /dev/serial/by-id/")
    ]
    framing: Annotated[
        str, OneOf(tuple(FRAMINGS)), Doc("how the sensor talks: its family, or lines of text")
    ] = "lines"
    unit: Annotated[
        str,
        OneOf(("auto", *UNITS)),
        Doc("unit of the sensor's numbers; auto: the framing's usual one. maxbotix needs it said"),
    ] = "auto"
    baud: Annotated[int, Range(0, 4_000_000), Doc("bits a second; 0: the framing's usual rate")] = 0
    nearest: Annotated[float, Range(0, 100, "m"), Doc("anything nearer is noise")] = 0.02
    farthest: Annotated[float, Range(0, 100, "m"), Doc("anything farther is noise")] = 10.0
    floor: Annotated[
        float | None,
        Range(0, 100, "m"),
        Doc("the sensor's smallest value: at or below it, this is the distance"),
    ] = None
    ceiling: Annotated[
        float | None,
        Range(0, 100, "m"),
        Doc("what the sensor says when nothing is in range: at or above it, this is the distance"),
    ] = None
    jump: Annotated[
        float, Range(0, 100, "m"), Doc("larger steps must be confirmed; 0: every step is taken")
    ] = 0.5
    confirm: Annotated[int, Range(1, 20), Doc("values in all that confirm a larger step")] = 3
    median: Annotated[int, Range(1, 25), Doc("values of which the median is taken")] = 3
    stale_after: Annotated[
        float, Seconds(0.1, 60), Doc("without a valid value for so long the distance is stale")
    ] = 1.0
    min_strength: Annotated[
        int, Range(0, 65535), Doc("tfmini: weaker echoes are no measurement")
    ] = 100

    def problems(self) -> list[tuple[str, str]]:
        """What is wrong between settings: pairs of a setting's name and a sentence."""
        found = []
        if self.framing == "maxbotix" and self.unit == "auto":
            found.append(
                (
                    "unit",
                    "MaxBotix sensors say inches (LV), cm (XL) or mm (HR) in the same form;"
                    " set in, cm or mm as its data sheet says",
                )
            )
        marks = (self.nearest, self.floor, self.ceiling, self.farthest)
        present = [mark for mark in marks if mark is not None]
        if present != sorted(present) or self.nearest == self.farthest:
            found.append(
                ("farthest", "nearest, floor, ceiling and farthest must grow in this order")
            )
        return found

    @property
    def real_unit(self) -> str:
        """`unit`, with auto resolved."""
        return FRAMINGS[self.framing].unit if self.unit == "auto" else self.unit

    @property
    def real_baud(self) -> int:
        """`baud`, with 0 resolved."""
        return self.baud or FRAMINGS[self.framing].baud

    def decoder(self) -> Decoder:
        """A fresh decoder, for one connection."""
        return FRAMINGS[self.framing].decoder(self.real_unit, self.min_strength)

    def filter(self) -> DistanceFilter:
        """A fresh filter, for one connection."""
        return DistanceFilter(
            Gates(
                nearest=self.nearest,
                farthest=self.farthest,
                floor=self.floor,
                ceiling=self.ceiling,
                jump=self.jump,
                confirm=self.confirm,
                median=self.median,
            )
        )


class Rangefinder(PassiveDriver):
    """One sensor on one port.

    Publishes `distance` in metres (`raw`: the device's own number of that frame) for every
    accepted value, and once a second `distance.rate` (accepted values a second) and
    `distance.bad` (frames thrown away since the port was opened: malformed, or out of range).
    """

    Settings = RangefinderSettings
    summary = "a distance sensor on a serial port"
    settings: RangefinderSettings

    def __init__(self, name: str, settings: RangefinderSettings, outlet: Outlet) -> None:
        super().__init__(name, settings, outlet)
        self._decoder = settings.decoder()
        self._filter = settings.filter()
        self._out_of_range = 0
        self._accepted = 0
        self._why = ""
        self._heard = b""
        self._valid_us = 0
        self._counted_us = 0
        self._line = SerialLine(
            settings.port,
            settings.real_baud,
            on_open=self._opened,
            on_bytes=self._received,
            on_trouble=self._troubled,
        )
        self._watch: asyncio.Task[None] | None = None

    @classmethod
    def sensors(cls, settings: Any) -> tuple[str, ...]:
        """The distance, and how well it comes in."""
        return (SENSOR, RATE, BAD)

    @classmethod
    async def examine(cls, probe: Probe) -> list[Finding]:
        """Open the port, listen for a moment, say what came."""
        settings: RangefinderSettings = probe.settings
        try:
            return [await _listen(probe.name, settings)]
        except (*LOSSES, ValueError) as error:
            trouble = explain(settings.port, settings.real_baud, error)
            return [Finding("error", probe.name, trouble.what, trouble.remedy)]

    async def open(self) -> None:
        """Begin to look for the port."""
        self.outlet.health(Health.CONNECTING, f"looking for {self.settings.port}")
        self._line.start()
        self._watch = asyncio.create_task(self._watch_for_silence())

    async def close(self) -> None:
        """Let go of the port."""
        if self._watch is not None:
            self._watch.cancel()
            await asyncio.gather(self._watch, return_exceptions=True)
        await self._line.close()

    # -- the port ------------------------------------------------------------------------------

    def _opened(self) -> None:
        self._decoder = self.settings.decoder()
        self._filter = self.settings.filter()
        self._out_of_range = 0
        self._accepted = 0
        self._why = ""
        self._heard = b""
        self._valid_us = self._counted_us = self.outlet.clock.now_us()
        settings = self.settings
        self.outlet.health(
            Health.CONNECTED, f"{settings.port}, {settings.framing}, {settings.real_baud} baud"
        )

    def _troubled(self, trouble: Trouble) -> None:
        self.outlet.health(Health.LOST, trouble.what, trouble.remedy)
        self.outlet.sensor(SENSOR, "stale", trouble.what)

    # -- values --------------------------------------------------------------------------------

    def _received(self, data: bytes) -> None:
        self._heard = (self._heard + data)[-16:]
        for measurement in self._decoder.feed(data):
            self._measured(measurement)

    def _measured(self, measurement: Measurement) -> None:
        if measurement.metres is None:
            self._why = measurement.why
            return
        verdict = self._filter.take(measurement.metres)
        if verdict.metres is None:
            if verdict.why == "range":
                self._out_of_range += 1
                self._why = f"{measurement.metres:.2f} m is out of range"
            else:
                self._why = "the distance jumps to and fro"
            return
        self._accepted += 1
        self._why = ""
        self._heard = b""
        self._valid_us = self.outlet.clock.now_us()
        self.outlet.sensor(SENSOR, "ok")
        self.outlet.reading(SENSOR, verdict.metres, unit="m", raw=measurement.raw)

    async def _watch_for_silence(self) -> None:
        while True:
            await asyncio.sleep(_LOOK_S)
            if not self._line.connected:
                continue
            now = self.outlet.clock.now_us()
            if now - self._counted_us >= _COUNT_US:
                self._count((now - self._counted_us) / 1_000_000)
                self._counted_us = now
            if now - self._valid_us >= self.settings.stale_after * 1_000_000:
                self.outlet.sensor(SENSOR, "stale", self._silence())

    def _count(self, seconds: float) -> None:
        self.outlet.reading(RATE, self._accepted / seconds, unit="Hz")
        self.outlet.reading(BAD, float(self._decoder.bad + self._out_of_range))
        self._accepted = 0

    def _silence(self) -> str:
        """Why there is no valid value."""
        settings = self.settings
        if not self._heard:
            return f"{settings.port} sends nothing; check the sensor's power and wiring"
        if self._why:
            return self._why
        if self._decoder.bad:
            return (
                f"what comes is not {settings.framing} at {settings.real_baud} baud:"
                f" {self._heard!r}; check framing and baud"
            )
        return "the sensor fell silent"


async def _listen(subject: str, settings: RangefinderSettings) -> Finding:
    """What the sensor says in `_LISTEN_S` seconds. Raises what `open_port` raises."""
    port = open_port(settings.port, settings.real_baud)
    decoder = settings.decoder()
    loop = asyncio.get_running_loop()
    lost: asyncio.Future[None] = loop.create_future()
    heard = bytearray()

    def read() -> None:
        try:
            heard.extend(port.read(4096))
        except LOSSES as error:
            loop.remove_reader(port.fileno())
            if not lost.done():
                lost.set_exception(error)

    loop.add_reader(port.fileno(), read)
    try:
        await asyncio.wait([lost], timeout=_LISTEN_S)
        if lost.done():
            lost.result()
    finally:
        loop.remove_reader(port.fileno())
        port.close()
    return _finding(subject, settings, bytes(heard), decoder.feed(bytes(heard)), decoder.bad)


def _finding(
    subject: str,
    settings: RangefinderSettings,
    heard: bytes,
    measurements: list[Measurement],
    bad: int,
) -> Finding:
    where = f"{settings.port}, {settings.framing}, {settings.real_baud} baud"
    if not heard:
        return Finding("error", subject, f"{where}: no data", "check the sensor's power and wiring")
    if not measurements:
        return Finding(
            "error",
            subject,
            f"{where}: no valid frame in {len(heard)} bytes, which begin with {heard[:16]!r}",
            "check framing and baud",
        )
    distances = [value.metres for value in measurements if value.metres is not None]
    rate = f"{len(measurements) / _LISTEN_S:.0f} Hz, {bad} bad frames"
    if not distances:
        return Finding(
            "warning", subject, f"{where}: {rate}, but {measurements[-1].why}", "point it at a wall"
        )
    level = "warning" if bad > len(measurements) / 10 else "ok"
    remedy = "check cable, ground and baud" if level == "warning" else ""
    return Finding(level, subject, f"{where}: {distances[-1]:.2f} m at {rate}", remedy)
