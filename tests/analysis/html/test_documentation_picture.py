"""The documentation's picture of a report can be drawn, and stays small."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]


@pytest.mark.browser
def test_the_picture_can_be_drawn(tmp_path: Path) -> None:
    drawn = tmp_path / "report.png"
    done = subprocess.run(
        [sys.executable, "-m", "tools.report_picture", str(drawn)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=100,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    for picture in (drawn, ROOT / "docs" / "images" / "report.png"):
        assert picture.read_bytes().startswith(b"\x89PNG")
        assert 50_000 < picture.stat().st_size < 200_000
