"""One NAO and its driver for each module whose tests leave nothing behind."""

from __future__ import annotations

from collections.abc import AsyncIterator

import pytest
import pytest_asyncio
from woz_drivers.naoqi_robot.settings import SensesSettings

from tests.drivers.pepper.robot_rig import RobotRig, connected_robot
from tests.drivers.published_messages import PATIENCE_S


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def rig(tmp_path_factory: pytest.TempPathFactory) -> AsyncIterator[RobotRig]:
    """It feels whatever there is to feel."""
    folder = tmp_path_factory.mktemp("experiment")
    async with connected_robot(
        folder, kind="nao", pace=20.0, senses=SensesSettings(rate=20)
    ) as made:
        yield made


@pytest_asyncio.fixture(loop_scope="module")
async def robot_rig(rig: RobotRig) -> RobotRig:
    """That robot on its feet, without what the tests before have done with it."""
    await rig.forget()
    return rig


@pytest.fixture(autouse=True)
def unhurried(monkeypatch: pytest.MonkeyPatch) -> None:
    """A busy machine takes its time; that a stop waits no longer is another test's. Motors are
    asked about more often, so that tests wait less.
    """
    monkeypatch.setattr("woz_tui.drivers.confirmed_stop.STOP_S", PATIENCE_S)
    monkeypatch.setattr("woz_drivers.nao.body_senses.WARMTH_EVERY", 5)
