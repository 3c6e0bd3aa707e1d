"""Where `.ci/peers` has installed what the tests need."""

from __future__ import annotations

from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PEERS = ROOT / ".venv" / "peers"


def place(name: str) -> Path:
    """The folder of an installed peer; a virtual environment if it is a Python program.

    Skips the test if it is not there: `make peers` says why. Raises `ValueError` for a name that
    `.ci/peers` does not install: its test would be skipped for ever.
    """
    installs = f"peer_{name.replace('-', '_')}() {{"
    if "_" in name or installs not in (ROOT / ".ci/peers").read_text().splitlines():
        raise ValueError(f".ci/peers installs no peer {name}")
    folder = PEERS / name
    if not (folder / ".installed").exists():
        pytest.skip(f"the peer {name} is not installed: make peers")
    return folder
