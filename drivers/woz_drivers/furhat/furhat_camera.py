"""A Furhat's camera: pictures while somebody watches, and single ones as files.

The robot sends JPEG. A single picture is kept as it came; to show one it has to be decoded, which
takes the package pillow.
"""

from __future__ import annotations

import asyncio
import base64
import binascii
import io
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from woz_drivers import picture_files
from woz_drivers.background import Background
from woz_drivers.furhat.furhat_link import FurhatLink
from woz_drivers.furhat.furhat_parts import FurhatPart
from woz_drivers.furhat.realtime_events import CameraData
from woz_drivers.furhat.settings import FurhatSettings
from woz_tui.drivers.contract import DriverContext, DriverError, Job, Verb
from woz_tui.protocol.camera_pictures import PICTURE, WATCHED, CameraWatched, Picture
from woz_tui.protocol.messages import Json

#: How often it is looked whether somebody watches, and the pause after a trouble, in seconds.
_LOOK_S, _TROUBLED_S = 0.1, 2.0
_NO_DECODER = DriverError(
    "the camera's pictures cannot be shown: the package pillow is missing",
    "pip install 'woz-tui[furhat]'",
)


class FurhatCamera(FurhatPart):
    """Asks for each picture after the one before was shown."""

    def __init__(self, link: FurhatLink, settings: FurhatSettings, context: DriverContext) -> None:
        super().__init__(link, settings, context)
        self._pictures = context.feed(PICTURE)
        self._watched = context.feed(WATCHED)
        self._watching = Background("the camera", context)
        self._trouble = ""

    @classmethod
    def verbs(cls, settings: FurhatSettings) -> tuple[Verb, ...]:
        """It can keep a picture."""
        return (Verb("picture", "keep a picture of the robot's camera as a file", lane="watch"),)

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Take a picture and keep it; returns `file` and `t` of the moment when it came."""
        jpeg = await self._take()
        t_us, moment = self._context.clock.now_us(), self._context.clock.wall()
        folder = self._place()
        name = f"picture-{picture_files.stamp(moment)}"
        path = await asyncio.to_thread(picture_files.keep, folder, name, ".jpg", jpeg)
        shown = Path(self._settings.pictures or folder.name) / path.name
        return {"file": str(shown), "t": self._context.t(t_us)}

    def _place(self) -> Path:
        """Where pictures go now."""
        if not self._settings.pictures:
            return self._context.media
        return self._context.folder / Path(self._settings.pictures).expanduser()

    async def connected(self) -> None:
        """Look whether somebody watches."""
        self._watching.start(self._watch())

    def lost(self) -> None:
        """No more pictures."""
        self._watching.cancel()

    async def close(self) -> None:
        """Ask for nothing more."""
        await self._watching.close()

    async def _take(self) -> bytes:
        """A JPEG picture. Raises `DriverError`."""
        data = await self._link.ask("request.camera.once", CameraData)
        try:
            jpeg = base64.b64decode(data.image, validate=True)
        except binascii.Error:
            jpeg = b""
        if not jpeg.startswith(b"\xff\xd8"):
            raise DriverError("the camera gives no picture", "look at the robot's web interface")
        return jpeg

    async def _watch(self) -> None:
        loop = asyncio.get_running_loop()
        while True:
            begun = loop.time()
            request = self._request()
            if request is None:
                await asyncio.sleep(_LOOK_S)
                continue
            try:
                jpeg = await self._take()
                t_us = self._context.clock.now_us()
                width, height, rgb = await asyncio.to_thread(decoded, jpeg)
                self._pictures.put(Picture(t_us, width, height, rgb))
                self._trouble = ""
            except DriverError as error:
                if error.what != self._trouble:
                    self._trouble = error.what
                    self._context.notice("warning", error.what, error.remedy)
                await asyncio.sleep(_TROUBLED_S)
                continue
            await asyncio.sleep(max(0.0, begun + 1 / request.rate - loop.time()))

    def _request(self) -> CameraWatched | None:
        """What is wanted now, by those who watch."""
        request = self._watched.latest().value
        if not isinstance(request, CameraWatched):
            return None
        over = request.until_us <= self._context.clock.now_us()
        return None if over or not (math.isfinite(request.rate) and request.rate > 0) else request


def decoded(jpeg: bytes) -> tuple[int, int, bytes]:
    """Width, height and pixels of three bytes; for a thread. Raises `DriverError`."""
    try:
        from PIL import Image  # noqa: PLC0415 - optional, and only who watches needs it
    except ImportError:
        raise _NO_DECODER from None
    try:
        with Image.open(io.BytesIO(jpeg), formats=("JPEG",)) as opened:
            picture: Any = opened.convert("RGB")
            return picture.width, picture.height, picture.tobytes()
    except (OSError, ValueError, Image.DecompressionBombError) as error:
        raise DriverError(f"the camera's picture is broken: {error}", "try again") from None
