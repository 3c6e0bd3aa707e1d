"""Sends cameras' pictures to the consoles that ask for them; pictures are never in the log.

A console asks again when it has shown the last one. So the slowest of camera, socket and the line
to the terminal decides how many there are, and nothing ever piles up.
"""

from __future__ import annotations

import asyncio
import logging

from msgspec.structs import replace

from woz_tui.host.client_connection import ClientConnection
from woz_tui.protocol.camera_pictures import (
    MOST_PIXELS,
    MOST_RATE,
    PICTURE,
    WATCHED,
    CameraWatched,
    Picture,
    PictureShown,
)
from woz_tui.protocol.requests import AskPicture
from woz_tui.protocol.sentence import Sentence
from woz_tui.session.session import Session

#: How long a new picture is waited for, and how often it is looked for, in seconds.
WAIT_S, LOOK_S = 1.0, 0.02
#: A camera is told that it is watched for so much longer than the longest wait, in seconds.
WATCHED_S = 2.5

log = logging.getLogger(__name__)


class PictureService:
    """Answers `AskPicture` for one session."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._asking: dict[ClientConnection, asyncio.Task[None]] = {}
        self._watching: dict[tuple[str, str], CameraWatched] = {}
        self._one = asyncio.Lock()  # scaling takes a core: one picture after the other

    @property
    def cameras(self) -> list[str]:
        """The drivers that have one, in the order of the experiment."""
        named = self._session.feeds.drivers(PICTURE)
        return [driver for driver in self._session.drivers if driver in named]

    def answer(self, client: ClientConnection, request: AskPicture) -> None:
        """Answer with a picture, at once or within a second; or refuse."""
        reason, hint = self._refusal(client, request)
        if reason:
            client.refuse(request.ref, reason, hint)
            return
        driver = request.driver or self.cameras[0]
        self._watch(client, driver, request)
        task = asyncio.get_running_loop().create_task(self._send_picture(client, driver, request))
        self._asking[client] = task
        task.add_done_callback(lambda done: self._asking.pop(client, None))

    def _refusal(self, client: ClientConnection, request: AskPicture) -> tuple[str, str]:
        """Why it gets no picture, and what helps; empty: it gets one."""
        reason = hint = ""
        if client in self._asking:
            reason = Sentence("host.picture_under_way", "the previous picture has not arrived yet")
        elif not (1 <= request.width <= MOST_PIXELS and 1 <= request.height <= MOST_PIXELS):
            reason = Sentence(
                "host.picture_size",
                "a picture can have 1 x 1 to {most_pixels} x {most_pixels} pixels",
                most_pixels=MOST_PIXELS,
            )
        elif not 0 < request.rate <= MOST_RATE:
            reason = Sentence(
                "host.picture_rate",
                "the rate must be above 0 and at most {most_rate:g} pictures a second",
                most_rate=MOST_RATE,
            )
        elif request.driver and request.driver not in self._session.drivers:
            reason = Sentence(
                "bus.no_driver", "there is no driver {driver!r}", driver=request.driver
            )
        elif request.driver and request.driver not in self.cameras:
            reason = Sentence("host.no_camera", "{driver} has no camera", driver=request.driver)
            hint = (
                Sentence(
                    "host.drivers_with_camera",
                    "drivers with a camera: {names}",
                    names=", ".join(self.cameras),
                )
                if self.cameras
                else ""
            )
        elif not self.cameras:
            reason = Sentence("host.no_camera_here", "no driver of this session has a camera")
            hint = Sentence(
                "host.add_camera",
                "add one to the robot file: `eye: {{type: camera}}` (docs/how-to/camera.md)",
            )
        return reason, hint

    def _watch(self, client: ClientConnection, driver: str, request: AskPicture) -> None:
        """Tell the camera that somebody watches, with the wishes of all who do."""
        now = self._session.clock.now_us()
        mine = CameraWatched(now + round(WATCHED_S * 1_000_000), request.width, request.rate)
        self._watching[driver, client.name] = mine
        self._watching = {who: one for who, one in self._watching.items() if one.until_us > now}
        all_of = [one for (of, _), one in self._watching.items() if of == driver]
        together = CameraWatched(
            mine.until_us, max(one.width for one in all_of), max(one.rate for one in all_of)
        )
        self._session.feeds.feed(driver, WATCHED).put(together)

    async def _send_picture(
        self, client: ClientConnection, driver: str, request: AskPicture
    ) -> None:
        shown = PictureShown(ref=request.ref, driver=driver, cameras=self.cameras)
        try:
            client.send(await self._reply(shown, request))
        except Exception as error:
            # Whoever asked waits for an answer, also when a driver's picture is none.
            if not isinstance(error, ValueError):
                log.exception("a picture of %s could not be drawn", driver)
            client.refuse(
                request.ref,
                Sentence(
                    "host.picture_failed",
                    "a picture of {driver} could not be drawn: {error}",
                    driver=driver,
                    error=error,
                ),
            )

    async def _reply(self, shown: PictureShown, request: AskPicture) -> PictureShown:
        found = await self._next_picture(shown.driver, request.after)
        if found is None:
            why = Sentence(
                "host.no_new_picture",
                "{driver} sent no new picture within {wait_s:g} s",
                driver=shown.driver,
                wait_s=WAIT_S,
            )
            return replace(shown, why=why)
        number, picture = found
        async with self._one:
            # With it comes numpy: neither may hold up the robot.
            width, height, data = await asyncio.to_thread(_drawn, picture, request)
        return replace(
            shown,
            number=number,
            t=self._session.hub.t(picture.t_us),
            width=width,
            height=height,
            camera_width=picture.width,
            camera_height=picture.height,
            format=request.format,
            data=data,
        )

    async def _next_picture(self, driver: str, after: int) -> tuple[int, Picture] | None:
        """The newest picture that is not number `after`, as soon as there is one."""
        feed = self._session.feeds.feed(driver, PICTURE)
        loop = asyncio.get_running_loop()
        until = loop.time() + WAIT_S
        while True:
            latest = feed.latest()
            if latest.serial not in (0, after) and isinstance(latest.value, Picture):
                return latest.serial, latest.value
            if loop.time() >= until:
                return None
            await asyncio.sleep(LOOK_S)


def _drawn(picture: Picture, request: AskPicture) -> tuple[int, int, str]:
    from woz_tui.host.picture_encoding import encoded  # noqa: PLC0415 - loads numpy

    return encoded(picture, request.width, request.height, request.format)
