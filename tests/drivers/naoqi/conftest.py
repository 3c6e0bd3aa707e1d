"""Robots for the tests of the stand-in."""

from __future__ import annotations

from collections.abc import AsyncIterator
from pathlib import Path

import pytest
from naoqi_simulator.world import SimulatorOptions
from qimessaging import NaoqiClient

from tests.drivers.naoqi.robot_callers import HandTime, SimulatedRobotRig
from tests.fakes.naoqi import stand_in_here


@pytest.fixture
async def rig(tmp_path: Path) -> AsyncIterator[SimulatedRobotRig]:
    """A robot in this loop, reached over a socket; its time stands still, nobody is there."""
    time = HandTime()
    options = SimulatorOptions(visitors=False, invalid_signature=False, files=tmp_path)
    async with stand_in_here(time, options) as robot:
        client = await NaoqiClient.open("127.0.0.1", int(robot.address.rpartition(":")[2]))
        try:
            yield SimulatedRobotRig(robot, client, time)
        finally:
            await client.close()
