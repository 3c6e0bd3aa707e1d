"""`python -m tools.stalls`, which finds the tests that fail on a busy machine."""

from __future__ import annotations

import subprocess
import sys

import pytest

#: Ends when it has stood still.
PROGRAM = """
import time
last = time.monotonic()
while (now := time.monotonic()) - last < 0.15:
    last = now
print("stood still")
"""


@pytest.mark.real_clock
def test_processes_below_the_command_stand_still_and_go_on() -> None:
    command = f"{sys.executable} -c '{PROGRAM}'; exit 3"
    run = subprocess.run(
        [sys.executable, "-m", "tools.stalls", "sh", "-c", command],
        check=False,
        capture_output=True,
        text=True,
    )
    assert (run.returncode, run.stdout) == (3, "stood still\n")
