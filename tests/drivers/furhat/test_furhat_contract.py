"""The driver contract, with a robot and without."""

from __future__ import annotations

import contextlib
from collections.abc import AsyncIterator

from robot_simulators.furhat import FurhatSimulator
from woz_drivers.furhat import Furhat, FurhatSettings

from tests.fakes.manual_pace import ManualPace
from woz_tui.system.clock import ManualClock
from woz_tui.testing import Device, DriverTests, PlainJob


class TestTheContract(DriverTests):
    driver = Furhat
    settings = FurhatSettings(address="127.0.0.1:1")

    @contextlib.asynccontextmanager
    async def device(self) -> AsyncIterator[Device]:
        async with FurhatSimulator(ManualPace(ManualClock())) as robot:

            def silent() -> bool:
                return not robot.speaking

            yield Device(
                FurhatSettings(address=robot.address),
                unplug=robot.freeze,
                plug=robot.thaw,
                command=PlainJob("say", {"text": "What I have to say has no end."}),
                still=silent,
            )
