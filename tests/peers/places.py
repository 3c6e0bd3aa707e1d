"""Where `.ci/peers` has installed what the tests need."""

from __future__ import annotations

from pathlib import Path

import pytest

PEERS = Path(__file__).parents[2] / ".venv" / "peers"


def place(name: str) -> Path:
    """The folder of an installed peer; a virtual environment if it is a Python program.

    Skips the test if it is not there: `make peers` says why.
    """
    folder = PEERS / name
    if not (folder / ".installed").exists():
        pytest.skip(f"the peer {name} is not installed: make peers")
    return folder
