"""Where something green is, from any program that writes raw pictures: rpicam-vid, ffmpeg ..."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Iterable, Mapping
from typing import Any

from woz_drivers.camera import doctor, frame_files
from woz_drivers.camera.blob import BlobFinder
from woz_drivers.camera.frame_files import FrameFiles
from woz_drivers.camera.picture_feed import PictureFeed
from woz_drivers.camera.settings import CameraSettings
from woz_drivers.programs.byte_stream import ByteStream, ChunkCutter, StreamCommand, StreamListener
from woz_tui.drivers.contract import (
    KEPT,
    DriverContext,
    DriverError,
    DriverFacts,
    Finding,
    Health,
    Job,
    Offer,
    PassiveDriver,
    Probe,
    RejectedError,
)
from woz_tui.motion.body_feeds import SEEN, Sighting
from woz_tui.protocol.messages import Json
from woz_tui.system.rate_limit import RateLimit

#: Published beside the feed: places from -1 to 1, null while nothing is seen; share of the picture.
SENSORS = ("seen.x", "seen.y", "seen.size")
#: Pictures of a film that wait for their moment; then its command has to wait as well.
_WAITING = 64
_CHECK = "try its command in a terminal; `woz doctor` shows its output"


class Camera(PassiveDriver):
    """One camera and one green thing.

    Every picture puts a `motion.body_feeds.Sighting` into the feed `seen`, also when nothing is
    seen; readings are for the log. While somebody watches, the pictures themselves go into the feed
    `picture`. The sensors are in the state ok while pictures come, else stale.
    """

    Settings = CameraSettings
    summary = "position of something green in a camera picture"
    facts = DriverFacts(
        needs="a program that writes pictures, such as ffmpeg",
        page="docs/how-to/camera.md",
    )
    settings: CameraSettings

    def __init__(self, name: str, settings: CameraSettings, context: DriverContext) -> None:
        super().__init__(name, settings, context)
        self._feed = context.feed(SEEN)
        self._offer = PictureFeed(settings, context)
        self._frames: FrameFiles | None = None
        if settings.frames is not None:
            self._frames = FrameFiles(name, settings, settings.frames, context)
        self._finder = BlobFinder(settings.rule)
        self._layout = settings.layout
        self._cutter = ChunkCutter(self._layout.size, self._came)
        self._frame = 0
        self._may_publish = RateLimit(1 / settings.publish)
        self._film: deque[bytes] = deque()
        self._projector: asyncio.TimerHandle | None = None
        self._due = 0.0
        self._source: ByteStream | None = None

    @classmethod
    def people_data(cls, settings: Any) -> Iterable[tuple[str, str]]:
        if settings.frames is None:
            yield KEPT, "no pictures of anybody"
        else:
            since = "from the beginning" if settings.frames.at_once else "once somebody starts it"
            yield KEPT, f"pictures, people on them, as files beside the log, {since}"

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        """Where the blob is, and how large; it saves its pictures where the file says so."""
        return Offer(
            verbs=(frame_files.VERB,) if settings.frames is not None else (),
            sensors=(*SENSORS, frame_files.FRAMES) if settings.frames is not None else SENSORS,
        )

    @classmethod
    async def examine(cls, probe: Probe) -> list[Finding]:
        """Look for two seconds; say how many pictures came and what is in them."""
        return await doctor.examine(probe)

    async def open(self) -> None:
        """Start the command, and again whenever it ends."""
        self.context.health(Health.CONNECTING, "starting the camera's command")
        listener = StreamListener(self._begun, self._received, self._stale, self._lost)
        command = StreamCommand(self.settings.words, self.context.folder, "nothing", _CHECK)
        self._source = ByteStream(command, self.context.clock, listener)
        self._source.start()
        if self._frames is not None:
            self._frames.open()

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Begin or end saving pictures."""
        if self._frames is None or job.verb != frame_files.VERB.name:
            raise RejectedError(f"{self.name} cannot {job.verb}")
        return self._frames.switch(on=bool(job.args["on"]))

    async def close(self) -> None:
        """End the command."""
        if self._source is not None:
            await self._source.close()
            self._source = None
        self._film.clear()
        if self._projector is not None:
            self._projector.cancel()
            self._projector = None
        if self._frames is not None:
            await self._frames.close()

    # -- the command ---------------------------------------------------------------------------

    def _begun(self) -> None:
        self._cutter = ChunkCutter(self._layout.size, self._came)

    def _received(self, data: bytes) -> None:
        self._cutter.feed(data)

    def _stale(self, why: str) -> None:
        for sensor in SENSORS:
            self.context.sensor(sensor, "stale", why)

    def _lost(self, trouble: DriverError) -> None:
        self.context.health(Health.LOST, trouble.what, trouble.remedy)
        self._stale(trouble.what)

    # -- films ---------------------------------------------------------------------------------

    def _came(self, data: bytes) -> None:
        if self.settings.pace == "as-fast":
            self._look_at(data)
            return
        self._film.append(data)
        if len(self._film) >= _WAITING and self._source is not None:
            self._source.hold(True)
        if self._projector is None:
            loop = asyncio.get_running_loop()
            self._due = max(self._due, loop.time())
            self._projector = loop.call_at(self._due, self._next)

    def _next(self) -> None:
        """A picture's moment has come."""
        self._projector = None
        self._look_at(self._film.popleft())
        self._due += 1 / self.settings.rate
        if self._film:
            self._projector = asyncio.get_running_loop().call_at(self._due, self._next)
        if self._source is not None:
            self._source.hold(len(self._film) >= _WAITING)

    # -- pictures ------------------------------------------------------------------------------

    def _look_at(self, data: bytes) -> None:
        settings = self.settings
        now_us = self.context.clock.now_us()
        picture = self._layout.decode(data)
        blob = self._finder.find(picture)
        self._frame += 1
        x = y = None
        size = 0.0
        if blob is not None:
            rows, columns = picture.shape[:2]
            x = _place(blob.x, columns, settings.mirror)
            y = _place(blob.y, rows, settings.flip)
            size = blob.size / (rows * columns)
        self._feed.put(Sighting(now_us, self._frame, x, y, size))
        self.context.health(Health.CONNECTED, f"{settings.words[0]}, {settings.shape}")
        for sensor in SENSORS:
            self.context.sensor(sensor, "ok")
        # `publish` times a second on average, as far as pictures come so often.
        if self._may_publish(now_us / 1_000_000):
            for sensor, value in zip(SENSORS, (x, y, size), strict=True):
                self.context.reading(sensor, value)
        self._offer.look_at(data)
        if self._frames is not None:
            self._frames.add(data, now_us)


def _place(middle: float, pixels: int, turned: bool) -> float:
    """A column or row as a place from -1 to 1 between the picture's edges."""
    place = (2 * middle + 1) / pixels - 1
    return -place if turned else place
