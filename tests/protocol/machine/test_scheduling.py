"""Asking Linux to be run soon."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from woz_tui.machine.scheduling import SLICE_NS

_ASK = """
from pathlib import Path
from woz_tui.machine.scheduling import ask_for_short_turns
print(ask_for_short_turns())
print(Path("/proc/self/sched").read_text() if Path("/proc/self/sched").exists() else "")
"""


def test_linux_is_asked_and_whoever_does_not_know_it_goes_on() -> None:
    done = subprocess.run([sys.executable, "-c", _ASK], capture_output=True, text=True, check=True)
    asked, _, told = done.stdout.partition("\n")
    assert asked in ("True", "False")
    slices = [line.split(":")[1] for line in told.splitlines() if line.startswith("se.slice")]
    if asked == "True" and slices and _has_slices():
        assert int(slices[0]) == SLICE_NS


def _has_slices() -> bool:
    """Linux 6.12 and later let a thread choose."""
    release = Path("/proc/sys/kernel/osrelease").read_text().split(".")
    return (int(release[0]), int(release[1])) >= (6, 12)
