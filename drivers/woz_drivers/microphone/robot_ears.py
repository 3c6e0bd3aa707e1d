"""The microphone of another driver of the same robot: its live sound, heard inside the session."""

from __future__ import annotations

import asyncio

import numpy as np

from woz_drivers.programs.byte_stream import StreamListener
from woz_tui.drivers.contract import DriverContext, DriverError, Health, HealthStatement
from woz_tui.drivers.feeds import HEALTH
from woz_tui.drivers.sound_feeds import (
    LISTENED,
    SOUND,
    WIDTH,
    SoundListened,
    SoundReader,
)
from woz_tui.system.tasks import end_tasks

#: How often is looked for new sound, and for how long the robot is asked for more, in seconds.
_LOOK_S, _LISTENS_S = 0.01, 2.5
#: Without sound for so long it is told of, and then given up for lost; at first a robot may have to
#: be connected before. In seconds.
_STALE_S, _LOST_S, _AT_FIRST_S = 1.0, 5.0, 20.0
#: Sound that was lost is made up for by silence, so that what comes keeps its time; up to so much.
_FILLED_S = 1.0
NO_SOUND = "is it connected, and does `woz listen --on {driver}` hear it?"


class RobotEars:
    """Fetches the sound of `driver` between `start` and `close`, as S16_LE of `rate`.

    It hears what `woz listen` would, and asks for it in the same way, but is no listener of the
    session: nobody hears anything by it.
    """

    def __init__(
        self, driver: str, rate: int, context: DriverContext, listener: StreamListener
    ) -> None:
        self._driver = driver
        self._rate = rate
        self._clock = context.clock
        self._listened = context.feed(LISTENED, of=driver)
        self._health = context.feed(HEALTH, of=driver)
        self._sound = context.feed(SOUND, of=driver)
        self._listener = listener
        self._task: asyncio.Task[None] | None = None
        self._started_us = self._came_us = 0
        #: Whether sound has come since it was there last.
        self.running = False

    @property
    def lasted_us(self) -> int:
        """How long it has come, in microseconds."""
        return self._came_us - self._started_us

    def start(self) -> None:
        """Begin to hear."""
        self._task = asyncio.create_task(self._hear(), name=f"sound of {self._driver}")

    def hold(self, held: bool) -> None:
        """It comes as fast as it is heard: there is nothing to hold."""

    async def close(self) -> None:
        """Hear no more."""
        await end_tasks(self._task)
        self._task = None

    async def _hear(self) -> None:
        reader = SoundReader(self._sound)
        told, patience_s = "", _AT_FIRST_S
        self._came_us = self._clock.now_us()
        while True:
            now_us = self._clock.now_us()
            self._want(now_us)
            taken = reader.take()
            silent_s = (now_us - self._came_us) / 1e6
            if taken is not None:
                piece, sound = taken
                if not self.running:
                    self._begin(now_us)
                told, patience_s, self._came_us = "", _LOST_S, now_us
                lost = min(piece.lost, round(_FILLED_S * sound.rate))
                self._listener.output(
                    at_rate(bytes(WIDTH * lost) + piece.pcm, sound.rate, self._rate)
                )
            elif (trouble := self._trouble(silent_s >= patience_s)) is not None:
                if trouble.what != told:
                    self.running, told = False, trouble.what
                    self._listener.ended(trouble)
            elif self.running and silent_s >= _STALE_S:
                self._listener.silent(f"{self._driver} sends no sound")
            await asyncio.sleep(_LOOK_S)

    def _begin(self, now_us: int) -> None:
        self.running, self._started_us = True, now_us
        self._listener.begun()

    def _trouble(self, waited: bool) -> DriverError | None:
        """Why no sound comes, if it is known or was `waited` for."""
        health = self._health.latest().value
        if isinstance(health, HealthStatement) and health.health in (Health.LOST, Health.FAULTED):
            return DriverError(f"{self._driver}: {health.detail}", health.remedy)
        if not waited:
            return None
        return DriverError(f"{self._driver} sends no sound", NO_SOUND.format(driver=self._driver))

    def _want(self, now_us: int) -> None:
        """Ask for sound, for no shorter than somebody else does."""
        wish = self._listened.latest().value
        until_us = now_us + round(_LISTENS_S * 1e6)
        if not isinstance(wish, SoundListened) or wish.until_us < until_us - 1_000_000:
            self._listened.put(SoundListened(until_us))


def at_rate(pcm: bytes, rate: int, wanted: int) -> bytes:
    """S16_LE, one channel, at another rate: good enough for speech."""
    if rate == wanted:
        return pcm
    samples = np.frombuffer(pcm, "<i2")
    count = round(samples.size * wanted / rate)
    places = np.arange(count) * (rate / wanted)
    data: bytes = np.interp(places, np.arange(samples.size), samples).astype("<i2").tobytes()
    return data
