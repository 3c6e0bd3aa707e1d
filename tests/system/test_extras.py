"""What to type for an extra works where woz-tui is installed, whatever the shell's `pip` is."""

from __future__ import annotations

import shlex
import subprocess
import sys
from importlib.util import find_spec

import pytest

from woz_tui.system import extras
from woz_tui.system.extras import install_command


@pytest.fixture
def without_pip(monkeypatch: pytest.MonkeyPatch) -> None:
    """As `uv tool install` leaves it."""
    monkeypatch.setattr(
        extras, "find_spec", lambda name: None if name == "pip" else find_spec(name)
    )


@pytest.mark.usefixtures("without_pip")
def test_where_uv_installed_it_uv_is_what_there_is() -> None:
    words = shlex.split(install_command("page"))
    assert words == ["uv", "pip", "install", "--python", sys.executable, "woz-tui[page]"]


@pytest.mark.skipif(find_spec("pip") is None, reason="this environment was made by uv")
def test_the_command_finds_the_woz_tui_that_is_there() -> None:
    """Without asking a registry for woz-tui itself: `pepper` is an extra without packages."""
    words = [*shlex.split(install_command("pepper")), "--dry-run", "--no-index", "--no-deps"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert (done.returncode, "does not provide the extra" in done.stderr) == (0, False), done.stderr
