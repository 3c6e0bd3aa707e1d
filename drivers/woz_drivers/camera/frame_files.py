"""A camera's pictures as files beside the log, one for each: where the file asks for it, and while
it is switched on.

They are packed and written by a thread of their own. Pictures that come faster than it can write
are skipped and counted; nobody waits for a disk.
"""

from __future__ import annotations

import asyncio
import contextlib
import os
import queue
import threading
from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

import numpy as np

from woz_drivers.camera.picture_source import PictureSource
from woz_drivers.camera.settings import FrameSettings
from woz_drivers.pictures import picture_files
from woz_tui.drivers.contract import Argument, DriverContext, DriverError, Verb
from woz_tui.protocol.messages import Json

#: How many have been saved; its state: off, on, stale (a disk is full, or the most are saved).
FRAMES = "frames"
VERB = Verb(
    "save_frames",
    "save its pictures as files beside the log",
    (Argument("on", "flag", "begin or end", required=True),),
    lane="frames",
    brief=True,
    evidence="reported",
)
#: Pictures that may wait for the thread.
_WAITING = 8
#: After a trouble it is tried again so much later, in seconds.
_AGAIN_S = 5.0
#: How often their number is published, in seconds; how long the end waits for the last ones.
_PUBLISHED_S, _FINISHED_S = 1.0, 2.0
#: Quick is better than small: zlib's best level takes five times as long for a tenth.
_LEVEL = 1
_MEGABYTE = 1_000_000


@dataclass(slots=True)
class _Series:
    """What became of the pictures since it was switched on: `taken` are saved, or still wait."""

    taken: int = 0
    saved: int = 0
    skipped: int = 0


@dataclass(frozen=True, slots=True)
class _Frame:
    """A raw picture, and when it came."""

    data: bytes
    wall: datetime
    series: _Series


class FrameFiles:
    """Saves one camera's pictures; all but the thread's part belongs to the event loop."""

    def __init__(
        self, name: str, source: PictureSource, settings: FrameSettings, context: DriverContext
    ) -> None:
        self._name = name
        self._source = source
        self._settings = settings
        self._context = context
        self._on = False
        self._frames: queue.Queue[_Frame | None] = queue.Queue(_WAITING)
        self._thread: threading.Thread | None = None
        self._ending = False
        self._loop: asyncio.AbstractEventLoop | None = None
        self._series = _Series()
        #: Bytes since the session began.
        self._bytes = 0
        self._trouble = ""
        self._again_us = 0
        self._due_us = self._published_us = 0

    def open(self) -> None:
        """Begin, if the file says so."""
        self._loop = asyncio.get_running_loop()
        self._context.sensor(FRAMES, "off")
        if self._settings.at_once:
            self.switch(on=True)

    def switch(self, *, on: bool) -> dict[str, Json]:
        """Begin or end; at its end, what was saved where."""
        result: dict[str, Json] = {"folder": f"{self._context.media.name}/{self._folder.name}"}
        if on and not self._on:
            self._series = _Series()
            self._trouble, self._again_us = "", 0
        elif not on:
            result |= {"frames": self._series.taken, "skipped": self._series.skipped}
        self._on = on
        if not self._trouble or not on:
            why = f"{self._series.taken} pictures saved, {self._series.skipped} skipped"
            self._context.sensor(FRAMES, "on" if on else "off", "" if on else why)
        return result

    def add(self, data: bytes, now_us: int) -> None:
        """A raw picture came."""
        if not self._on or now_us < self._due_us:
            return
        if self._settings.most:
            self._due_us = now_us + round(1_000_000 / self._settings.most)
        series = self._series
        if self._trouble and now_us < self._again_us:
            series.skipped += 1
            return
        if self._thread is None:
            self._thread = threading.Thread(target=self._work, name="frames", daemon=True)
            self._thread.start()
        try:
            self._frames.put_nowait(_Frame(data, self._context.clock.wall(), series))
        except queue.Full:
            series.skipped += 1
        else:
            series.taken += 1

    async def close(self) -> None:
        """End it; what waits is still written, unless the disk hangs."""
        if self._on:
            self.switch(on=False)
        thread, self._thread = self._thread, None
        if thread is None:
            return
        self._ending = True
        with contextlib.suppress(queue.Full):  # then it looks after the next picture
            self._frames.put_nowait(None)
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(_FINISHED_S):
                while thread.is_alive():  # noqa: ASYNC110 - a thread sets no event of the loop
                    await asyncio.sleep(0.01)

    @property
    def _folder(self) -> Path:
        return self._context.media / f"frames-{self._name}"

    # -- in the thread -------------------------------------------------------------------------

    def _work(self) -> None:
        while not (self._ending and self._frames.empty()):
            frame = self._frames.get()
            if frame is None:
                return
            try:
                size = self._write(frame)
            except DriverError as error:
                self._tell(self._failed, frame.series, error)
            else:
                self._tell(self._written, frame.series, size)

    def _write(self, frame: _Frame) -> int:
        """Save it; its bytes. Raises `DriverError`."""
        source, folder = self._source, self._folder
        if self._bytes > self._settings.megabytes * _MEGABYTE:
            raise DriverError(
                f"{self._settings.megabytes} MB of pictures have been saved",
                "raise `frames.megabytes` for the next session",
            )
        self._check_room(folder)
        picture = source.layout.for_people(frame.data, source.width)
        turned = picture[:: -1 if source.flip else 1, :: -1 if source.mirror else 1]
        height, width = turned.shape[:2]
        rgb = np.ascontiguousarray(turned).tobytes()
        content = picture_files.png(width, height, rgb, _LEVEL)
        name = f"frame-{picture_files.stamp(frame.wall)}"
        picture_files.keep(folder, name, ".png", content, secure=False)
        return len(content)

    def _check_room(self, folder: Path) -> None:
        """The log needs the disk more. Raises `DriverError`."""
        try:
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            disk = os.statvfs(folder)
        except OSError as error:
            why = f"the pictures cannot be saved in {folder}: {error.strerror}"
            raise DriverError(why, "check the disk") from None
        free = disk.f_bavail * disk.f_frsize / _MEGABYTE
        if free < self._settings.leave_free:
            raise DriverError(
                f"only {free:.0f} MB of the disk are free",
                f"free some space: {self._settings.leave_free} MB are left to the log"
                " (`frames.leave_free`)",
            )

    def _tell(self, call: Callable[..., None], *args: object) -> None:
        assert self._loop is not None
        try:
            self._loop.call_soon_threadsafe(call, *args)
        except RuntimeError:
            return  # the session is over

    # -- what the thread tells -----------------------------------------------------------------

    def _written(self, series: _Series, size: int) -> None:
        series.saved += 1
        self._bytes += size
        if self._trouble:
            self._trouble = ""
            self._context.notice("info", f"{self._name}: pictures are saved again")
        if self._on:
            self._context.sensor(FRAMES, "on")
        if series is not self._series:
            return
        now = self._context.clock.now_us()
        if now - self._published_us >= _PUBLISHED_S * 1_000_000 or series.saved == 1:
            self._published_us = now
            self._context.reading(FRAMES, series.saved)

    def _failed(self, series: _Series, error: DriverError) -> None:
        series.taken -= 1
        series.skipped += 1
        self._again_us = self._context.clock.now_us() + round(_AGAIN_S * 1_000_000)
        if not self._trouble:
            text = f"pictures are not saved: {error.what}"
            self._context.notice("error", text, error.remedy)
        self._trouble = error.what
        if self._on:
            self._context.sensor(FRAMES, "stale", error.what)
