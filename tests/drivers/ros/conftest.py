"""What all tests of the driver `ros` share."""

from __future__ import annotations

import pytest
from woz_drivers.ros import rosbridge

from woz_tui.testing import contract_checks


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """The simulated server finds its subscribers at once, and a busy machine may be slow."""
    monkeypatch.setattr(rosbridge, "DISCOVERY_S", 0.0)
    monkeypatch.setattr(contract_checks, "PROMPT", 8 * contract_checks.PROMPT)
