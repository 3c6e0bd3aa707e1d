"""`woz demo`: a session with a robot that needs no hardware."""

from __future__ import annotations

import os
import sys
from argparse import ArgumentParser, Namespace

from woz_tui.cli import run as run_command
from woz_tui.cli.shared_options import (
    add_keymap,
    add_language,
    add_part,
    add_pictures,
    add_session,
    add_theme,
)
from woz_tui.config.bundled_files import bundled_file, robot_files

#: Robots that can be shown: their experiment, and the condition and participant it begins with.
DEMOS: dict[str, tuple[str, str, str]] = {
    "simulated": ("demo.yaml", "warm", "P01"),
    "eyepi": ("eyepi.yaml", "default", "P01"),
    "show": ("show.yaml", "", "S1"),
    "guide": ("guide.yaml", "alone", "G01"),
    "pepper": ("pepper.yaml", "lively", "P01"),
    "study": ("study.yaml", "", ""),
    "all": ("all-robots.yaml", "", "G1"),
}


DEFAULT = "simulated"
#: A variable of the environment that is as good as `--silent`: for tests.
SILENT = "WOZ_SILENT"
#: With which robot the demo of the engagement model is played with `--camera` and `--microphone`.
REAL = {
    (True, False): "simulated-camera",
    (False, True): "simulated-microphone",
    (True, True): "simulated-camera-microphone",
}
WITH_REAL = "guide"
#: What else a robot is called by.
NAMES = {"ros": "turtlebot"}


def add(parser: ArgumentParser) -> None:
    parser.add_argument(
        "--robot",
        default=DEFAULT,
        metavar="NAME",
        help="simulated: a museum guide and a visitor; eyepi: a body with a face to be played by"
        " hand; show: two such bodies; guide: with engagement model, runs without a wizard;"
        " pepper: a simulated Pepper behind a real connection;"
        " study: a complete study, with a wizard who is blind to the conditions;"
        " all: five robots and one wizard;"
        f" the museum guide on another robot: {', '.join(other_robots())}",
    )
    parser.add_argument(
        "--camera",
        action="store_true",
        help="with --robot guide: the visitor is you, before the camera /dev/video0"
        " (needs the extra `faces`: docs/how-to/faces.md)",
    )
    parser.add_argument(
        "--microphone",
        action="store_true",
        help="with --robot guide: it hears you, by the machine's microphone (needs arecord;"
        " docs/how-to/faces.md); without --camera your keys tell what it would see",
    )
    parser.add_argument(
        "--silent",
        action="store_true",
        help="no sound; without it what the robot says is heard here, by espeak-ng or Piper",
    )
    add_session(parser)
    add_part(parser)
    add_keymap(parser)
    add_pictures(parser)
    add_theme(parser)
    add_language(parser)


def other_robots() -> list[str]:
    """What robots are called that come with woz-tui and have no demo of their own."""
    return [*(name for name in robot_files(None) if name not in DEMOS), *NAMES]


def run(arguments: Namespace) -> int:
    """Play a demo experiment that comes with woz-tui."""
    wanted: str = NAMES.get(arguments.robot, arguments.robot)
    other = other_robots()
    real = REAL.get((arguments.camera, arguments.microphone), "")
    if real and wanted not in (WITH_REAL, DEFAULT):
        option = "--camera" if arguments.camera else "--microphone"
        print(f"woz: {option} is for --robot {WITH_REAL}", file=sys.stderr)
        return 2
    if wanted not in DEMOS and wanted not in other:
        from woz_tui.config.problems import hint  # noqa: PLC0415 - only for this sentence

        near = hint(wanted, [*DEMOS, *other]) or f"; there are {', '.join([*DEMOS, *other])}"
        print(f"woz: there is no demo of the robot {wanted!r}{near}", file=sys.stderr)
        return 2
    if real:
        wanted = WITH_REAL
    name, condition, participant = DEMOS.get(wanted, DEMOS[DEFAULT])
    experiment = bundled_file(name)
    if experiment is None:
        print(f"woz: this installation lacks experiments/{name}", file=sys.stderr)
        return 1
    arguments.condition = arguments.condition or condition
    arguments.participant = arguments.participant or participant
    robot = real or ("" if wanted in DEMOS else wanted)
    aloud = not (arguments.silent or os.environ.get(SILENT))
    shown = run_command.Shown(aloud, fitted=bool(robot) and not real)
    return run_command.play(arguments, experiment, robot, shown)
