"""Fixtures for everything that talks to a NAOqi: a robot, what the wizard is told."""

from __future__ import annotations

from collections.abc import AsyncIterator, Iterator
from pathlib import Path

import pytest
import pytest_asyncio
from woz_drivers.naoqi_robot import line

from tests.drivers.pepper.connection_rig import patience
from tests.drivers.pepper.robot_rig import RobotRig, connected_robot
from tests.drivers.published_messages import PublishedMessages
from tests.fakes.naoqi import StandIn, stand_in
from tests.fakes.ports import free_port


@pytest.fixture
async def robot() -> AsyncIterator[StandIn]:
    """A simulated Pepper in a process of its own, hosted by qi where it is installed."""
    async with stand_in() as started:
        yield started


@pytest.fixture
def port() -> int:
    """For a robot that comes back to it: nobody else gets it while the robot is away."""
    return free_port()


@pytest.fixture
def patient() -> Iterator[None]:
    """A robot on a busy machine takes its time."""
    with patience():
        yield


@pytest.fixture
def unhurried_loss(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is no loss is none on a busy machine, either; who is silent for longer is lost."""
    for limit in ("SILENT_S", "ANSWER_S", "NOTICED_S"):
        monkeypatch.setattr(line, limit, 5 * getattr(line, limit))


@pytest.fixture
def published(tmp_path: Path) -> PublishedMessages:
    """What the driver tells its session."""
    return PublishedMessages(tmp_path)


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """A module that has `KINDS` is about what all these kinds of robots have."""
    kinds = getattr(metafunc.module, "KINDS", None)
    if kinds and "rig" in metafunc.fixturenames:
        metafunc.parametrize("rig", kinds, indirect=True, scope="module")


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def rig(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> AsyncIterator[RobotRig]:
    """One robot and its driver for a module whose tests leave nothing behind."""
    kind = getattr(request, "param", "pepper")
    async with connected_robot(tmp_path_factory.mktemp("experiment"), kind=kind) as made:
        yield made


@pytest_asyncio.fixture(loop_scope="module")
async def robot_rig(rig: RobotRig) -> RobotRig:
    """That robot, without what the tests before have done with it."""
    await rig.forget()
    return rig
