"""The tablet at the robot's chest: pictures, videos and pages, a default for the time between."""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from woz_drivers.naoqi_robot.link import Unsubscribe
from woz_drivers.naoqi_robot.memory import number
from woz_drivers.naoqi_robot.parts import NaoqiPart, RobotCalls
from woz_drivers.naoqi_robot.served_files import is_address
from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_drivers.pepper.settings import PepperSettings
from woz_drivers.pepper.tablet_page import PageKind, found, kind, page
from woz_tui.drivers.contract import (
    Argument,
    DeviceLostError,
    DriverContext,
    DriverError,
    Job,
    Offer,
    RejectedError,
    Scope,
    Verb,
)
from woz_tui.drivers.robot_parts import Pending, RefusalAllowed
from woz_tui.drivers.robot_verbs import common_verb
from woz_tui.protocol.messages import Json

# -- touches ---------------------------------------------------------------------------------------
# Fingers on the tablet as readings: `touch.x` and `touch.y`, 0 to 1 from the upper left corner.
# ALTabletService sends where a finger comes down as a share of the screen and in pixels of its web
# view, and where it moves and leaves in those pixels only. How many pixels there are depends on the
# tablet's scale (1280 x 800, or 1707 x 1067), so it is learnt from fingers that come down.

_SERVICE = "ALTabletService"
SENSORS = ("touch.x", "touch.y")
#: Moves are told at most so often, in seconds.
_STEP_S = 0.1
#: Touches are events at most so often, in seconds: somebody may tap like a drummer.
_TOLD_S = 0.5
#: More touches and moves than this in a second are not made by fingers.
_MOST_A_SECOND = 200
#: A finger's share and its pixels belong together if they come within this, in seconds.
_TOGETHER_S = 0.2
#: The tablet's own pixels, and its web view's by default.
_PIXELS, _VIEW = (1280.0, 800.0), (1707.0, 1067.0)
#: Nearer to the edge than this share, pixels are too few to learn from.
_NEAR = 0.05

Place = tuple[float, float]


def place(x: Any, y: Any) -> Place | None:
    """Two numbers, or None."""
    across, down = number(x), number(y)
    return None if across is None or down is None else (across, down)


class TouchScale:
    """How many pixels the tablet counts."""

    def __init__(self) -> None:
        self._size = _PIXELS
        self._learnt = False
        #: Some versions give shares everywhere; pixels are known by one beyond 1.
        self._in_pixels = False

    def learn(self, share: Place, pixels: Place) -> None:
        """A finger came down at both."""
        size = [
            pixel / part if _NEAR <= part <= 1 else None
            for part, pixel in zip(share, pixels, strict=True)
        ]
        if all(value is not None and 100 <= value <= 20_000 for value in size):
            self._size, self._learnt = (size[0] or 1.0, size[1] or 1.0), True

    def share(self, point: Place) -> Place:
        """Pixels as shares of the screen, 0 to 1."""
        self._in_pixels = self._in_pixels or max(point) > 1.0
        if not self._in_pixels:
            return _within(point)
        if not self._learnt and (point[0] > self._size[0] or point[1] > self._size[1]):
            self._size = _VIEW
        return _within((point[0] / self._size[0], point[1] / self._size[1]))


def _within(point: Place) -> Place:
    return min(1.0, max(0.0, point[0])), min(1.0, max(0.0, point[1]))


def where(point: Place) -> str:
    """A place on the tablet in words: `upper left`, `middle`."""
    across = "left" if point[0] < 1 / 3 else "right" if point[0] > 2 / 3 else ""
    down = "upper" if point[1] < 1 / 3 else "lower" if point[1] > 2 / 3 else ""
    if not across and not down:
        return "middle"
    if not across:
        return f"{down} middle"
    return f"{down or 'middle'} {across}"


class Touch:
    """Publishes where the tablet is touched: down, move, up."""

    def __init__(self, robot: RobotCalls, context: DriverContext) -> None:
        self._link = robot
        self._context = context
        self._scale = TouchScale()
        self._down: tuple[float, Place] | None = None
        self._down_pixels: tuple[float, Place] | None = None
        self._next_move = self._next_told = 0.0
        self._last_move: Place | None = None
        self._later: asyncio.TimerHandle | None = None
        self._subscriptions: list[Unsubscribe] = []
        #: When the second began in which touches are counted, and how many there were.
        self._second, self._count = 0.0, 0
        self._calm: asyncio.TimerHandle | None = None

    async def connected(self) -> None:
        """Listen to a tablet anew; what it cannot tell is left out."""
        self._forget()
        self._scale = TouchScale()
        shares = await self._listen("onTouchDownRatio", self._came_down)
        down = self._came_down_pixels if not shares else self._compare
        pixels = await self._listen("onTouchDown", down)
        moves = await self._listen("onTouchMove", self._moved)
        ups = await self._listen("onTouchUp", self._left)
        any_signal = shares or pixels or moves or ups
        self._state(*(("ok", "") if any_signal else ("stale", "the tablet does not tell touches")))

    def lost(self) -> None:
        """Nobody knows of any finger."""
        self._forget()
        self._subscriptions = []
        self._state("stale", "the robot is not connected")

    async def close(self) -> None:
        """Listen no more."""
        self._forget()
        signals, self._subscriptions = self._subscriptions, []
        if self._link.ready:
            await asyncio.gather(*(end() for end in signals))

    async def _listen(self, signal: str, listener: Any) -> bool:
        with RefusalAllowed():
            self._subscriptions.append(await self._link.listen(_SERVICE, signal, listener))
            return True
        return False

    def _forget(self) -> None:
        self._last_move = self._down = self._down_pixels = None
        if self._later is not None:
            self._later.cancel()
            self._later = None
        if self._calm is not None:
            self._calm.cancel()
            self._calm = None

    # -- fingers -------------------------------------------------------------------------------

    def _came_down(self, x: Any = None, y: Any = None, *_: Any) -> None:
        point = place(x, y)
        if point is None:
            return
        share = _within(point)
        self._down = (_now(), share)
        self._learn()
        self._publish(share, "down")
        self._tell(share)

    def _compare(self, x: Any = None, y: Any = None, *_: Any) -> None:
        point = place(x, y)
        if point is not None:
            self._down_pixels = (_now(), point)
            self._learn()

    def _learn(self) -> None:
        """From a finger of which both is known."""
        if self._down is None or self._down_pixels is None:
            return
        if abs(self._down[0] - self._down_pixels[0]) <= _TOGETHER_S:
            self._scale.learn(self._down[1], self._down_pixels[1])
            self._down = self._down_pixels = None

    def _came_down_pixels(self, x: Any = None, y: Any = None, *_: Any) -> None:
        point = place(x, y)
        if point is not None:
            share = self._scale.share(point)
            self._publish(share, "down")
            self._tell(share)

    def _moved(self, x: Any = None, y: Any = None, *_: Any) -> None:
        point = place(x, y)
        if point is None:
            return
        self._last_move = self._scale.share(point)
        if _now() >= self._next_move:
            self._publish_move()
        elif self._later is None:
            loop = asyncio.get_running_loop()
            self._later = loop.call_at(self._next_move, self._publish_move)

    def _left(self, x: Any = None, y: Any = None, *_: Any) -> None:
        self._publish_move()
        point = place(x, y)
        if point is not None:
            self._publish(self._scale.share(point), "up")

    def _publish_move(self) -> None:
        """The last move, whether its time has come or the finger leaves."""
        if self._later is not None:
            self._later.cancel()
            self._later = None
        position, self._last_move = self._last_move, None
        if position is not None:
            self._next_move = _now() + _STEP_S
            self._publish(position, "move")

    def _tell(self, point: Place) -> None:
        """An event for whoever watches: two numbers among the sensors are easily missed."""
        if _now() >= self._next_told:
            self._next_told = _now() + _TOLD_S
            text = f"the tablet was touched at the {where(point)}"
            self._context.notice("info", text, tells=SENSORS)

    def _too_many(self) -> bool:
        """Whether more touches come than fingers can make: a log is not filled with those."""
        if _now() - self._second >= 1.0:
            self._second, self._count = _now(), 0
        self._count += 1
        if self._count == _MOST_A_SECOND + 1:
            self._state("stale", "more touches than fingers can make: some are left out")
            loop = asyncio.get_running_loop()
            self._calm = loop.call_at(self._second + 1.0, self._state, "ok", "")
        return self._count > _MOST_A_SECOND

    def _state(self, state: str, why: str) -> None:
        for sensor in SENSORS:
            self._context.sensor(sensor, state, why)

    def _publish(self, point: Place, what: str) -> None:
        if self._too_many():
            return
        for sensor, value in zip(SENSORS, point, strict=True):
            self._context.reading(sensor, round(value, 4), text=what)


def _now() -> float:
    return asyncio.get_running_loop().time()


# -- the tablet ------------------------------------------------------------------------------------

_FAREWELL_S = 0.5
_COMMANDS = ("wifi", "hide", "default", "stop")
#: The argument of `screen` that means the default.
_OFF = "off"

log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False, slots=True)
class _Video:
    """One that plays; two of the same file are two."""

    text: str


class TabletPart(NaoqiPart):
    """Verbs `screen` and `tablet`, the default picture, and touches as readings."""

    name = "tablet"

    def __init__(self, robot: RobotCalls, settings: PepperSettings, context: DriverContext) -> None:
        super().__init__(robot, settings, context)
        self._root = settings.tablet.root
        self._default = settings.tablet.default
        self._touch = Touch(robot, context) if settings.senses.touch else None
        self._turn = asyncio.Lock()
        self._video: _Video | None = None
        #: What is there, as the settings show it.
        self._shows = ""
        self._on_air = False
        self._watching = self.background("the tablet's video")
        self._returning = self.background("the tablet's default")
        self._signals: list[Unsubscribe] = []

    @classmethod
    def offer(cls, settings: NaoqiSettings) -> Offer:
        """What the tablet does, and where it is touched."""
        what = "picture, video or page: a file, or http://...; off: the default"
        command = Argument("what", "choice", "what it does", required=True, choices=_COMMANDS)
        return Offer(
            verbs=(
                common_verb(
                    "screen",
                    "show something on the tablet",
                    Argument("file", "text", what, required=True),
                ),
                Verb(
                    "tablet", "the tablet's wifi on; hide what it shows", (command,), lane="screen"
                ),
            ),
            sensors=SENSORS if settings.senses.touch else (),
        )

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Returns `shown`: what is on the tablet now. A video is not waited for."""
        async with self._turn:
            match job.verb, str(job.args.get("file", job.args.get("what", ""))):
                case "screen", text if text.strip() and text != _OFF:
                    await self._show(text)
                case ("screen", _) | ("tablet", "default"):
                    await self._show_default()
                case "tablet", "wifi":
                    await self._call("enableWifi")
                case "tablet", "hide":
                    await self._hide()
                case "tablet", "stop":
                    await self._end_video(sure=True)
                    await self._show_default()
                case verb, what:
                    raise RejectedError(f"the tablet cannot {verb} {what}")
        return {"shown": self._shows}

    async def halt(self, scope: Scope) -> Pending:
        """A video ends; the default comes afterwards, which is not waited for."""
        video = self._video
        if video is None:
            return None
        self._watching.cancel()
        # Not confirmed, it may play on: the next stop tries it again.
        await self._call("stopVideo", sure=False)
        self._over(video)
        return ()

    async def connected(self) -> None:
        """Listen to the tablet, and show the default, or clear it."""
        await self._watching.close()
        await self._returning.close()
        self._video, self._shows, self._on_air = None, "", False
        self._signals = []
        for signal, listener in (
            ("videoFinished", self._finished),
            ("onLoadPageError", self._not_loaded),
        ):
            with RefusalAllowed():  # an older tablet: the video's end is asked for as well
                self._signals.append(await self._link.listen(_SERVICE, signal, listener))
        if self._touch is not None:
            await self._touch.connected()
        try:
            async with self._turn:
                await self._show_default()  # without one: nothing of an earlier program stays
        except DeviceLostError:
            raise
        except DriverError as error:
            if self._default:
                self._context.notice("warning", f"tablet: {error.what}", error.remedy)

    def lost(self) -> None:
        """Nobody knows what it shows."""
        self._watching.cancel()
        self._returning.cancel()
        self._video, self._shows, self._signals = None, "", []
        if self._touch is not None:
            self._touch.lost()

    async def read(self) -> Mapping[str, Json]:
        """What it shows, as far as it was shown from here."""
        return {"tablet": self._shows or "its own"}

    async def close(self) -> None:
        """A video ends, for its file cannot be fetched any more; a picture stays."""
        await super().close()
        if self._touch is not None:
            await self._touch.close()
        if self._link.ready:
            with contextlib.suppress(DriverError):  # the session ends in any case
                if self._video is not None:
                    await self._link.call(_SERVICE, "stopVideo", within=_FAREWELL_S)
            await asyncio.gather(*(end() for end in self._signals))
        self._video, self._signals = None, []

    # -- showing -------------------------------------------------------------------------------

    async def _show(self, text: str) -> None:
        """Show a file or an address. Raises `DriverError`."""
        what = kind(text)
        address = text
        if not is_address(text):
            file = found(text, self._root, self._context.folder)
            address = await self._link.files.address(file)
        if what is PageKind.PICTURE:
            address = await self._link.files.page(page(address))
        await self._end_video()
        await self._network()
        self._shows = ""
        if what is PageKind.VIDEO:
            await self._play(text, address)
        else:
            await self._call("showWebview", address)
        self._shows = text

    async def _play(self, text: str, address: str) -> None:
        video = _Video(text)
        self._video = video
        try:
            await self._call("playVideo", address)
        except DeviceLostError:
            raise  # it may play even so, and be ended
        except DriverError:
            self._video = None
            raise
        if self._video is video:
            self._watching.start(self._watch(video))

    async def _show_default(self) -> None:
        """What is there when nothing else is; without a default the tablet's own screen."""
        if self._default:
            await self._show(self._default)
        else:
            await self._hide()

    async def _hide(self) -> None:
        await self._end_video()
        await self._call("hideWebview", sure=False)
        self._shows = ""

    async def _end_video(self, *, sure: bool = False) -> None:
        """For something else, which takes its place even where the tablet cannot end it; raises
        `DriverError` then if it must be `sure`.
        """
        video, self._video = self._video, None
        if video is None:
            return
        await self._watching.close()
        try:
            await self._call("stopVideo", sure=False)
        except DeviceLostError:
            raise
        except DriverError as error:
            if sure:
                raise
            log.info("the tablet does not end %s: %s", video.text, error.what)

    async def _network(self) -> None:
        """What is fetched needs the tablet's wifi, or another way: refused, it is tried."""
        if self._on_air:
            return
        try:
            await self._call("enableWifi", sure=False)
        except DriverError:
            if not self._link.ready:
                raise
        self._on_air = True

    async def _call(self, method: str, *words: Any, sure: bool = True) -> None:
        """Have the tablet do it. Raises `DriverError`; if `sure`, also when it says no."""
        answer = await self._link.call(_SERVICE, method, *words)
        if sure and answer is False:
            raise DriverError(
                f"the tablet refused {method}",
                "check that it is on; `tablet wifi` switches its network on",
            )

    # -- a video's end -------------------------------------------------------------------------

    async def _watch(self, video: _Video) -> None:
        try:
            if not await played(self._link):
                text = f"the tablet has not begun to play {video.text}"
                remedy = "check its format, and that the tablet is on the network"
                self._context.notice("warning", text, remedy, tells=("request",))
        except DeviceLostError:
            return
        self._over(video)

    def _finished(self, *_: Any) -> None:
        """Called when the video is over."""
        if self._video is not None:
            self._watching.cancel()
            self._over(self._video)

    def _over(self, video: _Video) -> None:
        if self._video is video:
            self._video, self._shows = None, ""
            if self._default:
                self._returning.start(self._come_back())

    async def _come_back(self) -> None:
        """The default again, unless something else has been shown meanwhile."""
        async with self._turn:
            if self._shows or self._video is not None:
                return
            try:
                await self._show_default()
            except DeviceLostError:
                return  # it is shown at the next connection
            except DriverError as error:
                self._context.notice("warning", f"tablet: {error.what}", error.remedy)

    def _not_loaded(self, *answer: Any) -> None:
        """The tablet could not fetch a page or what is on it."""
        words = [str(value) for value in answer if isinstance(value, str) and value]
        why = ": ".join(words[:2]) or "no reason given"
        remedy = "check the address, and that the tablet reaches it: `tablet wifi`, tablet.address"
        self._context.notice(
            "warning",
            f"the tablet could not load what it was to show: {why}",
            remedy,
            tells=("request",),
        )


# -- whether a video has ended ---------------------------------------------------------------------

#: How often it is asked, and how soon a video has to begin, in seconds.
_POLL_S = 1.0
_BEGINS_WITHIN_S = 20.0
#: So near to its end it has ended, in milliseconds.
_NEAR_MS = 300.0


async def played(robot: RobotCalls) -> bool:
    """Return when the video is over: True if it has played, False if it never began.

    A tablet that does not tell is never over here. Raises `DeviceLostError`.
    """
    loop = asyncio.get_running_loop()
    until = loop.time() + _BEGINS_WITHIN_S
    began = False
    while True:
        await asyncio.sleep(_POLL_S)
        position, length = await _video_ms(robot, "Position"), await _video_ms(robot, "Length")
        if position is None:
            await loop.create_future()  # the signal will tell
        elif position > 0:
            began = True
            if length is not None and length > 0 and position >= length - _NEAR_MS:
                return True
        elif began:
            return True
        elif loop.time() >= until:
            return False


async def _video_ms(robot: RobotCalls, what: str) -> float | None:
    """Milliseconds; None if the tablet does not tell."""
    with RefusalAllowed():
        return number(await robot.call(_SERVICE, f"getVideo{what}"))
    return None
