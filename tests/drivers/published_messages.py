"""What a driver tells its session, collected by the session's own hub and context."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

from woz_tui.bus.hub import Hub
from woz_tui.protocol.action_messages import Evidence
from woz_tui.protocol.messages import Json, Message, Reading, SensorChanged
from woz_tui.session.driver_context import SessionDriverContext
from woz_tui.system.clock import Clock, RealClock

#: Far longer than anything takes; only a failure waits for it.
PATIENCE_S = 40.0

M = TypeVar("M", bound=Message)


class PublishedMessages:
    """A hub with a context for one driver called `it`, and everything that was published."""

    def __init__(self, folder: Path, clock: Clock | None = None) -> None:
        self.clock = clock or RealClock()
        self.messages: list[Message] = []
        self._news = asyncio.Event()
        hub = Hub(self.clock, lambda message, line: None)
        hub.listen(self._take)
        self.context = SessionDriverContext("it", hub, self.clock, folder)

    def _take(self, message: Message) -> None:
        self.messages.append(message)
        self._news.set()

    def all(self, kind: type[M]) -> list[M]:
        """Every message of a kind so far."""
        return [message for message in self.messages if isinstance(message, kind)]

    def values(self, sensor: str) -> list[float | None]:
        """The values of a sensor so far."""
        return [reading.value for reading in self.all(Reading) if reading.sensor == sensor]

    def states(self, sensor: str) -> list[str]:
        """The states a sensor went through."""
        return [
            sensor_changed.state
            for sensor_changed in self.all(SensorChanged)
            if sensor_changed.sensor == sensor
        ]

    async def until(self, holds: Callable[[], bool]) -> None:
        """Return when `holds()`, looked at after every message."""
        try:
            async with asyncio.timeout(PATIENCE_S):
                while not holds():
                    self._news.clear()
                    await self._news.wait()
        except TimeoutError:
            raise AssertionError(
                f"not within {PATIENCE_S:g} s; heard last: {self.messages[-12:]}"
            ) from None

    async def first(self, kind: type[M], after: int = 0) -> M:
        """The first message of a kind, not counting the first `after` of them."""
        await self.until(lambda: len(self.all(kind)) > after)
        return self.all(kind)[after]

    async def state(self, sensor: str, state: str) -> SensorChanged:
        """The newest change of a sensor, once it is the one to `state`."""

        def newest() -> SensorChanged | None:
            moved = [one for one in self.all(SensorChanged) if one.sensor == sensor]
            return moved[-1] if moved and moved[-1].state == state else None

        await self.until(lambda: newest() is not None)
        found = newest()
        assert found is not None
        return found


@dataclass
class BusJob:
    """A job as the bus hands it out."""

    verb: str
    args: Mapping[str, Json] = field(default_factory=dict)
    command: str = "c1"
    announced: list[float] = field(default_factory=list)
    source: str = "key"
    #: Why each motion that went on ended; empty: it arrived.
    arrivals: list[str] = field(default_factory=list)
    evidences: list[str] = field(default_factory=list)

    def expects(self, seconds: float) -> None:
        """Remember what the driver announced."""
        self.announced.append(seconds)

    def goes_on(self) -> Callable[[str], None]:
        """Remember why its motion ended."""
        return self.arrivals.append

    def mark(self, sort: str, text: str = "") -> None:
        """Nobody follows its words."""

    def evidence(self, kind: Evidence) -> None:
        """Remember what its end stands on."""
        self.evidences.append(kind)


async def until(holds: Callable[[], bool]) -> None:
    """Return when `holds()`; for what no message tells, such as the state of a process."""
    async with asyncio.timeout(PATIENCE_S):
        while not holds():  # noqa: ASYNC110 - there is no event to wait for
            await asyncio.sleep(0.005)
