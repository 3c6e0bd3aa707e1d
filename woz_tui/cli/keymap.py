"""The wizard's own keymap file, an option of every command that opens a console."""

from __future__ import annotations

import argparse
import os
from collections.abc import Sequence
from pathlib import Path

from woz_tui.experiment.builtins import BUILTIN, Builtin
from woz_tui.experiment.keys import load_keymap


def add_keymap(parser: argparse.ArgumentParser) -> None:
    """Declare `--keymap`."""
    parser.add_argument(
        "--keymap",
        type=Path,
        default=None,
        help="file that moves the console's own keys (default: ~/.config/woz/keymap.yaml)",
    )


def builtins(arguments: argparse.Namespace) -> Sequence[Builtin]:
    """The console's keys, moved as the file says. Raises `ExperimentError` for a wrong file."""
    given: Path | None = arguments.keymap
    if given is not None:
        return load_keymap(given)
    usual = _config() / "woz" / "keymap.yaml"
    return load_keymap(usual) if usual.exists() else BUILTIN


def _config() -> Path:
    configured = os.environ.get("XDG_CONFIG_HOME", "")
    return Path(configured) if configured else Path.home() / ".config"
