"""The robot's camera: pictures while somebody watches, and single ones as files."""

from __future__ import annotations

import asyncio
import contextlib
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from woz_drivers.naoqi_robot.link import RobotRefusedError, binary
from woz_drivers.naoqi_robot.memory import item, number, within
from woz_drivers.naoqi_robot.parts import NaoqiPart, RobotCalls
from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_drivers.pictures import picture_files
from woz_drivers.pictures.live_pictures import LivePictures, kept_picture
from woz_tui.drivers.contract import (
    DriverContext,
    DriverError,
    Job,
    Offer,
    Verb,
)
from woz_tui.protocol.camera_pictures import CameraWatched
from woz_tui.protocol.messages import Json

#: What ALVideoDevice knows us by; it adds a number of its own to each.
VIEW, SINGLE = "woz-tui-view", "woz-tui-picture"
#: How often it is looked whether somebody watches, and the pause after a trouble, in seconds.
_LOOK_S = 0.1
_TROUBLED_S = 2.0
#: The most pictures a second that the camera can be asked for.
_FASTEST = 30
#: What a single picture is asked for with.
_SINGLE_RATE = 10
#: A camera that was just begun has no picture for a while; so long one is waited for, in seconds.
_PATIENCE_S = 2.0
_FAREWELL_S = 0.5
_NO_PICTURE = "is the robot awake? else restart it"


class CameraPart(NaoqiPart):
    """Asks for pictures only while `camera_pictures.WATCHED` holds, each after the last came."""

    name = "camera"

    def __init__(self, robot: RobotCalls, settings: NaoqiSettings, context: DriverContext) -> None:
        super().__init__(robot, settings, context)
        self._folder = settings.pictures
        self._live = LivePictures(context)
        self._watching = self.background("the camera")
        #: What the live pictures are subscribed under, and with which resolution and rate.
        self._subscribed: tuple[str, tuple[int, int]] | None = None
        #: When the last of them came, in the loop's time.
        self._last_picture_s = 0.0

    @classmethod
    def offer(cls, settings: NaoqiSettings) -> Offer:
        """It can keep a picture."""
        return Offer(
            verbs=(Verb("picture", "keep a picture of the robot's camera as a file", lane="watch"),)
        )

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Take a picture and keep it.

        Returns `file` (in the media folder: `<its name>/<file>`), `width`, `height` in pixels, `t`
        of the moment when it came, and `robot_time`, when the robot took it by its own clock, in
        seconds since 1970.
        """
        taken = await self._capture()
        t = self._context.t(self._context.clock.now_us())
        self._live.offer(taken.width, taken.height, taken.rgb)

        def png() -> bytes:
            return picture_files.png(taken.width, taken.height, taken.rgb)

        file = await kept_picture(self._context, self._folder, ".png", png)
        return {
            "file": file,
            "width": taken.width,
            "height": taken.height,
            "t": t,
            "robot_time": taken.robot_s,
        }

    async def connected(self) -> None:
        """Forget what an earlier program left behind, and look whether somebody watches."""
        await self._watching.close()
        self._subscribed = None
        for left in (VIEW, SINGLE):
            with contextlib.suppress(DriverError):  # none was left, or it has no such method
                await self._link.call("ALVideoDevice", "unsubscribeAllInstances", left)
        self._watching.start(self._live.serve(self._show, self._unsubscribe))

    def lost(self) -> None:
        """No more pictures; who looks at the last one sees how old it is."""
        self._watching.cancel()
        self._subscribed = None

    async def close(self) -> None:
        """Let the camera go."""
        await super().close()
        await self._unsubscribe()

    # -- while somebody watches ----------------------------------------------------------------

    async def _show(self, request: CameraWatched) -> None:
        size, rate = resolution(request.width), max(1, min(math.ceil(request.rate), _FASTEST))
        loop = asyncio.get_running_loop()
        if self._subscribed is None or self._subscribed[1] != (size, rate):
            await self._unsubscribe()
            self._subscribed = (await self._subscribe(VIEW, size, rate), (size, rate))
            self._last_picture_s = loop.time()
        received = frame(
            await self._link.call("ALVideoDevice", "getImageRemote", self._subscribed[0])
        )
        if isinstance(received, CameraFrame):
            self._live.offer(received.width, received.height, received.rgb)
            self._last_picture_s = loop.time()
        elif loop.time() - self._last_picture_s >= _PATIENCE_S:
            raise DriverError(received, _NO_PICTURE)

    def _words(self, name: str, size: int, rate: int) -> tuple[Any, ...]:
        """How the camera is subscribed to."""
        return "subscribe", name, size, RGB, rate

    async def _subscribe(self, name: str, size: int, rate: int) -> str:
        answer = await self._link.call("ALVideoDevice", *self._words(name, size, rate))
        if not isinstance(answer, str) or not answer:
            raise DriverError(
                "the camera has too many subscribers",
                "restart the robot if no other program uses the camera",
            )
        return answer

    async def _unsubscribe(self) -> None:
        subscription, self._subscribed = self._subscribed, None
        if subscription is not None and self._link.ready:
            with contextlib.suppress(DriverError):  # removed at the next connection
                await self._link.call(
                    "ALVideoDevice", "unsubscribe", subscription[0], within=_FAREWELL_S
                )

    # -- a single one --------------------------------------------------------------------------

    async def _capture(self) -> CameraFrame:
        """A picture of 640 x 480."""
        subscription = ""
        try:
            subscription = await self._subscribe(SINGLE, VGA, _SINGLE_RATE)
            return await self._first(subscription)
        finally:
            words = (
                ("unsubscribe", subscription)
                if subscription
                else ("unsubscribeAllInstances", SINGLE)
            )
            self._clean_up.start(self._link.call("ALVideoDevice", *words, within=_FAREWELL_S))

    async def _first(self, subscription: str) -> CameraFrame:
        loop = asyncio.get_running_loop()
        until = loop.time() + _PATIENCE_S
        while True:
            received = frame(await self._link.call("ALVideoDevice", "getImageRemote", subscription))
            if isinstance(received, CameraFrame):
                return received
            if loop.time() >= until:
                raise DriverError(received, _NO_PICTURE)
            await asyncio.sleep(_LOOK_S)


# -- as ALVideoDevice gives them -------------------------------------------------------------------
# doc.aldebaran.com, "naoqi/vision/alvideodevice".

#: kRGBColorSpace and kBGRColorSpace: three bytes a pixel.
RGB, _BGR = 11, 13
#: Widths in pixels with ALVideoDevice's numbers for them: kQQQVGA, kQQVGA, kQVGA, kVGA, k4VGA.
RESOLUTIONS = ((80, 7), (160, 0), (320, 1), (640, 2), (1280, 3))
VGA = 2
#: No camera of a robot gives more pixels than this in one direction.
_LARGEST = 8192


def resolution(width: int) -> int:
    """The number of the smallest pictures that are at least `width` wide, or of the largest."""
    return next((code for wide, code in RESOLUTIONS if wide >= width), RESOLUTIONS[-1][1])


@dataclass(frozen=True, slots=True)
class CameraFrame:
    """`rgb` as in `camera_pictures`; `robot_s`: when the robot took it, by its own clock (Unix)."""

    width: int
    height: int
    rgb: bytes
    robot_s: float | None


def frame(answer: Any) -> CameraFrame | str:
    """A picture, or why it is none.

    `[width, height, layers, colour space, s, us, bytes, ...]`; None while the camera has none.
    """
    if answer is None or answer in ([], ()):
        return "the camera gives no picture"
    width, height = (within(item(answer, place), 1, _LARGEST) for place in (0, 1))
    if width is None or height is None:
        return "the camera's picture has no size"
    wide, high = int(width), int(height)
    space = item(answer, 3)
    if item(answer, 2) != 3 or space not in (RGB, _BGR):
        which = number(space)
        return (
            f"the camera's picture is of an unknown kind{'' if which is None else f' ({which:g})'}"
        )
    try:
        pixels = binary(item(answer, 6))
    except (RobotRefusedError, UnicodeEncodeError):
        return "the camera's picture holds no pixels"
    if len(pixels) != 3 * wide * high:
        return f"the camera's picture is broken: {len(pixels)} bytes for {wide} x {high}"
    return CameraFrame(
        wide, high, _red_first(pixels, space), _taken(item(answer, 4), item(answer, 5))
    )


def _red_first(pixels: bytes, space: int) -> bytes:
    if space == RGB:
        return pixels
    turned = bytearray(pixels)
    turned[0::3], turned[2::3] = pixels[2::3], pixels[0::3]
    return bytes(turned)


def _taken(seconds: Any, micros: Any) -> float | None:
    whole, part = number(seconds), within(micros, 0, 1_000_000)
    return None if whole is None or part is None else whole + part / 1_000_000
