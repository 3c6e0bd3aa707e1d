"""`.ci/test`, with a stand-in for pytest."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
#: The exit status of pytest that found no test.
NONE = 5
PYTHON = """#!/bin/bash
case "$*" in
  *compileall*) exit 0 ;;
  *"not real_clock"*) exit {computing} ;;
  *) exit {timed} ;;
esac
"""


def run(folder: Path, computing: int, timed: int, *options: str) -> int:
    """The script's status; pytest ends with these, for what does not need the real clock and for
    the rest.
    """
    (folder / ".ci").mkdir()
    (folder / "tests" / "__pycache__").mkdir(parents=True)
    shutil.copy(ROOT / ".ci" / "test", folder / ".ci")
    python = folder / ".venv" / "bin" / "python"
    python.parent.mkdir(parents=True)
    python.write_text(PYTHON.format(computing=computing, timed=timed))
    python.chmod(0o755)
    command = [str(folder / ".ci" / "test"), *options]
    return subprocess.run(command, capture_output=True, timeout=60, check=False).returncode


@pytest.mark.parametrize("statuses", [(0, 0), (0, NONE), (NONE, 0)])
def test_tests_of_one_sort_alone_are_enough(tmp_path: Path, statuses: tuple[int, int]) -> None:
    assert run(tmp_path, *statuses) == 0


@pytest.mark.parametrize("statuses", [(NONE, NONE), (1, 0), (0, 1), (NONE, 1), (2, NONE)])
def test_no_test_at_all_fails_as_a_failed_one_does(
    tmp_path: Path, statuses: tuple[int, int]
) -> None:
    assert run(tmp_path, *statuses, "-k", "typo") != 0


@pytest.mark.parametrize(("status", "passes"), [(0, True), (NONE, False), (1, False)])
def test_marked_tests_are_one_run(tmp_path: Path, status: int, passes: bool) -> None:
    assert (run(tmp_path, 1, status, "-m", "hypothesis") == 0) is passes
