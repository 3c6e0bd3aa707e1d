"""A driver with a simulated Pepper or NAO on the other end of the wire, as its session sees it."""

from __future__ import annotations

import asyncio
import dataclasses
from collections.abc import AsyncIterator, Callable, Mapping
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

from woz_drivers.nao.driver import Nao
from woz_drivers.nao.settings import NaoSettings
from woz_drivers.naoqi_robot.driver import NaoqiRobot
from woz_drivers.naoqi_robot.settings import NaoqiSettings, SensesSettings
from woz_drivers.pepper.driver import Pepper
from woz_drivers.pepper.settings import PepperSettings

from tests.drivers.pepper.connection_rig import patience
from tests.drivers.published_messages import BusJob, PublishedMessages
from tests.fakes.naoqi import Call, StandIn, stand_in
from woz_tui.drivers.contract import Scope, StopReport
from woz_tui.protocol.messages import DriverConnected, Json, Message, Notice, SettingsShown

#: How many times as fast the robot's time passes.
PACE = 20.0
#: Nothing of the senses is read where a test is not about them.
QUIET = SensesSettings(rate=1, sonar=False, people=False, loudness=False, touch=False)


class RobotRig:
    """`robot` on one end, `heard` on the other, `driver` between them."""

    def __init__(self, robot: StandIn, driver: NaoqiRobot, published: PublishedMessages) -> None:
        self.robot = robot
        self.driver = driver
        self.published = published
        self.folder = published.context.folder
        self.jobs: list[BusJob] = []
        self._tasks: list[asyncio.Task[Mapping[str, Json]]] = []

    async def do(self, verb: str, **args: Any) -> dict[str, Json]:
        """Perform a verb to its end; what was really sent."""
        return dict(await self.begin(verb, **args))

    def begin(self, verb: str, **args: Any) -> asyncio.Task[Mapping[str, Json]]:
        """Perform a verb in the background, as a lane does."""
        self.jobs.append(BusJob(verb, args))
        task = asyncio.create_task(self.driver.perform(self.jobs[-1]))
        self._tasks.append(task)
        return task

    async def cancel(self, job: asyncio.Task[Mapping[str, Json]]) -> None:
        """End a job as the bus does."""
        job.cancel()
        await asyncio.wait([job])
        assert job.cancelled()

    async def stop(self, scope: Scope = Scope.ALL) -> StopReport:
        """Press the stop as the bus does: drivers first, then their jobs; no job is left."""
        stopping = asyncio.create_task(self.driver.stop(scope))
        await asyncio.sleep(0)
        if scope is Scope.ALL:
            for task in self._tasks:
                task.cancel()
        report = await stopping
        assert report is not None
        if scope is Scope.ALL and self._tasks:
            await asyncio.wait(self._tasks)
        return report

    @property
    def settings_shown(self) -> SettingsShown:
        """The robot's settings as told last."""
        return self.published.all(SettingsShown)[-1]

    async def tells(self, holds: Callable[[SettingsShown], bool]) -> SettingsShown:
        """Wait until what is told of the settings is so."""
        await self.published.until(
            lambda: bool(self.published.all(SettingsShown)) and holds(self.settings_shown)
        )
        return self.settings_shown

    async def shows(self, **values: Json) -> SettingsShown:
        """Wait until these settings are told to be so."""
        return await self.tells(
            lambda settings_shown: values.items() <= settings_shown.values.items()
        )

    async def forget(self) -> None:
        """Forget what earlier tests did, but for the settings told last."""
        self.jobs.clear()
        self._tasks.clear()
        await self.robot.clear()
        self.published.messages[:] = self.published.all(SettingsShown)[-1:]

    @property
    def notices(self) -> list[str]:
        """Sentences for the wizard so far."""
        return [notice.text for notice in self.published.all(Notice)]

    async def calls(self, *names: str) -> list[tuple[Any, ...]]:
        """Arguments of the calls of these methods, the oldest first."""
        return [tuple(call.args) for call in await self.robot.trace(*names)]

    async def last(self, name: str) -> Call:
        """The latest call of a method."""
        return (await self.robot.called(name))[-1]

    async def close(self) -> None:
        """End jobs and driver."""
        for task in self._tasks:
            task.cancel()
        if self._tasks:
            await asyncio.wait(self._tasks)
        await self.driver.close()


@asynccontextmanager
async def connected_robot(
    folder: Path,
    *,
    kind: str = "pepper",
    pace: float = PACE,
    life: str = "solitary",
    options: tuple[str, ...] = (),
    hurried: bool = False,
    **settings: Any,
) -> AsyncIterator[RobotRig]:
    """Start a robot and a driver that plays it; yield when they are connected.

    `hurried`: a robot that is silent is noticed as soon as in a session.
    """
    with patience(hurried=hurried):
        words = ("--robot", kind, *options)
        async with stand_in(pace=pace, life=life, options=words) as robot:
            naoqi_settings = settings_for(kind, robot.address)
            rig = await connected_driver(
                robot, folder, dataclasses.replace(naoqi_settings, **settings)
            )
            try:
                yield rig
            finally:
                await rig.close()


def settings_for(kind: str, address: str) -> NaoqiSettings:
    """Those of a driver that plays the robot at this address, and reads nothing of its senses."""
    if kind == "nao":
        return NaoSettings(address=address, senses=QUIET)
    return PepperSettings(robots=(address,), senses=QUIET)


async def connected_driver(
    robot: StandIn,
    folder: Path,
    settings: NaoqiSettings,
    told: type[Message] = DriverConnected,
) -> RobotRig:
    """A driver that is connected to the robot, as it is `told`."""
    published = PublishedMessages(folder)
    driver = Nao if isinstance(settings, NaoSettings) else Pepper
    rig = RobotRig(robot, driver("it", settings, published.context), published)
    await rig.driver.open()
    await published.first(told)
    return rig
