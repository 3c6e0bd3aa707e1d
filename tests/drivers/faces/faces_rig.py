"""A driver of faces behind real programs: a pipe as the camera, a stand-in that finds faces."""

from __future__ import annotations

import asyncio
import sys
from pathlib import Path
from typing import Any

from woz_drivers.faces import Faces
from woz_drivers.faces.settings import FacesSettings

from tests.drivers.published_messages import BusJob, PublishedMessages, until
from tests.fakes import face_program
from tests.fakes.piped_command import PipedCommand
from woz_tui.motion.body_feeds import SEEN
from woz_tui.protocol.camera_pictures import PICTURE, WATCHED, CameraWatched, Picture
from woz_tui.protocol.messages import Reading
from woz_tui.system.clock import ManualClock

WIDTH, HEIGHT = 64, 48
SIZE = 3 * WIDTH * HEIGHT
PROGRAM = (sys.executable, "-S", face_program.__file__, str(SIZE))
SMALL: dict[str, Any] = {"width": WIDTH, "height": HEIGHT, "format": "rgb24", "program": PROGRAM}


def picture(*faces: bytes, order: int | None = None) -> bytes:
    head = b"" if order is None else bytes((order,))
    return (head + b"".join(faces)).ljust(SIZE, b"\0")


class FacesRig:
    """A driver with a camera that shows what the test wants; ten pictures a second."""

    def __init__(self, folder: Path, **settings: Any) -> None:
        self.clock = ManualClock()
        self.published = PublishedMessages(folder, self.clock)
        self.pipe = PipedCommand(folder / "pipe")
        faces_settings = FacesSettings(command=self.pipe.command, **{**SMALL, **settings})
        assert faces_settings.problems() == []
        self.driver = Faces("it", faces_settings, self.published.context)

    @property
    def answers(self) -> int:
        return self.published.context.feed(SEEN).latest().serial

    async def show(self, *faces: bytes, times: int = 1) -> None:
        """Pictures with these faces, each until it has been looked at."""
        for _ in range(times):
            before = self.answers
            self.pipe.send(picture(*faces))
            await until(lambda before=before: self.answers > before)  # type: ignore[misc]
            self.clock.advance(0.1)

    def watch(self) -> None:
        """Somebody has the camera's screen open for a minute."""
        wish = CameraWatched(self.clock.now_us() + 60_000_000, WIDTH, 10.0)
        self.published.context.feed(WATCHED).put(wish)

    async def film(self, *faces: bytes) -> Picture:
        """A picture, once somebody who watches can see it."""
        feed = self.published.context.feed(PICTURE)
        before = feed.latest().serial
        self.pipe.send(picture(*faces))
        await until(lambda: feed.latest().serial > before)
        shown = feed.latest().value
        assert isinstance(shown, Picture)
        return shown

    def last(self, sensor: str) -> float | None:
        return self.published.values(sensor)[-1]

    def of_faces(self, sensor: str) -> dict[str, float | None]:
        """The last value for each face."""
        return {
            one.text: one.value
            for one in self.published.all(Reading)
            if one.sensor == f"{sensor}.face"
        }

    async def perform(self, verb: str, **args: Any) -> asyncio.Task[Any]:
        """Begin a command, as far as it goes by itself."""
        task = asyncio.create_task(self.driver.perform(BusJob(verb, args)))
        await asyncio.sleep(0)
        return task
