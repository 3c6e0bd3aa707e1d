"""The driver `led-face`: shows a body's face on the lights, picture by picture as it is drawn."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable, Mapping
from typing import Any

from woz_drivers.led_face.conversation import FaceLink, LinkState
from woz_drivers.led_face.doctor import examine
from woz_drivers.led_face.settings import LedFaceSettings
from woz_drivers.lines.serial_line import SerialLine
from woz_tui.drivers.contract import (
    Argument,
    DeviceLostError,
    DriverContext,
    DriverFacts,
    Finding,
    Health,
    Job,
    Offer,
    PassiveDriver,
    Probe,
    RejectedError,
    Verb,
)
from woz_tui.drivers.fields import Range
from woz_tui.motion.body_feeds import FACE, FacePicture
from woz_tui.motion.body_shape import FaceShape
from woz_tui.motion.face_drawing import FaceState, draw
from woz_tui.motion.light_frames import LightFrame, blank
from woz_tui.protocol.messages import Json
from woz_tui.system.tasks import end_tasks

# -- light pictures --------------------------------------------------------------------------------
# Pictures as the matrix is mounted, and patterns for whoever mounts it.


def as_mounted(frame: LightFrame, settings: LedFaceSettings) -> LightFrame:
    """The frame that a matrix must show which is mounted like this, for `frame` to be seen."""
    grid = [[frame.lit(x, y) for x in range(frame.width)] for y in range(frame.height)]
    if settings.mirror:
        grid = [row[::-1] for row in grid]
    for _ in range(int(settings.rotate) // 90):  # a matrix turned clockwise shows it turned back
        grid = [list(row) for row in zip(*grid, strict=True)][::-1]
    return _frame(len(grid[0]), len(grid), lambda x, y: grid[y][x])


def sleeping_face(settings: LedFaceSettings) -> LightFrame:
    """A face with closed eyes."""
    shape = FaceShape(settings.width, settings.height)
    return draw(FaceState(emotion="sleepy", intensity=1.0), shape)


def _frame(width: int, height: int, lit: Callable[[int, int], bool]) -> LightFrame:
    rows = (sum(1 << (width - 1 - x) for x in range(width) if lit(x, y)) for y in range(height))
    return LightFrame(width, tuple(rows))


def _arrow(width: int, height: int) -> LightFrame:
    """An arrow that points up, and a square in the upper left corner: nothing else looks so."""
    middle, head = width // 2, min(width, height) // 2
    return _frame(
        width,
        height,
        lambda x, y: (x == middle and y > 0) or abs(x - middle) == y < head or (x < 2 and y < 2),
    )


#: Pattern -> its picture on a matrix of some width and height.
PATTERNS: Mapping[str, Callable[[int, int], LightFrame]] = {
    "all": lambda width, height: _frame(width, height, lambda x, y: True),
    "none": blank,
    "chessboard": lambda width, height: _frame(width, height, lambda x, y: (x + y) % 2 == 0),
    "rows": lambda width, height: _frame(width, height, lambda x, y: y % 2 == 0),
    "columns": lambda width, height: _frame(width, height, lambda x, y: x % 2 == 0),
    "border": lambda width, height: _frame(
        width, height, lambda x, y: x in (0, width - 1) or y in (0, height - 1)
    ),
    "arrow": _arrow,
}


# --------------------------------------------------------------------------------------------------

#: How the conversation stands, as the wizard sees it.
_HEALTH: Mapping[LinkState, Health] = {
    LinkState.ASKING: Health.CONNECTING,
    LinkState.SILENT: Health.LOST,
    LinkState.STRANGE: Health.FAULTED,
    LinkState.TALKING: Health.CONNECTED,
}
#: How long `close` waits for the last picture to be confirmed, in seconds.
_FAREWELL_S = 0.3

_PATTERN = Verb(
    "pattern",
    "show a test picture, for mounting the lights",
    (
        Argument("picture", "choice", "which one", default="arrow", choices=tuple(PATTERNS)),
        Argument("seconds", "seconds", "for so long", default=5.0, range=Range(0.1, 25, "s")),
    ),
    lane="face",
    evidence="reported",  # the face confirms each picture
)


class LedFace(PassiveDriver):
    """One matrix of lights on one port.

    A stop leaves the picture as it is, for a face moves nothing, and ends a test pattern.
    """

    Settings = LedFaceSettings
    summary = "a face of lights on a serial port (24 x 16 and other sizes)"
    facts = DriverFacts(
        needs="a microcontroller with the firmware of drivers/firmware",
        page="docs/how-to/hardware.md",
        shown=("loss", "return", "errors"),
    )
    settings: LedFaceSettings

    def __init__(self, name: str, settings: LedFaceSettings, context: DriverContext) -> None:
        super().__init__(name, settings, context)
        self._lit = context.feed(FACE, of=settings.follows) if settings.follows else None
        self._seen = 0
        self._wanted = FacePicture(blank(*settings.wired), 0.0)
        self._pattern: FacePicture | None = None
        #: Set when the face is lost: what is shown for a while ends.
        self._gone = asyncio.Event()
        self._task: asyncio.Task[None] | None = None
        self._line = SerialLine(
            settings.port,
            settings.baud,
            on_open=self._opened,
            on_bytes=self._received,
            on_trouble=self._lost,
        )
        self._link = FaceLink(
            settings.wired,
            self._send,
            self._show_state,
            # A little less than the pause, so that a tick that comes early is not in vain.
            interval_us=round(950_000 / settings.rate),
        )

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        """Test pictures; what the face shows otherwise is up to the body."""
        return Offer(verbs=(_PATTERN,))

    @classmethod
    async def examine(cls, probe: Probe) -> list[Finding]:
        """Open the port, say hello, measure how fast the face answers. Shows nothing."""
        return [await examine(probe.name, probe.settings)]

    async def open(self) -> None:
        """Begin to look for the port."""
        self.context.health(Health.CONNECTING, f"looking for {self.settings.port}")
        self._line.start()
        self._task = asyncio.create_task(self._keep_showing())

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Show a test picture for a while."""
        if job.verb != _PATTERN.name:
            raise RejectedError(f"{self.name} is a face of lights; it cannot {job.verb}")
        picture, seconds = job.args["picture"], job.args["seconds"]
        if not isinstance(seconds, int | float) or picture not in PATTERNS:
            raise RejectedError(f"there is no test picture {picture!r} of {seconds!r} seconds")
        self._need_face()
        job.expects(seconds)
        self._pattern = FacePicture(
            self._mounted(PATTERNS[str(picture)](self.settings.width, self.settings.height)),
            self.settings.brightness,
        )
        self._gone.clear()
        try:
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(self._gone.wait(), seconds)
        finally:
            self._pattern = None
        self._need_face()
        return {"picture": picture, "seconds": seconds}

    async def close(self) -> None:
        """Show what the settings say for afterwards, and let go of the port."""
        task, self._task = self._task, None
        if task is not None:
            await end_tasks(task)
            await self._say_goodbye()
        await self._line.close()

    # -- what shall be shown -------------------------------------------------------------------

    async def _keep_showing(self) -> None:
        pause = 1 / (2 * self.settings.rate)
        while True:
            self._read_feed()
            self._step(self._pattern or self._wanted)
            await asyncio.sleep(pause)

    def _step(self, wanted: FacePicture) -> None:
        if self._line.connected:
            self._link.step(wanted, self._now())

    def _read_feed(self) -> None:
        """Take the body's newest picture."""
        if self._lit is None:
            return
        latest = self._lit.latest()
        if latest.serial != self._seen and isinstance(latest.value, FacePicture):
            self._seen = latest.serial
            self._take_picture(latest.value)

    def _take_picture(self, lit: FacePicture) -> None:
        frame, settings = lit.frame, self.settings
        if (frame.width, frame.height) == (settings.width, settings.height):
            self._wanted = FacePicture(self._mounted(frame), lit.brightness * settings.brightness)
            return
        self._lit = None  # a body's face keeps its size, so this is said once
        self.context.notice(
            "error",
            f"the face of {settings.follows!r} is {frame.width} x {frame.height} lights,"
            f" and these are {settings.width} x {settings.height}: nothing is shown",
            "give both drivers the same width and height in the robot file",
        )

    def _mounted(self, frame: LightFrame) -> LightFrame:
        return as_mounted(frame, self.settings)

    async def _say_goodbye(self) -> None:
        """The last picture; a second try is not worth waiting for."""
        settings = self.settings
        if settings.afterwards == "last" or self._link.state is not LinkState.TALKING:
            return
        last = FacePicture(blank(*settings.wired), 0.0)
        if settings.afterwards == "asleep":
            last = FacePicture(self._mounted(sleeping_face(settings)), self._wanted.brightness)
        loop = asyncio.get_running_loop()
        end = loop.time() + _FAREWELL_S
        while self._link.shown != last and self._line.connected and loop.time() < end:
            self._step(last)
            await asyncio.sleep(0.01)

    # -- the port ------------------------------------------------------------------------------

    def _now(self) -> int:
        return self.context.clock.now_us()

    def _opened(self) -> None:
        self._link.begin(self._now())

    def _received(self, data: bytes) -> None:
        self._link.received(data, self._now())

    def _send(self, data: bytes) -> None:
        with contextlib.suppress(DeviceLostError):  # whoever noticed the loss has told it
            self._line.write(data)

    def _lost(self, error: DeviceLostError) -> None:
        self._gone.set()
        self.context.health(Health.LOST, error.what, error.remedy)

    def _show_state(self) -> None:
        talk = self._link
        if talk.state is not LinkState.TALKING:
            self._gone.set()
        self.context.health(
            _HEALTH[talk.state], f"{self.settings.port}: {talk.detail}", talk.remedy
        )

    def _need_face(self) -> None:
        if not self._line.connected:
            raise DeviceLostError(f"{self.settings.port} is not open", "see its state")
        if self._link.state is not LinkState.TALKING:
            raise DeviceLostError(self._link.detail, self._link.remedy)
