"""The simulated robot's time, and the activities in it, each of which can be ended."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Protocol


class SimulatorTime(Protocol):
    """Seconds of the robot. A test injects one that it moves by hand."""

    def now(self) -> float:
        """Seconds since an arbitrary zero, never going back."""
        ...

    async def sleep(self, seconds: float) -> None:
        """Return after so many seconds of the robot."""
        ...


class PacedTime:
    """Real time, `pace` times as fast."""

    def __init__(self, pace: float = 1.0) -> None:
        if pace <= 0:
            raise ValueError(f"time cannot pass {pace} times as fast; give a number above 0")
        self._pace = pace
        self._start = time.monotonic()

    def now(self) -> float:
        """Seconds of the robot since it was started."""
        return (time.monotonic() - self._start) * self._pace

    async def sleep(self, seconds: float) -> None:
        """Pause for so many seconds of the robot."""
        await asyncio.sleep(max(0.0, seconds) / self._pace)


@dataclass(eq=False, slots=True)
class Activity:
    """Something that is going on."""

    kind: str
    about: str
    begun: float
    seconds: float
    ended: asyncio.Future[None] = field(repr=False)


class Activities:
    """What is going on, by kind: speech, animation, move, joints, posture, sound, leds, video."""

    def __init__(self, time_: SimulatorTime) -> None:
        self._time = time_
        self._spans: list[Activity] = []

    async def last(self, kind: str, seconds: float, about: str = "") -> bool:
        """Let something go on; True when it came to its end, False when it was ended before."""
        ended: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        span = Activity(kind, about, self._time.now(), seconds, ended)
        self._spans.append(span)
        sleeper = asyncio.ensure_future(self._time.sleep(seconds))
        try:
            await asyncio.wait({sleeper, ended}, return_when=asyncio.FIRST_COMPLETED)
            return not ended.done()
        finally:
            sleeper.cancel()
            self._spans.remove(span)

    def end(self, *kinds: str, about: str | None = None) -> int:
        """End everything of these kinds (and about this); how many there were."""
        hit = [one for one in self.of(*kinds) if about is None or one.about == about]
        for one in hit:
            if not one.ended.done():
                one.ended.set_result(None)
        return len(hit)

    def of(self, *kinds: str) -> list[Activity]:
        """What of these kinds is going on, the oldest first."""
        return [one for one in self._spans if one.kind in kinds]

    def __iter__(self) -> Iterator[Activity]:
        return iter(tuple(self._spans))
