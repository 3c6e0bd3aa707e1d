"""What `woz doctor` finds out about a rangefinder: whether what comes is what the settings say."""

from __future__ import annotations

import asyncio

from woz_drivers.rangefinder.settings import RangefinderSettings
from woz_drivers.rangefinder.wire import Measurement
from woz_drivers.serial_line import LOSSES, explain_port_error, open_port
from woz_tui.drivers.contract import Finding, Probe

#: How long `woz doctor` listens, in seconds: the slowest sensors speak twice a second.
_LISTEN_S = 1.5


async def examine(probe: Probe) -> Finding:
    """Open the port, listen for a moment, say what came."""
    settings: RangefinderSettings = probe.settings
    try:
        return await _listen(probe.name, settings)
    except (*LOSSES, ValueError) as error:
        trouble = explain_port_error(settings.port, settings.real_baud, error)
        return Finding("error", probe.name, trouble.what, trouble.remedy)


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
