"""`woz demo`: a session with a robot that needs no hardware."""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from importlib.resources import files
from pathlib import Path

from woz_tui.cli import run as run_command
from woz_tui.cli.shared_options import add_keymap, add_pictures, add_session, add_theme

#: Robots that can be shown: their experiment, and the condition and participant it begins with.
DEMOS: dict[str, tuple[str, str, str]] = {
    "simulated": ("demo.yaml", "warm", "P01"),
    "eyepi": ("eyepi.yaml", "default", "P01"),
    "show": ("show.yaml", "", "S1"),
    "guide": ("guide.yaml", "alone", "G01"),
    "pepper": ("pepper.yaml", "lively", "P01"),
    "study": ("study.yaml", "", ""),
}


def add(parser: ArgumentParser) -> None:
    """Declare the command's options."""
    parser.add_argument(
        "--robot",
        choices=tuple(DEMOS),
        default="simulated",
        help="simulated: a museum guide and a visitor; eyepi: a body with a face to be played by"
        " hand; show: two such bodies; guide: with engagement model, runs without a wizard;"
        " pepper: a simulated Pepper behind a real connection;"
        " study: a complete study, with a wizard who is blind to the conditions",
    )
    add_session(parser)
    add_keymap(parser)
    add_pictures(parser)
    add_theme(parser)


def run(arguments: Namespace) -> int:
    """Play a demo experiment that comes with woz-tui."""
    name, condition, participant = DEMOS[arguments.robot]
    experiment = demo_file(name)
    if experiment is None:
        print(f"woz: this installation lacks experiments/{name}", file=sys.stderr)
        return 1
    arguments.condition = arguments.condition or condition
    arguments.participant = arguments.participant or participant
    return run_command.play(arguments, experiment)


def demo_file(name: str = "demo.yaml") -> Path | None:
    """The experiment `name` of the installed package, or of the source tree it runs from."""
    package = Path(str(files("woz_tui")))
    candidates = (package / "_experiments" / name, package.parent / "experiments" / name)
    return next((path for path in candidates if path.exists()), None)
