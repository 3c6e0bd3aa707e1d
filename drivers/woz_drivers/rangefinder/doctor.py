"""What `woz doctor` finds out about a rangefinder: whether what comes is what the settings say."""

from __future__ import annotations

import asyncio

from woz_drivers.rangefinder.settings import RangefinderSettings
from woz_drivers.rangefinder.wire import Measurement
from woz_drivers.serial_line import SerialLine
from woz_tui.drivers.contract import DeviceLostError, Finding, Probe
from woz_tui.system.tasks import end_tasks

#: How long `woz doctor` listens from the first byte on, in seconds: the slowest sensors speak twice
#: a second.
_LISTEN_S = 1.5
#: An Arduino starts anew when its port is opened, and says nothing for so long, in seconds.
_BEGINS_WITHIN_S = 4.0


async def examine(probe: Probe) -> Finding:
    """Open the port, listen for a moment, say what came."""
    settings: RangefinderSettings = probe.settings
    heard = bytearray()
    begun = asyncio.Event()

    def came(data: bytes) -> None:
        heard.extend(data)
        begun.set()

    lost: asyncio.Queue[DeviceLostError] = asyncio.Queue()
    line = SerialLine(
        settings.port,
        settings.real_baud,
        on_open=heard.clear,
        on_bytes=came,
        on_trouble=lost.put_nowait,
    )
    line.start()
    losing = asyncio.create_task(lost.get())
    beginning = asyncio.create_task(begun.wait())
    try:
        either = (losing, beginning)
        await asyncio.wait(either, timeout=_BEGINS_WITHIN_S, return_when=asyncio.FIRST_COMPLETED)
        if begun.is_set():
            await asyncio.wait([losing], timeout=_LISTEN_S)
        if losing.done():
            error = losing.result()
            return Finding("error", probe.name, error.what, error.remedy)
        decoder = settings.decoder()
        found = decoder.feed(bytes(heard))
        return _finding(probe.name, settings, bytes(heard), found, decoder.bad)
    finally:
        await end_tasks(losing, beginning)
        await line.close()


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
