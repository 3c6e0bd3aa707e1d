"""All tests of this folder are marked: `make peers` runs them, `make test` leaves them out. Others'
programs run in real time, so that a test that fails gets a second run (`tests/second_run.py`).
"""

from __future__ import annotations

from pathlib import Path

import pytest


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    here = f"{Path(__file__).parent}/"
    for item in items:  # of all folders, in each of many processes: thousands
        if str(item.path).startswith(here):
            item.add_marker(pytest.mark.peers)
            item.add_marker(pytest.mark.real_clock)
