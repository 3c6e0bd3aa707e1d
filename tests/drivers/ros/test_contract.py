"""A robot behind rosbridge keeps the contract of drivers, with both versions of ROS."""

from __future__ import annotations

import contextlib
from collections.abc import AsyncIterator
from dataclasses import replace

from woz_drivers.ros.driver import Ros

from tests.drivers.ros.robots import settings, simulator
from woz_tui.testing import Device, DriverTests, PlainJob


class TestRos2(DriverTests):
    """ROS 2."""

    driver = Ros
    settings = settings(address="127.0.0.1:9")
    ros = 2

    @contextlib.asynccontextmanager
    async def device(self) -> AsyncIterator[Device]:
        """A simulated robot that turns for 40 s."""
        wanted = settings(ros=self.ros)
        async with simulator(wanted, pace=1.0) as robot:

            def still() -> bool:
                return robot.speed == (0.0, 0.0)

            def received() -> dict[str, float]:
                return {"m/s": robot.speed[0]}

            yield Device(
                replace(wanted, address=robot.address),
                unplug=robot.freeze,
                plug=robot.thaw,
                command=PlainJob("drive", {"x": 20.0, "turn": 0.0}),
                still=still,
                received=received,
                expected={"m/s": 0.5},
            )
            robot.thaw()


class TestRos1(TestRos2):
    """ROS 1."""

    ros = 1
