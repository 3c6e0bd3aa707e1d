"""A Furhat's driver with a simulated robot on the other end of the wire.

The robot's time passes only when a test says so: what goes on goes on until then.
"""

from __future__ import annotations

import asyncio
import dataclasses
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest
from naoqi_simulator.robot_time import PacedTime
from naoqi_simulator.visitor import SimulatedPerson
from robot_simulators.furhat import FurhatSimulator
from woz_drivers.furhat import Furhat, FurhatSettings, driver, senses
from woz_drivers.furhat.settings import FurhatListeningSettings, FurhatSensesSettings

from tests.fakes.manual_pace import ManualPace
from woz_tui.drivers.contract import Health, Scope, StopReport
from woz_tui.protocol.messages import Json, SettingsShown
from woz_tui.system.clock import ManualClock
from woz_tui.testing import PlainJob, RecordingContext, until

#: Nothing is read or heard where a test is not about it.
QUIET = FurhatSensesSettings(users=False, loudness=False)
DEAF = FurhatListeningSettings(on=False)
SOMEBODY = SimulatedPerson(1, 1.2, 0.35, looking=True, talking=False)


class FurhatRig:
    """`robot` on one end, `context` on the other, `driver` between them."""

    def __init__(self, robot: FurhatSimulator, driver: Furhat, context: RecordingContext) -> None:
        self.robot = robot
        self.driver = driver
        self.context = context
        self.jobs: list[PlainJob] = []
        self._tasks: list[asyncio.Task[Mapping[str, Json]]] = []

    def begin(self, verb: str, **args: Any) -> asyncio.Task[Mapping[str, Json]]:
        """Perform a verb in the background, as a lane does: with its defaults filled in."""
        offered = {one.name: one for one in Furhat.offer(self.driver.settings).verbs}
        defaults = {one.name: one.default for one in offered[verb].arguments}
        self.jobs.append(PlainJob(verb, defaults | args))
        task = asyncio.create_task(self.driver.perform(self.jobs[-1]))
        self._tasks.append(task)
        return task

    async def do(self, verb: str, **args: Any) -> dict[str, Json]:
        """Perform a verb to its end while the robot's time passes; what was really sent."""
        return await self.ended(self.begin(verb, **args))

    async def ended(self, task: asyncio.Task[Mapping[str, Json]]) -> dict[str, Json]:
        """Let the robot's time pass until this has ended."""
        async with asyncio.timeout(20):
            while not task.done():
                await self.passes(0.1)
        return dict(task.result())

    async def arrived(self) -> None:
        """Wait until the robot has taken everything that was sent to it."""
        level = (self.robot.volume + 1) % 100
        await self.do("volume", level=level / 100)
        await until(lambda: self.robot.volume == level)

    async def passes(self, seconds: float) -> None:
        """Let so much of the robot's time pass, and messages arrive."""
        if isinstance(self.robot.time, ManualPace):
            await self.robot.time.advance(seconds)
        await asyncio.sleep(0.002)

    async def stop(self) -> StopReport:
        """Press the stop as the bus does: drivers first, then their jobs; no job is left."""
        stopping = asyncio.create_task(self.driver.stop(Scope.ALL))
        await asyncio.sleep(0)
        for task in self._tasks:
            task.cancel()
        report = await stopping
        assert report is not None
        if self._tasks:
            await asyncio.wait(self._tasks)
        return report

    async def is_there(self) -> None:
        """Wait until the robot is connected."""
        await until(lambda: self.healthy is Health.CONNECTED, 20)

    async def is_lost(self) -> None:
        """Wait until it is known that the robot is lost."""
        await until(lambda: self.healthy is Health.LOST, 20)

    @property
    def healthy(self) -> Health:
        """How the driver says that it is."""
        return self.context.healths[-1][0]

    @property
    def settings_shown(self) -> dict[str, Json]:
        """The robot's settings as told last."""
        latest = self.context.shown[-1]
        assert isinstance(latest, SettingsShown)
        return latest.values

    @property
    def notices(self) -> str:
        """All sentences for the wizard."""
        return "\n".join(text for _, text, _ in self.context.notices)

    async def close(self) -> None:
        """End jobs and driver."""
        for task in self._tasks:
            task.cancel()
        if self._tasks:
            await asyncio.wait(self._tasks)
        await self.driver.close()


def looks_often(monkeypatch: pytest.MonkeyPatch) -> None:
    """Have the driver look at short notice what has changed by itself."""
    monkeypatch.setattr(driver, "_LOOK_S", 0.02)
    monkeypatch.setattr(senses, "_QUIET_S", 0.05)


@asynccontextmanager
async def connected_furhat(
    folder: Path = Path(), robot: FurhatSimulator | None = None, **settings: Any
) -> AsyncIterator[FurhatRig]:
    """A robot and a driver that is connected to it."""
    started = robot or FurhatSimulator(ManualPace(ManualClock()))
    async with started:
        furhat_settings = FurhatSettings(address=started.address, senses=QUIET, listening=DEAF)
        context = RecordingContext(folder)
        rig = FurhatRig(
            started,
            Furhat("it", dataclasses.replace(furhat_settings, **settings), context),
            context,
        )
        await rig.driver.open()
        try:
            await rig.is_there()
            yield rig
        finally:
            await rig.close()


def brisk() -> FurhatSimulator:
    """A robot whose time passes by itself, fast."""
    return FurhatSimulator(PacedTime(100))
