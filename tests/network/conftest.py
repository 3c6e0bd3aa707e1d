"""Of tests with two computers."""

from __future__ import annotations

import pytest

from tests.network.other_computer import SILENCE_S
from woz_tui.network import remote_driver, zenoh_line


@pytest.fixture
def patient_network(monkeypatch: pytest.MonkeyPatch) -> None:
    """On a busy machine nothing is late or lost, unless a test is about that."""
    monkeypatch.setattr(zenoh_line, "CONNECT_S", 20.0)
    monkeypatch.setattr(remote_driver, "STOP_S", SILENCE_S)
    monkeypatch.setattr(remote_driver, "LATE_S", 10.0)
