"""A lab for each test."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.e2e.lab import Lab


@pytest.fixture
def lab() -> Iterator[Lab]:
    """Folders and processes of one test; nothing is left of them afterwards."""
    with Lab() as place:
        yield place
