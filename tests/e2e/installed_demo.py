"""Plays `woz demo` of an installation on a terminal: `python -m tests.e2e.installed_demo FOLDER`.

`.ci/wheel` calls it with the folder of the environment that the wheel is in.
"""

from __future__ import annotations

import sys
from pathlib import Path

import psutil

from tests.e2e.lab import end_session, recording
from tests.fakes.terminal import FakeTerminal


def main(environment: Path, recordings: str) -> int:
    """The first line of the script is said, and the session ends when its wizard says so."""
    words = [str(environment / "bin" / "woz"), "demo", "--silent", "--recordings", recordings]
    try:
        with FakeTerminal(words, columns=100, rows=36, env={"PYTHONPATH": ""}) as terminal:
            recording(terminal)
            terminal.send(" ")
            terminal.wait_text("✓ Hello “Hello P01")
            end_session(terminal)
            return terminal.wait_exit()
    finally:
        for process in psutil.process_iter(["cmdline"]):
            if (process.info["cmdline"] or [""])[0].startswith(f"{environment}/"):
                process.kill()


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), sys.argv[2]))
