"""Fingers on the tablet as readings: `touch.x` and `touch.y`, 0 to 1 from the upper left corner.

ALTabletService tells where a finger comes down as a share of the screen and in pixels of its web
view, and where it moves and leaves in those pixels only. How many pixels there are depends on the
tablet's scale (1280 x 800, or 1707 x 1067), so it is learnt from fingers that come down.
"""

from __future__ import annotations

import asyncio
from typing import Any

from woz_drivers.pepper.memory import number
from woz_drivers.pepper.naoqi_link import Unsubscribe
from woz_drivers.pepper.parts import RobotCalls
from woz_tui.drivers.contract import DeviceLostError, DriverContext, DriverError

SENSORS = ("touch.x", "touch.y")
#: Moves are told at most so often, in seconds.
_STEP_S = 0.1
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
        if all(one is not None and 100 <= one <= 20_000 for one in size):
            self._size, self._learnt = (size[0] or 1.0, size[1] or 1.0), True

    def share(self, found: Place) -> Place:
        """Pixels as shares of the screen, 0 to 1."""
        self._in_pixels = self._in_pixels or max(found) > 1.0
        if not self._in_pixels:
            return _within(found)
        if not self._learnt and (found[0] > self._size[0] or found[1] > self._size[1]):
            self._size = _VIEW
        return _within((found[0] / self._size[0], found[1] / self._size[1]))


def _within(found: Place) -> Place:
    return min(1.0, max(0.0, found[0])), min(1.0, max(0.0, found[1]))


class Touch:
    """Listens to the tablet and tells where it is touched: down, move, up."""

    def __init__(self, robot: RobotCalls, context: DriverContext) -> None:
        self._robot = robot
        self._context = context
        self._scale = TouchScale()
        self._down: tuple[float, Place] | None = None
        self._down_pixels: tuple[float, Place] | None = None
        self._next_move = 0.0
        self._held: Place | None = None
        self._later: asyncio.TimerHandle | None = None
        self._held_signals: list[Unsubscribe] = []
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
        heard = shares or pixels or moves or ups
        self._state(*(("ok", "") if heard else ("stale", "the tablet does not tell touches")))

    def lost(self) -> None:
        """Nobody knows of any finger."""
        self._forget()
        self._held_signals = []
        self._state("stale", "the robot is not connected")

    async def close(self) -> None:
        """Listen no more."""
        self._forget()
        signals, self._held_signals = self._held_signals, []
        if self._robot.there:
            await asyncio.gather(*(end() for end in signals))

    async def _listen(self, signal: str, heard: Any) -> bool:
        try:
            end = await self._robot.listen("ALTabletService", signal, heard)
        except DeviceLostError:
            raise
        except DriverError:
            return False
        self._held_signals.append(end)
        return True

    def _forget(self) -> None:
        self._held = self._down = self._down_pixels = None
        if self._later is not None:
            self._later.cancel()
            self._later = None
        if self._calm is not None:
            self._calm.cancel()
            self._calm = None

    # -- fingers -------------------------------------------------------------------------------

    def _came_down(self, x: Any = None, y: Any = None, *_: Any) -> None:
        found = place(x, y)
        if found is None:
            return
        share = _within(found)
        self._down = (_now(), share)
        self._learn()
        self._tell(share, "down")

    def _compare(self, x: Any = None, y: Any = None, *_: Any) -> None:
        found = place(x, y)
        if found is not None:
            self._down_pixels = (_now(), found)
            self._learn()

    def _learn(self) -> None:
        """From a finger of which both is known."""
        if self._down is None or self._down_pixels is None:
            return
        if abs(self._down[0] - self._down_pixels[0]) <= _TOGETHER_S:
            self._scale.learn(self._down[1], self._down_pixels[1])
            self._down = self._down_pixels = None

    def _came_down_pixels(self, x: Any = None, y: Any = None, *_: Any) -> None:
        found = place(x, y)
        if found is not None:
            self._tell(self._scale.share(found), "down")

    def _moved(self, x: Any = None, y: Any = None, *_: Any) -> None:
        found = place(x, y)
        if found is None:
            return
        self._held = self._scale.share(found)
        if _now() >= self._next_move:
            self._tell_held()
        elif self._later is None:
            loop = asyncio.get_running_loop()
            self._later = loop.call_at(self._next_move, self._tell_held)

    def _left(self, x: Any = None, y: Any = None, *_: Any) -> None:
        self._tell_held()
        found = place(x, y)
        if found is not None:
            self._tell(self._scale.share(found), "up")

    def _tell_held(self) -> None:
        """The last move, whether its time has come or the finger leaves."""
        if self._later is not None:
            self._later.cancel()
            self._later = None
        held, self._held = self._held, None
        if held is not None:
            self._next_move = _now() + _STEP_S
            self._tell(held, "move")

    def _too_many(self) -> bool:
        """Whether a tablet tells more than anybody can touch: a log is not filled with that."""
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

    def _tell(self, where: Place, what: str) -> None:
        if self._too_many():
            return
        for sensor, value in zip(SENSORS, where, strict=True):
            self._context.reading(sensor, round(value, 4), text=what)


def _now() -> float:
    return asyncio.get_running_loop().time()
