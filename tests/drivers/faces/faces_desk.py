"""A driver of faces behind real programs: a pipe as the camera, a stand-in that finds faces."""

from __future__ import annotations

import asyncio
import sys
from pathlib import Path
from typing import Any

from woz_drivers.faces import Faces
from woz_drivers.faces.settings import FacesSettings

from tests.drivers.heard import Heard, Ordered, until
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


class FacesDesk:
    """A driver with a camera that shows what the test wants; ten pictures a second."""

    def __init__(self, folder: Path, **settings: Any) -> None:
        self.clock = ManualClock()
        self.heard = Heard(folder, self.clock)
        self.pipe = PipedCommand(folder / "pipe")
        made = FacesSettings(command=self.pipe.command, **{**SMALL, **settings})
        assert made.problems() == []
        self.driver = Faces("it", made, self.heard.context)

    @property
    def answers(self) -> int:
        return self.heard.context.feed(SEEN).latest().serial

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
        self.heard.context.feed(WATCHED).put(wish)

    async def film(self, *faces: bytes) -> Picture:
        """A picture, once somebody who watches can see it."""
        feed = self.heard.context.feed(PICTURE)
        before = feed.latest().serial
        self.pipe.send(picture(*faces))
        await until(lambda: feed.latest().serial > before)
        shown = feed.latest().value
        assert isinstance(shown, Picture)
        return shown

    def last(self, sensor: str) -> float | None:
        return self.heard.values(sensor)[-1]

    def of_faces(self, sensor: str) -> dict[str, float | None]:
        """The last value for each face."""
        return {
            one.text: one.value for one in self.heard.all(Reading) if one.sensor == f"{sensor}.face"
        }

    async def perform(self, verb: str, **args: Any) -> asyncio.Task[Any]:
        """Begin a command, as far as it goes by itself."""
        task = asyncio.create_task(self.driver.perform(Ordered(verb, args)))
        await asyncio.sleep(0)
        return task
