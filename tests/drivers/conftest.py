"""What tests of several drivers' files need."""

from __future__ import annotations

import pytest
from woz_drivers.dynamixel import wire

from tests.drivers.published_messages import PATIENCE_S
from tests.drivers.servo_rig import MEASURED_MS, MISSING_MS
from woz_tui.drivers import confirmed_stop


@pytest.fixture
def patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is measured of late answers leaves room for those that this machine delays besides."""
    monkeypatch.setattr(wire, "AMPLE_MS", MEASURED_MS)
    monkeypatch.setattr(wire, "answer_timeout_ms", lambda latency_ms: latency_ms + MISSING_MS)


@pytest.fixture
def unhurried_stop(monkeypatch: pytest.MonkeyPatch) -> None:
    """A busy machine takes its time; that a stop waits no longer is another test's."""
    monkeypatch.setattr(confirmed_stop, "STOP_S", PATIENCE_S)
