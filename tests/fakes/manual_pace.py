"""Time for the simulated robot that passes only when a test says so."""

from __future__ import annotations

import asyncio
import heapq
import itertools
import math

from woz_drivers.simulated.driver import RobotTime

from woz_tui.system.clock import ManualClock

#: Turns of the event loop after which everything that can run has run.
TURNS = 12


class ManualPace(RobotTime):
    """`advance` wakes the sleepers in order, at their times, and lets each run until it waits."""

    def __init__(self, clock: ManualClock) -> None:
        self._clock = clock
        self._order = itertools.count()
        self._sleepers: list[tuple[float, int, asyncio.Future[None]]] = []

    def now(self) -> float:
        return self._clock.now_us() / 1e6

    async def sleep(self, seconds: float) -> None:
        future: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        due = self.now() + max(0.0, seconds)
        heapq.heappush(self._sleepers, (due, next(self._order), future))
        await future

    async def advance(self, seconds: float) -> None:
        await self.settle()
        end = self.now() + seconds
        while self._sleepers and self._sleepers[0][0] <= end + 1e-9:
            due, _, future = heapq.heappop(self._sleepers)
            self._clock.advance(max(0, math.ceil((due - self.now()) * 1e6 - 0.01)) / 1e6)
            if not future.done():
                future.set_result(None)
                await self.settle()
        self._clock.advance(max(0.0, end - self.now()))

    async def settle(self) -> None:
        for _ in range(TURNS):
            await asyncio.sleep(0)
