"""The wizard's own keymap file, an option of every command that opens a console."""

from __future__ import annotations

import argparse
import os
from collections.abc import Sequence
from pathlib import Path

from woz_tui.experiment.builtins import BUILTIN, Builtin


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
    file: Path | None = arguments.keymap
    if file is None:
        file = _config() / "woz" / "keymap.yaml"
        if not file.exists():
            return BUILTIN
    from woz_tui.experiment.keys import load_keymap  # noqa: PLC0415 - few wizards have a file

    return load_keymap(file)


def _config() -> Path:
    configured = os.environ.get("XDG_CONFIG_HOME", "")
    return Path(configured) if configured else Path.home() / ".config"
