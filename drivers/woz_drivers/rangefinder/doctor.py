"""What `woz doctor` finds out about a rangefinder: whether what comes is what the settings say."""

from __future__ import annotations

import asyncio

from woz_drivers.lines.serial_line import SerialLine
from woz_drivers.rangefinder.distance_reader import DistanceReader
from woz_drivers.rangefinder.settings import RangefinderSettings
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
        return _finding(probe.name, settings, bytes(heard))
    finally:
        await end_tasks(losing, beginning)
        await line.close()


def _finding(subject: str, settings: RangefinderSettings, heard: bytes) -> Finding:
    where = f"{settings.port}, {settings.framing}, {settings.real_baud} baud"
    reader = DistanceReader(settings)
    distances = [metres for metres, _ in reader.feed(heard)]
    if not distances:
        what, remedy = reader.no_distance()
        return Finding("error", subject, f"{where}: no distance: {what}", remedy)
    rate = f"{len(distances) / _LISTEN_S:.0f} Hz"
    lost = f"{reader.malformed} bad frames, {reader.refused} values refused"
    text = f"{where}: {distances[-1]:.2f} m at {rate}, {lost}"
    if reader.malformed + reader.refused > len(distances) / 10:
        what, remedy = reader.main_trouble()
        return Finding("warning", subject, f"{text}; {what}", remedy)
    return Finding("ok", subject, text)
