"""What all tests of the driver `ros` share."""

from __future__ import annotations

import pytest
from woz_drivers.lines import answer_times
from woz_drivers.ros import rosbridge, velocity_drive
from woz_drivers.ros.rosbridge import Rosbridge

from woz_tui.drivers import confirmed_stop


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """The simulated server finds its subscribers at once, and a busy machine may be slow."""
    monkeypatch.setattr(rosbridge, "DISCOVERY_S", 0.0)
    monkeypatch.setattr(answer_times, "_SLOW_MS", 10_000.0)
    monkeypatch.setattr(Rosbridge.wait_until_processed, "__defaults__", (8.0,))
    monkeypatch.setattr(confirmed_stop, "STOP_S", 8 * confirmed_stop.STOP_S)
    monkeypatch.setattr(velocity_drive, "_SILENT_S", 8 * velocity_drive._SILENT_S)
