"""A simulated robot on a bench: its time moved by hand, everything it tells remembered."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager
from dataclasses import dataclass
from pathlib import Path

from woz_drivers.simulated import SimulatedRobot, SimulatedSettings

from tests.fakes.manual_pace import ManualPace
from woz_tui.drivers.argument_check import ArgumentError, checked
from woz_tui.drivers.contract import Health, RejectedError
from woz_tui.protocol.messages import Json
from woz_tui.system.clock import ManualClock
from woz_tui.testing import PlainJob, RecordingContext


@dataclass
class Rig:
    """A robot, its time and what it told."""

    robot: SimulatedRobot
    pace: ManualPace
    context: RecordingContext

    def begin(self, verb: str, **args: Json) -> asyncio.Task[Mapping[str, Json]]:
        return asyncio.create_task(self.perform(PlainJob(verb, args)))

    async def perform(self, job: PlainJob) -> Mapping[str, Json]:
        verbs = {verb.name: verb for verb in self.robot.offer(self.robot.settings).verbs}
        if job.verb in verbs:  # as the bus does
            try:
                job.args = checked(verbs[job.verb], job.args)
            except ArgumentError as error:
                raise RejectedError(str(error)) from None
        return await self.robot.perform(job)

    def health(self) -> Health:
        return self.context.healths[-1][0]

    async def do(self, verb: str, **args: Json) -> Mapping[str, Json]:
        """Perform, letting time pass until it has ended; a minute is enough for all of them."""
        task = self.begin(verb, **args)
        for _ in range(600):
            await self.pace.settle()
            if task.done():
                break
            await self.pace.advance(0.1)
        assert task.done(), f"{verb} never ended"
        return task.result()


@asynccontextmanager
async def rig(folder: Path, settings: SimulatedSettings | None = None) -> AsyncIterator[Rig]:
    clock = ManualClock()
    pace = ManualPace(clock)
    context = RecordingContext(folder, clock)
    robot = SimulatedRobot("robot", settings or SimulatedSettings(), context, pace=pace)
    await robot.open()
    await pace.settle()
    try:
        yield Rig(robot, pace, context)
    finally:
        await robot.close()
