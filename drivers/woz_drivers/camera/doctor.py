"""What `woz doctor` finds out about a camera: its program, the size of its pictures, a look."""

from __future__ import annotations

import asyncio
import contextlib
import time
from collections.abc import Awaitable, Callable

from woz_drivers.camera.blob import BlobFinder
from woz_drivers.camera.picture_source import PictureSource
from woz_drivers.camera.settings import CameraSettings
from woz_drivers.lines.answer_times import BUSY_REMEDY, Now
from woz_drivers.programs import child_process
from woz_tui.drivers.contract import DriverError, Finding, Probe
from woz_tui.system.processor_time import ProcessorWaits

#: How long is looked once pictures come, and how long they may take to come, in seconds.
_LOOK_S = 2.0
_PATIENCE_S = 10.0
#: If so many times the rate (or one over it) arrive, pictures are probably of another size.
_ODD = 1.5
#: If this thread waited for a processor for so much of the time, that explains missing pictures.
_BUSY = 0.1


async def examine(probe: Probe, now: Now | None = None) -> list[Finding]:
    """What two seconds of pictures look like, or why there are none. Never raises."""

    async def describe(first: bytes) -> Finding:
        settings: CameraSettings = probe.settings
        text = f"{settings.words[0]}: {_shape(settings)}; {_describe_first(settings, first)}"
        return Finding("ok", probe.name, text)

    return [await examine_pictures(probe, describe, now)]


async def examine_pictures(
    probe: Probe, describe: Callable[[bytes], Awaitable[Finding]], now: Now | None = None
) -> Finding:
    """Look at a source for two seconds. If its pictures are right, the finding is what `describe`
    makes of the first one, else why there are none. Never raises.
    """
    settings: PictureSource = probe.settings
    try:
        taken = await _take_pictures(settings, settings.words, probe, now)
        trouble = _trouble(probe.name, settings, taken)
        return await describe(bytes(taken.first)) if trouble is None else trouble
    except DriverError as error:
        return Finding("error", probe.name, error.what, error.remedy)


class _Capture:
    """The first picture, and how much came in how long."""

    def __init__(self, size: int) -> None:
        self._size = size
        self.first = bytearray()
        self.total = 0
        self.came = asyncio.Event()
        self.seconds = 0.0
        #: For how long this thread waited for a processor meanwhile.
        self.waited_s = 0.0
        self.ended = False
        self._began = 0.0

    def add(self, data: bytes) -> None:
        if not self.total:
            self._began = time.monotonic()
            self.came.set()
        self.total += len(data)
        self.seconds = time.monotonic() - self._began
        if len(self.first) < self._size:
            self.first += data[: self._size - len(self.first)]


async def _take_pictures(
    settings: PictureSource, words: tuple[str, ...], probe: Probe, now: Now | None
) -> _Capture:
    taken = _Capture(settings.layout.size)
    running = await child_process.start(words, probe.folder, on_output=taken.add)
    try:
        status = await running.wait_or(taken.came, _PATIENCE_S)
        if taken.came.is_set():
            with contextlib.closing(ProcessorWaits()) as waits:
                now = now or waits.now
                _, before_s = now()
                status = await running.wait_or(asyncio.Event(), _LOOK_S)
                taken.waited_s = now()[1] - before_s
        taken.ended = status is not None
        if status is not None and not taken.total:
            raise DriverError(
                f"{words[0]} ended: {running.reason(status)}", "try the command in a terminal"
            )
    finally:
        await running.end()
    if not taken.total:
        raise DriverError(
            f"{words[0]} runs but delivered nothing within {_PATIENCE_S:g} s",
            "try the command in a terminal",
        )
    return taken


def _shape(settings: PictureSource) -> str:
    return f"{settings.shape}, {settings.layout.size} bytes each"


def _trouble(subject: str, settings: PictureSource, taken: _Capture) -> Finding | None:
    """What is odd about the pictures that came."""
    size = settings.layout.size
    program, shape = settings.words[0], _shape(settings)
    if len(taken.first) < size:
        return Finding(
            "error",
            subject,
            f"{program} delivered {taken.total} bytes, less than one picture ({shape})",
            "check width, height, format and stride",
        )
    if taken.ended and taken.total % size:
        return Finding(
            "warning",
            subject,
            f"{program} delivered {taken.total} bytes, which are no whole pictures ({shape})",
            "check width, height, format and stride",
        )
    rate = taken.total / size / max(taken.seconds, 1e-3)
    if rate < settings.rate / _ODD and taken.waited_s > _BUSY * taken.seconds:
        text = f"{program}: {rate:.1f} pictures a second ({shape}) instead of {settings.rate:g}"
        busy = f"this computer was too busy to take them for {taken.waited_s:.1f} s"
        return Finding("warning", subject, f"{text}; {busy}", BUSY_REMEDY)
    if not taken.ended and not settings.rate / _ODD <= rate <= settings.rate * _ODD:
        return Finding(
            "warning",
            subject,
            f"{program}: {rate:.1f} pictures a second ({shape}) instead of {settings.rate:g}",
            "its pictures probably have another size, format or rate",
        )
    return None


def _describe_first(settings: CameraSettings, first: bytes) -> str:
    picture = settings.layout.decode(first)
    blob = BlobFinder(settings.rule).find(picture)
    if blob is None:
        return "nothing in the first picture is green"
    share = blob.size / (picture.shape[0] * picture.shape[1])
    return f"green: {share:.1%} of the first picture"
