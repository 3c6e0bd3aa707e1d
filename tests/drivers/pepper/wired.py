"""One part of the driver with a simulated robot on the other end of a real connection."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any, Generic, TypeVar

from woz_drivers.naoqi_robot.parts import NaoqiPart
from woz_drivers.naoqi_robot.robot_connection import RobotConnection
from woz_drivers.pepper.settings import PepperSettings

from tests.drivers.heard import PATIENCE_S, Heard, Ordered
from tests.drivers.pepper.connected import patience
from tests.fakes.naoqi import StandIn, StandInHere
from woz_tui.drivers.contract import DriverError
from woz_tui.protocol.messages import Json, Notice, Reading

P = TypeVar("P", bound=NaoqiPart)


class Wired(Generic[P]):
    """`part` with what it tells, and the robot it is connected to."""

    def __init__(
        self, kind: type[P], folder: Path, settings: PepperSettings, robot: StandIn | StandInHere
    ) -> None:
        self.robot = robot
        self.heard = Heard(folder)
        self.connection = RobotConnection(
            settings, self.heard.context, on_connected=self._connected, on_lost=self._lost
        )
        self.part = kind(self.connection, settings, self.heard.context)
        self.troubles: list[DriverError] = []
        self._times = 0
        self._changed = asyncio.Event()

    async def _connected(self) -> None:
        try:
            await self.part.connected()
        except DriverError as error:
            self.troubles.append(error)
        self._times += 1
        self._changed.set()

    def _lost(self) -> None:
        self.part.lost()

    async def connected(self, times: int = 1) -> None:
        """Return when the part has been connected so often."""
        async with asyncio.timeout(PATIENCE_S):
            while self._times < times:
                self._changed.clear()
                await self._changed.wait()

    async def do(self, verb: str, **args: Any) -> Mapping[str, Json]:
        """Perform a verb to its end."""
        return await self.part.perform(Ordered(verb, args))

    @property
    def notices(self) -> list[str]:
        """Sentences for the wizard so far."""
        return [notice.text for notice in self.heard.all(Notice)]

    def last(self, sensor: str) -> Reading | None:
        """The newest reading of a sensor."""
        found = [one for one in self.heard.all(Reading) if one.sensor == sensor]
        return found[-1] if found else None

    async def reads(self, sensor: str, value: float | None, text: str = "") -> Reading:
        """Wait until the newest reading of a sensor is this."""

        def there() -> bool:
            last = self.last(sensor)
            return last is not None and (last.value, last.text) == (value, text)

        await self.heard.until(there)
        found = self.last(sensor)
        assert found is not None
        return found

    async def close(self) -> None:
        """As the driver does it."""
        await self.part.close()
        await self.connection.close()


@asynccontextmanager
async def wired(
    kind: type[P],
    folder: Path,
    robot: StandIn | StandInHere,
    **settings: Any,
) -> AsyncIterator[Wired[P]]:
    """Connect a part; yield it when it is there."""
    given = PepperSettings(robots=(robot.address,), **settings)
    it = Wired(kind, folder, given, robot)
    with patience():
        it.connection.start()
        try:
            await it.connected()
            yield it
        finally:
            await it.close()
