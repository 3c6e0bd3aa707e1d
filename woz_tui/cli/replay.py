"""`woz replay FILE`: a session again, on the screen or on the robot."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path


def add(parser: argparse.ArgumentParser) -> None:
    """Declare the command's options."""
    parser.add_argument("file", type=Path, metavar="FILE", help="a session's log")
    parser.add_argument("--robot", action="store_true", help="run its commands on the robot again")
    parser.add_argument(
        "--dry-run", action="store_true", help="say what --robot would do, and check it"
    )
    parser.add_argument("--yes", action="store_true", help="with --robot: do not ask")
    parser.add_argument("--headless", action="store_true", help="with --robot: without a console")
    parser.add_argument(
        "--changed", action="store_true", help="also if the experiment has changed since"
    )
    parser.add_argument(
        "--experiment", type=Path, default=None, metavar="FILE", help="where its experiment is now"
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Replay it; the exit code."""
    if arguments.robot or arguments.dry_run:
        from woz_tui.cli import rerun  # noqa: PLC0415

        return rerun.play(arguments)
    print("woz: say --robot or --dry-run", file=sys.stderr)
    return 2
