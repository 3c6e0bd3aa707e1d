"""The contract of drivers, with a simulated NAO behind a network that can be cut."""

from __future__ import annotations

import contextlib
from collections.abc import AsyncIterator

import pytest
from woz_drivers.nao.driver import Nao
from woz_drivers.nao.settings import NaoSettings

from tests.drivers.pepper.played import QUIET
from tests.fakes.dropping_proxy import dropping_proxy
from tests.fakes.naoqi import stand_in
from woz_tui.testing import Device, DriverTests, PlainJob


@pytest.mark.real_clock
@pytest.mark.safety
class TestNao(DriverTests):
    driver = Nao
    settings = NaoSettings(address="127.0.0.1:1")

    @contextlib.asynccontextmanager
    async def device(self) -> AsyncIterator[Device]:
        async with (
            stand_in("own", pace=1.0, options=("--robot", "nao")) as robot,
            dropping_proxy(robot.port) as network,
        ):
            settings = NaoSettings(address=network.address, senses=QUIET)
            walk = PlainJob("drive", {"x": 4.0})
            yield Device(settings, network.cut, network.heal, walk)
            network.heal()
