"""The worker as a driver that some other package has installed."""

from __future__ import annotations

from pathlib import Path

import pytest

from woz_tui.drivers.plugins import Catalogue, installed


def installed_worker(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Catalogue:
    """All drivers, with the type `worker` of the package `lab-worker`."""
    info = folder / "lab_worker-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: lab-worker\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(
        "[woz_tui.drivers]\nworker = tests.network.worker:Worker\n"
    )
    monkeypatch.syspath_prepend(folder)
    return installed()
