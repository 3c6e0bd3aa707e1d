"""Where this user's settings and what is kept between sessions lie, as the XDG base directories."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path


def config_folder(environ: Mapping[str, str] = os.environ) -> Path:
    """`$XDG_CONFIG_HOME`, else `~/.config`. Raises `RuntimeError` if there is no home."""
    configured = environ.get("XDG_CONFIG_HOME", "")
    return Path(configured) if configured else Path.home() / ".config"


def state_folder() -> Path:
    """`$XDG_STATE_HOME` if that is absolute, else `~/.local/state`. Raises `RuntimeError` if there
    is no home.
    """
    configured = Path(os.environ.get("XDG_STATE_HOME", ""))
    return configured if configured.is_absolute() else Path.home() / ".local" / "state"
