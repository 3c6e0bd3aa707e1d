"""The contract of drivers, with a simulated NAO and Pepper behind a network that can be cut."""

from __future__ import annotations

import contextlib
from collections.abc import AsyncIterator
from typing import Any, ClassVar

import pytest
from woz_drivers.nao.driver import Nao
from woz_drivers.nao.settings import NaoSettings
from woz_drivers.naoqi_robot.driver import NaoqiRobot
from woz_drivers.pepper.driver import Pepper
from woz_drivers.pepper.settings import PepperSettings

from tests.drivers.pepper.robot_rig import QUIET
from tests.fakes.dropping_proxy import dropping_proxy
from tests.fakes.naoqi import stand_in
from woz_tui.testing import Device, DriverTests, PlainJob


@pytest.mark.real_clock
@pytest.mark.safety
class TestNao(DriverTests):
    driver: ClassVar[type[NaoqiRobot]] = Nao
    settings: ClassVar[Any] = NaoSettings(address="127.0.0.1:1")
    robot = "nao"

    def reached(self, address: str) -> Any:
        """Settings with which the driver finds its robot."""
        return NaoSettings(address=address, senses=QUIET)

    @contextlib.asynccontextmanager
    async def device(self) -> AsyncIterator[Device]:
        async with (
            stand_in("own", pace=1.0, options=("--robot", self.robot)) as robot,
            dropping_proxy(robot.port) as network,
        ):

            async def still() -> bool:
                return not any(await robot.get("velocity"))

            async def received() -> dict[str, float]:
                walks = await robot.trace("ALMotion.moveTo")
                return {"x": walks[-1].args[0]} if walks else {}

            async def refuse() -> None:
                await robot.fault("refuse:ALMotion.moveTo=something is too hot")

            yield Device(
                self.reached(network.address),
                unplug=network.cut,
                plug=network.heal,
                command=PlainJob("drive", {"x": 4.0}),
                still=still,
                received=received,
                fail=refuse,
            )
            network.heal()


class TestPepper(TestNao):
    driver = Pepper
    settings = PepperSettings(robots=("tcp://127.0.0.1:1",))
    robot = "pepper"

    def reached(self, address: str) -> PepperSettings:
        return PepperSettings(robots=(address,), senses=QUIET)
