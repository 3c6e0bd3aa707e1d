"""`woz demo`: a session with a simulated robot and a simulated visitor."""

from __future__ import annotations

import argparse
import sys
from importlib.resources import files
from pathlib import Path

from woz_tui.cli import run as run_command
from woz_tui.cli.keymap import add_keymap
from woz_tui.cli.options import add_session


def add(parser: argparse.ArgumentParser) -> None:
    """Declare the command's options."""
    add_session(parser)
    add_keymap(parser)
    parser.set_defaults(run=run, participant="P01", condition="warm")


def run(arguments: argparse.Namespace) -> int:
    """Play the demo experiment that comes with woz-tui."""
    experiment = demo_file()
    if experiment is None:
        print("woz: this installation lacks experiments/demo.yaml", file=sys.stderr)
        return 1
    return run_command.play(arguments, experiment)


def demo_file() -> Path | None:
    """`demo.yaml` of the installed package, or of the source tree it runs from."""
    package = Path(str(files("woz_tui")))
    candidates = (package / "_experiments" / "demo.yaml", package.parent / "experiments/demo.yaml")
    return next((path for path in candidates if path.exists()), None)
