"""A child process that several drivers use."""

from __future__ import annotations

import asyncio
from abc import ABC, abstractmethod

from woz_tui.network.child_line import ChildLine


class SharedChild(ABC):
    """It runs from the first driver that joins to the last that leaves."""

    def __init__(self) -> None:
        self._line: ChildLine | None = None
        self._users = 0
        self._lock = asyncio.Lock()

    async def join(self, place: str) -> ChildLine:
        """The line to it, for one more driver, which is at `place`. Raises `LineError`."""
        async with self._lock:
            self._admit(place)
            if self._line is None:
                self._line = await self._opened()
            self._users += 1
            return self._line

    async def leave(self) -> None:
        """One driver less; with the last one it ends."""
        async with self._lock:
            self._users -= 1
            if self._users <= 0 and self._line is not None:
                line, self._line = self._line, None
                await line.close()

    @abstractmethod
    def _admit(self, place: str) -> None:
        """Whether a driver at `place` may use it. Raises `LineError`."""

    @abstractmethod
    async def _opened(self) -> ChildLine:
        """Its line, begun. Raises `LineError`."""
