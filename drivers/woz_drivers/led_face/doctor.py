"""What `woz doctor` finds out about a face of lights, without changing its picture."""

from __future__ import annotations

import asyncio
import os
import statistics

import serial

from woz_drivers.led_face.conversation import mismatch
from woz_drivers.led_face.settings import LedFaceSettings
from woz_drivers.led_face.wire import (
    HELLO,
    HERE,
    VERSION,
    DamagedPacketError,
    FaceDevice,
    Packet,
    PacketReader,
)
from woz_drivers.serial_line import LOSSES, explain_port_error, open_port
from woz_tui.drivers.contract import Finding

#: Boards that start anew when their port is opened need two seconds until they answer.
_PATIENCE_S = 3.0
_ANSWER_S = 0.5
_HELLOS = 20
#: A slower face lags visibly behind the body, in milliseconds.
_SLOW_MS = 50.0


async def examine(subject: str, settings: LedFaceSettings) -> Finding:
    """Version, size and latency of the face, or what is wrong. Never raises."""
    try:
        port = open_port(settings.port, settings.baud)
    except (*LOSSES, ValueError) as error:
        trouble = explain_port_error(settings.port, settings.baud, error)
        return Finding("error", subject, trouble.what, trouble.remedy)
    visit = _OpenFace(port)
    try:
        return await _asked(subject, settings, visit)
    except LOSSES as error:
        trouble = explain_port_error(settings.port, settings.baud, error)
        return Finding("error", subject, trouble.what, trouble.remedy)
    finally:
        visit.end()


class _OpenFace:
    """An open port and hellos over it."""

    def __init__(self, port: serial.Serial) -> None:
        self._port = port
        self._reader = PacketReader()
        self._heard = asyncio.Event()
        self._packets: list[Packet] = []
        self._number = 0
        self._lost: Exception | None = None
        asyncio.get_running_loop().add_reader(port.fileno(), self._read)

    @property
    def damaged(self) -> int:
        """Packets that came damaged."""
        return self._reader.damaged

    def end(self) -> None:
        """Let go of the port."""
        asyncio.get_running_loop().remove_reader(self._port.fileno())
        self._port.close()

    def _read(self) -> None:
        try:
            data = self._port.read(4096)
        except LOSSES as error:
            self._lost = error
            asyncio.get_running_loop().remove_reader(self._port.fileno())
            self._heard.set()
            return
        self._packets += self._reader.feed(data)
        self._heard.set()

    async def hello(self) -> tuple[FaceDevice, float] | None:
        """What the face says of itself and after how many seconds; None: nothing."""
        self._number += 1
        loop = asyncio.get_running_loop()
        begun = loop.time()
        hello = Packet(HELLO, self._number, bytes((VERSION,))).encoded()
        os.write(self._port.fileno(), b"\0" + hello)
        try:
            async with asyncio.timeout(_ANSWER_S):
                device = await self._answer()
        except TimeoutError:
            return None
        return device, loop.time() - begun

    async def _answer(self) -> FaceDevice:
        while True:
            if self._lost is not None:
                raise self._lost
            while self._packets:
                packet = self._packets.pop(0)
                if (packet.type, packet.number) == (HERE, self._number):
                    try:
                        return FaceDevice.of_payload(packet.payload)
                    except DamagedPacketError:
                        continue
            self._heard.clear()
            await self._heard.wait()


async def _asked(subject: str, settings: LedFaceSettings, visit: _OpenFace) -> Finding:
    where = f"{settings.port} at {settings.baud} baud"
    first = None
    for _ in range(round(_PATIENCE_S / _ANSWER_S)):
        first = await visit.hello()
        if first is not None:
            break
    if first is None:
        heard = f", only {visit.damaged} damaged packets" if visit.damaged else ""
        return Finding(
            "error",
            subject,
            f"{where}: no face answers{heard}",
            "check the port and baud, and that drivers/firmware/led_face is on the board",
        )
    device = first[0]
    wrong = mismatch(device, settings.wired)
    if wrong:
        return Finding("error", subject, f"{where}: {wrong[0]}", wrong[1])
    answers = [answer for _ in range(_HELLOS) if (answer := await visit.hello())]
    return _judged(subject, where, device, [seconds for _, seconds in answers], visit.damaged)


def _judged(
    subject: str, where: str, device: FaceDevice, latencies: list[float], damaged: int
) -> Finding:
    missing = _HELLOS - len(latencies)
    milliseconds = statistics.median(latencies) * 1000 if latencies else 0.0
    text = (
        f"{where}: {device.name}, {device.width} x {device.height}, protocol {device.version},"
        f" answers in {milliseconds:.1f} ms"
    )
    if missing or damaged:
        lost = f"; {missing} of {_HELLOS} hellos unanswered, {damaged} packets damaged"
        return Finding("warning", subject, text + lost, "check cable, ground and baud")
    if milliseconds > _SLOW_MS:
        return Finding("warning", subject, text, "set a higher baud here and in board.h")
    return Finding("ok", subject, text)
