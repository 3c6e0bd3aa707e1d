"""Distance sensors on a serial port: MaxBotix, TFmini and TF-Luna, A02 and JSN-SR04T, Arduino."""

from __future__ import annotations

import asyncio
from typing import Any

from woz_drivers.lines.serial_line import SerialLine
from woz_drivers.rangefinder import doctor
from woz_drivers.rangefinder.distance_reader import DistanceReader
from woz_drivers.rangefinder.settings import RangefinderSettings
from woz_tui.drivers.contract import (
    DeviceLostError,
    DriverContext,
    DriverFacts,
    Finding,
    Health,
    Offer,
    PassiveDriver,
    Probe,
)
from woz_tui.system.tasks import end_tasks

SENSOR = "distance"
RATE = "distance.rate"
BAD = "distance.bad"

#: How often staleness is looked at, and how often rate and bad frames are published, in seconds.
_LOOK_S = 0.1
_COUNT_US = 1_000_000


class Rangefinder(PassiveDriver):
    """One sensor on one port.

    Publishes `distance` in metres (`raw`: the device's own number of that frame) for every
    accepted value, and once a second `distance.rate` (accepted values a second) and
    `distance.bad` (frames thrown away since the port was opened: malformed, or out of range).
    """

    Settings = RangefinderSettings
    summary = "a distance sensor on a serial port"
    facts = DriverFacts(
        needs="a sensor on a serial port",
        page="docs/how-to/hardware.md",
        shown=("loss", "return", "units"),
    )
    settings: RangefinderSettings

    def __init__(self, name: str, settings: RangefinderSettings, context: DriverContext) -> None:
        super().__init__(name, settings, context)
        self._reader = DistanceReader(settings)
        self._counted = 0
        self._valid_us = 0
        self._counted_us = 0
        self._line = SerialLine(
            settings.port,
            settings.real_baud,
            on_open=self._opened,
            on_bytes=self._received,
            on_trouble=self._lost,
        )
        self._watch: asyncio.Task[None] | None = None

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        """The distance, and how well it comes in."""
        return Offer(sensors=(SENSOR, RATE, BAD))

    @classmethod
    async def examine(cls, probe: Probe) -> list[Finding]:
        """Open the port, listen for a moment, say what came."""
        return [await doctor.examine(probe)]

    async def open(self) -> None:
        """Begin to look for the port."""
        self.context.health(Health.CONNECTING, f"looking for {self.settings.port}")
        self._line.start()
        self._watch = asyncio.create_task(self._watch_for_silence())

    async def close(self) -> None:
        """Let go of the port."""
        await end_tasks(self._watch)
        await self._line.close()

    # -- the port ------------------------------------------------------------------------------

    def _opened(self) -> None:
        self._reader = DistanceReader(self.settings)
        self._counted = 0
        self._valid_us = self._counted_us = self.context.clock.now_us()
        settings = self.settings
        self.context.health(
            Health.CONNECTED, f"{settings.port}, {settings.framing}, {settings.real_baud} baud"
        )

    def _lost(self, error: DeviceLostError) -> None:
        self.context.health(Health.LOST, error.what, error.remedy)
        self.context.sensor(SENSOR, "stale", error.what)

    # -- values --------------------------------------------------------------------------------

    def _received(self, data: bytes) -> None:
        for metres, raw in self._reader.feed(data):
            self._valid_us = self.context.clock.now_us()
            self.context.sensor(SENSOR, "ok")
            self.context.reading(SENSOR, metres, unit="m", raw=raw)

    async def _watch_for_silence(self) -> None:
        while True:
            await asyncio.sleep(_LOOK_S)
            if not self._line.connected:
                continue
            now = self.context.clock.now_us()
            if now - self._counted_us >= _COUNT_US:
                accepted, seconds = self._reader.accepted, (now - self._counted_us) / 1_000_000
                self.context.reading(RATE, (accepted - self._counted) / seconds, unit="Hz")
                self.context.reading(BAD, float(self._reader.bad))
                self._counted, self._counted_us = accepted, now
            if now - self._valid_us >= self.settings.stale_after * 1_000_000:
                self.context.sensor(SENSOR, "stale", "; ".join(self._reader.no_distance()))
