"""Where this user's settings and what is kept between sessions lie, as the XDG base directories."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Mapping
from pathlib import Path

#: A file that is there once a console has been opened.
SEEN = Path("woz-tui", "console-seen")
#: The code of the wizard who played last.
WIZARD = Path("woz-tui", "wizard")


def config_folder(environ: Mapping[str, str] = os.environ) -> Path:
    """`$XDG_CONFIG_HOME`, else `~/.config`. Raises `RuntimeError` if there is no home."""
    configured = environ.get("XDG_CONFIG_HOME", "")
    return Path(configured) if configured else Path.home() / ".config"


def is_first_start() -> bool:
    """Whether this user has never opened a console before; asked once, it is remembered. A folder
    that takes no file is no reason not to play.
    """
    with contextlib.suppress(OSError, RuntimeError):
        seen = state_folder() / SEEN
        seen.parent.mkdir(parents=True, exist_ok=True)
        if not seen.exists():
            seen.touch()
            return True
    return False


def state_folder() -> Path:
    """`$XDG_STATE_HOME` if that is absolute, else `~/.local/state`. Raises `RuntimeError` if there
    is no home.
    """
    return _folder("XDG_STATE_HOME", ".local/state")


def cache_folder() -> Path:
    """The same of what can be made anew: `$XDG_CACHE_HOME`, else `~/.cache`."""
    return _folder("XDG_CACHE_HOME", ".cache")


def kept_of_logs(what: str) -> Path:
    """The cache of something that is made of logs, a folder of files: a withdrawal empties it."""
    return cache_folder() / "woz-tui" / "logs" / what


def forget_logs() -> None:
    """Remove all that such caches hold."""
    with contextlib.suppress(OSError, RuntimeError):
        for path in kept_of_logs("").glob("*/*"):
            with contextlib.suppress(OSError):
                path.unlink()


def _folder(variable: str, below_home: str) -> Path:
    configured = Path(os.environ.get(variable, ""))
    return configured if configured.is_absolute() else Path.home() / below_home
