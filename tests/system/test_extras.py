"""What to type for an extra works where woz-tui is installed, whatever the shell's `pip` is."""

from __future__ import annotations

import shlex
import subprocess

from woz_tui.system.extras import install_command


def test_the_command_finds_the_woz_tui_that_is_there() -> None:
    """Without asking a registry for woz-tui itself: `pepper` is an extra without packages."""
    words = [*shlex.split(install_command("pepper")), "--dry-run", "--no-index", "--no-deps"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert (done.returncode, "does not provide the extra" in done.stderr) == (0, False), done.stderr
