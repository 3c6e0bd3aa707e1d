"""Fixtures for everything that talks to a NAOqi: both clients, a robot, what the wizard is told."""

from __future__ import annotations

import importlib.util
from collections.abc import AsyncIterator
from pathlib import Path

import pytest

from tests.drivers.heard import Heard
from tests.fakes.naoqi import StandIn, stand_in

#: What carries a connection here: our own client everywhere, qi where it has wheels.
CLIENTS = ("own", "qi") if importlib.util.find_spec("qi") else ("own",)


@pytest.fixture(params=CLIENTS)
def client(request: pytest.FixtureRequest) -> str:
    """The setting `client`: the test runs with each of them."""
    return str(request.param)


@pytest.fixture
async def robot() -> AsyncIterator[StandIn]:
    """A simulated Pepper in a process of its own, hosted by qi where it is installed."""
    async with stand_in() as started:
        yield started


@pytest.fixture
def heard(tmp_path: Path) -> Heard:
    """What the driver tells its session."""
    return Heard(tmp_path)
