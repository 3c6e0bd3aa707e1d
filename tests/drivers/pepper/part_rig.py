"""One part of the driver with a simulated robot on the other end of a real connection."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any, Generic, TypeVar

from woz_drivers.naoqi_robot.connection import RobotConnection
from woz_drivers.naoqi_robot.parts import NaoqiPart
from woz_drivers.pepper.settings import PepperSettings

from tests.drivers.pepper.connection_rig import patience
from tests.drivers.published_messages import PATIENCE_S, BusJob, PublishedMessages
from tests.fakes.naoqi import StandIn, StandInHere
from woz_tui.drivers.contract import DriverError
from woz_tui.protocol.messages import Json, Notice, Reading

P = TypeVar("P", bound=NaoqiPart)


class PartRig(Generic[P]):
    """`part` with what it tells, and the robot it is connected to."""

    def __init__(
        self, kind: type[P], folder: Path, settings: PepperSettings, robot: StandIn | StandInHere
    ) -> None:
        self.robot = robot
        self.published = PublishedMessages(folder)
        self.connection = RobotConnection(
            settings, self.published.context, on_connected=self._connected, on_lost=self._lost
        )
        self.part = kind(self.connection, settings, self.published.context)
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

    async def wait_connected(self, times: int = 1) -> None:
        """Return when the part has been connected so often."""
        async with asyncio.timeout(PATIENCE_S):
            while self._times < times:
                self._changed.clear()
                await self._changed.wait()

    async def do(self, verb: str, **args: Any) -> Mapping[str, Json]:
        """Perform a verb to its end."""
        return await self.part.perform(BusJob(verb, args))

    @property
    def notices(self) -> list[str]:
        """Sentences for the wizard so far."""
        return [notice.text for notice in self.published.all(Notice)]

    def last(self, sensor: str) -> Reading | None:
        """The newest reading of a sensor."""
        found = [one for one in self.published.all(Reading) if one.sensor == sensor]
        return found[-1] if found else None

    async def reads(self, sensor: str, value: float | None, text: str = "") -> Reading:
        """Wait until the newest reading of a sensor is this."""

        def there() -> bool:
            last = self.last(sensor)
            return last is not None and (last.value, last.text) == (value, text)

        await self.published.until(there)
        found = self.last(sensor)
        assert found is not None
        return found

    async def close(self) -> None:
        """As the driver does it."""
        await self.part.close()
        await self.connection.close()


@asynccontextmanager
async def connected_part(
    kind: type[P],
    folder: Path,
    robot: StandIn | StandInHere,
    **settings: Any,
) -> AsyncIterator[PartRig[P]]:
    """Connect a part; yield it when it is there."""
    pepper_settings = PepperSettings(robots=(robot.address,), **settings)
    rig = PartRig(kind, folder, pepper_settings, robot)
    with patience():
        rig.connection.start()
        try:
            await rig.wait_connected()
            yield rig
        finally:
            await rig.close()
