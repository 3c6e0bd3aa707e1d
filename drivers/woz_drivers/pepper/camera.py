"""The robot's camera: pictures while somebody watches, and single ones as files."""

from __future__ import annotations

import asyncio
import contextlib
import math
from collections.abc import Mapping
from datetime import datetime
from pathlib import Path

from woz_drivers.pepper import camera_files
from woz_drivers.pepper.camera_wire import RGB, VGA, Frame, frame, resolution
from woz_drivers.pepper.parts import Part, Robot
from woz_drivers.pepper.parts_calls import Endings
from woz_drivers.pepper.parts_task import Background, apart
from woz_drivers.pepper.settings import PepperSettings
from woz_tui.core.driver import DriverError, Job, Lost, Outlet, Rejected, Verb
from woz_tui.core.messages import Json
from woz_tui.core.pictures import PICTURE, WATCHED, Picture, Watched

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


class Camera(Part):
    """Asks for pictures only while `core.pictures.WATCHED` holds, each after the last has come."""

    name = "camera"

    def __init__(self, robot: Robot, settings: PepperSettings, outlet: Outlet) -> None:
        super().__init__(robot, settings, outlet)
        self._folder = settings.pictures
        self._pictures = outlet.feed(PICTURE)
        self._watched = outlet.feed(WATCHED)
        self._watching = Background("the camera", outlet)
        #: What the live pictures are subscribed under, and with which resolution and rate.
        self._subscribed: tuple[str, tuple[int, int]] | None = None
        #: When the last of them came, in the loop's time.
        self._came = 0.0
        self._trouble = ""
        self._endings = Endings()

    @classmethod
    def verbs(cls, settings: PepperSettings) -> tuple[Verb, ...]:
        """It can keep a picture."""
        return (Verb("picture", "keep a picture of the robot's camera as a file", lane="watch"),)

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Take a picture and keep it.

        Returns `file` (in the media folder: `<its name>/<file>`), `width`, `height` in pixels, `t`
        of the moment when it came, and `robot_time`, when the robot took it by its own clock, in
        seconds since 1970.
        """
        if job.verb != "picture":
            raise Rejected(f"the camera cannot {job.verb}")
        taken, t_us, moment = await self._take()
        picture = Picture(t_us, taken.width, taken.height, taken.rgb)
        folder = self._place()
        name = f"picture-{camera_files.stamp(moment)}"
        path = await apart(lambda: camera_files.keep(folder, name, picture))
        self._pictures.put(picture)
        return {
            "file": str(Path(self._folder or folder.name) / path.name),
            "width": taken.width,
            "height": taken.height,
            "t": self._outlet.t(t_us),
            "robot_time": taken.robot_s,
        }

    async def connected(self) -> None:
        """Forget what an earlier program left behind, and look whether somebody watches."""
        await self._watching.close()
        self._subscribed = None
        for left in (VIEW, SINGLE):
            with contextlib.suppress(DriverError):  # none was left, or it has no such method
                await self._robot.call("ALVideoDevice", "unsubscribeAllInstances", left)
        self._watching.start(self._watch())

    def lost(self) -> None:
        """No more pictures; who looks at the last one sees how old it is."""
        self._watching.cancel()
        self._subscribed = None

    async def close(self) -> None:
        """Let the camera go."""
        await self._watching.close()
        await self._unsubscribe()
        await self._endings.settled()
        await self._endings.close()

    # -- while somebody watches ----------------------------------------------------------------

    async def _watch(self) -> None:
        loop = asyncio.get_running_loop()
        while True:
            wish = self._wish()
            begun = loop.time()
            if wish is None:
                await self._unsubscribe()
                await asyncio.sleep(_LOOK_S)
                continue
            try:
                await self._show(wish)
            except DriverError as error:
                self._tell(error)
                await self._unsubscribe()
                await asyncio.sleep(_TROUBLED_S)
                continue
            await asyncio.sleep(max(0.0, begun + 1 / wish.rate - loop.time()))

    def _wish(self) -> Watched | None:
        """What is wanted now, by those who watch."""
        wish = self._watched.latest().value
        if not isinstance(wish, Watched) or wish.until_us <= self._outlet.clock.now_us():
            return None
        return wish if wish.rate > 0 and math.isfinite(wish.rate) else None

    async def _show(self, wish: Watched) -> None:
        size, rate = resolution(wish.width), max(1, min(math.ceil(wish.rate), _FASTEST))
        loop = asyncio.get_running_loop()
        if self._subscribed is None or self._subscribed[1] != (size, rate):
            await self._unsubscribe()
            self._subscribed = (await self._subscribe(VIEW, size, rate), (size, rate))
            self._came = loop.time()
        came = frame(await self._robot.call("ALVideoDevice", "getImageRemote", self._subscribed[0]))
        if isinstance(came, Frame):
            now_us = self._outlet.clock.now_us()
            self._pictures.put(Picture(now_us, came.width, came.height, came.rgb))
            self._came, self._trouble = loop.time(), ""
        elif loop.time() - self._came >= _PATIENCE_S:
            raise DriverError(came, _NO_PICTURE)

    def _tell(self, error: DriverError) -> None:
        """Say once why there are no pictures; that the robot is gone is told by others."""
        if not isinstance(error, Lost) and self._trouble != error.what:
            self._trouble = error.what
            self._outlet.notice("warning", f"no camera picture: {error.what}", error.remedy)

    async def _subscribe(self, name: str, size: int, rate: int) -> str:
        said = await self._robot.call("ALVideoDevice", "subscribe", name, size, RGB, rate)
        if not isinstance(said, str) or not said:
            raise DriverError(
                "the camera takes no one more", "restart the robot if nobody else looks through it"
            )
        return said

    async def _unsubscribe(self) -> None:
        held, self._subscribed = self._subscribed, None
        if held is not None and self._robot.there:
            with contextlib.suppress(DriverError):  # removed at the next connection
                await self._robot.call("ALVideoDevice", "unsubscribe", held[0], within=_FAREWELL_S)

    # -- a single one --------------------------------------------------------------------------

    async def _take(self) -> tuple[Frame, int, datetime]:
        """A picture of 640 x 480 with the moment it came, of the clock and of the day."""
        held = ""
        try:
            held = await self._subscribe(SINGLE, VGA, _SINGLE_RATE)
            came = await self._first(held)
        finally:
            words = ("unsubscribe", held) if held else ("unsubscribeAllInstances", SINGLE)
            self._endings.send(self._robot.call("ALVideoDevice", *words, within=_FAREWELL_S))
        return came, self._outlet.clock.now_us(), self._outlet.clock.wall()

    async def _first(self, held: str) -> Frame:
        loop = asyncio.get_running_loop()
        until = loop.time() + _PATIENCE_S
        while True:
            came = frame(await self._robot.call("ALVideoDevice", "getImageRemote", held))
            if isinstance(came, Frame):
                return came
            if loop.time() >= until:
                raise DriverError(came, _NO_PICTURE)
            await asyncio.sleep(_LOOK_S)

    def _place(self) -> Path:
        """Where pictures go now."""
        if not self._folder:
            return self._outlet.media
        return self._outlet.folder / Path(self._folder).expanduser()
