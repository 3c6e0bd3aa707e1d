"""What `woz doctor` finds out about a face of lights, without changing its picture."""

from __future__ import annotations

import asyncio
import contextlib

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
from woz_drivers.lines.answer_times import BUSY_REMEDY, AnswerTimes, Now
from woz_drivers.lines.serial_line import SerialLine
from woz_tui.drivers.contract import DeviceLostError, Finding
from woz_tui.system.processor_time import ProcessorWaits
from woz_tui.system.tasks import end_tasks, wait_at_most

#: Boards that start anew when their port is opened need two seconds until they answer.
_PATIENCE_S = 3.0
_ANSWER_S = 0.5
_HELLOS = 20
#: A slower face lags visibly behind the body, in milliseconds.
_SLOW_MS = 50.0


async def examine(subject: str, settings: LedFaceSettings, now: Now | None = None) -> Finding:
    """Version, size and latency of the face, or what is wrong. Never raises."""
    face = _OpenFace(settings)
    try:
        await face.next_event()  # the port is open, or cannot be
        return await _examined(subject, settings, face, now)
    except DeviceLostError as error:
        return Finding("error", subject, error.what, error.remedy)
    finally:
        await face.line.close()


class _OpenFace:
    """An open port and hellos over it."""

    def __init__(self, settings: LedFaceSettings) -> None:
        self.reader = PacketReader()
        self._events: asyncio.Queue[Packet | DeviceLostError | None] = asyncio.Queue()
        self._number = 0
        self.line = SerialLine(
            settings.port,
            settings.baud,
            on_open=lambda: self._events.put_nowait(None),
            on_bytes=self._received,
            on_trouble=self._events.put_nowait,
        )
        self.line.start()

    def _received(self, data: bytes) -> None:
        for packet in self.reader.feed(data):
            self._events.put_nowait(packet)

    async def next_event(self) -> Packet | None:
        """The next packet; None: the port was opened. Raises `DeviceLostError`."""
        event = await self._events.get()
        if isinstance(event, DeviceLostError):
            raise event
        return event

    async def hello(self) -> FaceDevice | None:
        """What the face says of itself; None: nothing."""
        self._number += 1
        self.line.write(b"\0" + Packet(HELLO, self._number, bytes((VERSION,))).encoded())
        answer = asyncio.ensure_future(self._answer(self._number))
        try:
            await wait_at_most([answer], _ANSWER_S)
            return answer.result() if answer.done() else None
        finally:
            await end_tasks(answer)

    async def _answer(self, number: int) -> FaceDevice:
        while True:
            packet = await self.next_event()
            if packet is not None and (packet.type, packet.number) == (HERE, number):
                with contextlib.suppress(DamagedPacketError):
                    return FaceDevice.of_payload(packet.payload)


async def _examined(
    subject: str, settings: LedFaceSettings, face: _OpenFace, now: Now | None
) -> Finding:
    where = f"{settings.port} at {settings.baud} baud"
    first = None
    for _ in range(round(_PATIENCE_S / _ANSWER_S)):
        first = await face.hello()
        if first is not None:
            break
    if first is None:
        heard = f", only {face.reader.damaged} damaged packets" if face.reader.damaged else ""
        return Finding(
            "error",
            subject,
            f"{where}: no face answers{heard}",
            "check the port and baud, and that drivers/firmware/led_face is on the board",
        )
    wrong = mismatch(first, settings.wired)
    if wrong:
        return Finding("error", subject, f"{where}: {wrong[0]}", wrong[1])
    missing = 0
    with contextlib.closing(ProcessorWaits()) as waits:
        times = AnswerTimes(now or waits.now)
        for _ in range(_HELLOS):
            with times.measured():
                missing += await face.hello() is None
    return _finding(subject, where, first, times, (missing, face.reader.damaged))


def _finding(
    subject: str, where: str, device: FaceDevice, times: AnswerTimes, lost: tuple[int, int]
) -> Finding:
    text = (
        f"{where}: {device.name}, {device.width} x {device.height}, protocol {device.version},"
        f" answers in {times.median_ms:.1f} ms"
    )
    busy = times.busy_clause(_SLOW_MS)
    text += busy
    missing, damaged = lost
    if missing or damaged:
        text += f"; {missing} of {_HELLOS} hellos unanswered, {damaged} packets damaged"
        return Finding("warning", subject, text, "check cable, ground and baud")
    if busy:
        return Finding("warning", subject, text, BUSY_REMEDY)
    if times.median_ms > _SLOW_MS:
        return Finding("warning", subject, text, "set a higher baud here and in board.h")
    return Finding("ok", subject, text)
