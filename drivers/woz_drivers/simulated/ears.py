"""The simulated microphone learns the room: `listen_room`, rehearsed without one."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterator, Sequence

from woz_drivers import room
from woz_drivers.simulated.hearing import Hearing
from woz_drivers.simulated.publishing import Publisher
from woz_drivers.simulated.senses import SENSITIVITY, TICK, Sample
from woz_tui.core.driver import Lost, Outlet
from woz_tui.core.messages import Json

_SENSOR = "loudness"


class Listening:
    """The levels of so many seconds of the simulated world, tick by tick."""

    def __init__(self, seconds: float) -> None:
        self._wanted = max(1, round(seconds / TICK))
        self.levels: list[float] = []

    @property
    def seconds(self) -> float:
        """How long it takes at the most: it may begin just after a tick."""
        return (self._wanted + 1) * TICK

    def take(self, level: float) -> None:
        """The next tick."""
        if not self.done():
            self.levels.append(level)

    def done(self) -> bool:
        """Whether it has heard enough."""
        return len(self.levels) >= self._wanted


class Ears:
    """What the driver `name` makes of the loudness that it publishes."""

    def __init__(self, name: str, outlet: Outlet, publisher: Publisher, hearing: Hearing) -> None:
        self._name = name
        self._outlet = outlet
        self._publisher = publisher
        self._hearing = hearing
        self._listening: Listening | None = None

    def tell_threshold(self) -> None:
        """Publish what counts as speech now."""
        self._outlet.reading(room.THRESHOLD, self._hearing.threshold)

    def hear(self, samples: Sequence[Sample], now: float) -> None:
        """What the sensors say; a broken one teaches what it says, or nothing."""
        if self._listening is None or self._publisher.silent(_SENSOR, now):
            return
        for sample in samples:
            if sample.sensor == _SENSOR:
                level = self._publisher.broken(_SENSOR, sample.value, now)
                if level is not None and math.isfinite(level):
                    self._listening.take(level)

    @contextlib.contextmanager
    def lesson(self, seconds: float) -> Iterator[Listening]:
        """Listen from now on until the block ends."""
        self._listening = Listening(seconds)
        try:
            yield self._listening
        finally:
            self._listening = None

    def adopt(self, heard: Listening) -> dict[str, Json]:
        """The threshold that follows holds from now on. Raises `Lost` if not enough was heard."""
        if not heard.done():
            raise Lost(f"{self._name} delivers no sound", "its loudness is broken on purpose")
        keeping = "the next session begins with the usual one again"
        learnt = room.learn(heard.levels)
        lesson = room.Lesson(self._name, learnt, SENSITIVITY, TICK, keeping)
        told = lesson.tell(self._outlet, self._hearing.threshold)
        self._hearing.threshold = lesson.threshold
        return told
