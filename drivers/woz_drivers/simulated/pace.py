"""How the simulated robot lets time pass; a test puts a hand-moved one in its place."""

from __future__ import annotations

import asyncio
import time


class RobotTime:
    """Real time: seconds of CLOCK_MONOTONIC, pauses of asyncio."""

    def now(self) -> float:
        """Seconds on a clock that never goes back; its zero is arbitrary."""
        return time.monotonic()

    async def sleep(self, seconds: float) -> None:
        """Pause for `seconds`; zero or less only lets other tasks run."""
        await asyncio.sleep(max(0.0, seconds))
