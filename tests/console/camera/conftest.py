"""What tests of pictures have in common."""

from __future__ import annotations

import pytest


@pytest.fixture(autouse=True)
def nothing_is_drawn_unseen() -> None:
    """Here everything is drawn: the next picture is asked for when one has been."""
