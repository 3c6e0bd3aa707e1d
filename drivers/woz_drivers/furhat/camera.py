"""A Furhat's camera: pictures while somebody watches, and single ones as files.

The robot sends JPEG. A single picture is kept as it came; to show one it has to be decoded, which
takes the package pillow.
"""

from __future__ import annotations

import asyncio
import base64
import binascii
import io
from collections.abc import Mapping
from typing import Any

from woz_drivers.furhat.link import FurhatLink, FurhatPart
from woz_drivers.furhat.realtime_events import CameraData
from woz_drivers.furhat.settings import FurhatSettings
from woz_drivers.pictures.live_pictures import LivePictures, kept_picture
from woz_tui.drivers.contract import DriverContext, DriverError, Job, Offer, Verb
from woz_tui.protocol.camera_pictures import CameraWatched
from woz_tui.protocol.messages import Json
from woz_tui.system.extras import install_command

_NO_DECODER = DriverError(
    "the package pillow is missing, which decodes them",
    install_command("furhat"),
)


class FurhatCamera(FurhatPart):
    """Asks for each picture after the one before was shown."""

    def __init__(self, link: FurhatLink, settings: FurhatSettings, context: DriverContext) -> None:
        super().__init__(link, settings, context)
        self._live = LivePictures(context)
        self._watching = self.background("the camera")

    @classmethod
    def offer(cls, settings: FurhatSettings) -> Offer:
        """It can keep a picture."""
        return Offer(
            verbs=(Verb("picture", "keep a picture of the robot's camera as a file", lane="watch"),)
        )

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Take a picture and keep it; returns `file` and `t` of the moment when it came."""
        jpeg = await self._take()
        t = self._context.t(self._context.clock.now_us())
        file = await kept_picture(self._context, self._settings.pictures, ".jpg", lambda: jpeg)
        return {"file": file, "t": t}

    async def connected(self) -> None:
        """Look whether somebody watches."""
        self._watching.start(self._live.serve(self._show))

    def lost(self) -> None:
        """No more pictures."""
        self._watching.cancel()

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

    async def _show(self, _: CameraWatched) -> None:
        self._live.offer(*await asyncio.to_thread(decoded, await self._take()))


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
