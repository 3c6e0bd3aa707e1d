"""`woz replay FILE`: a session again, on the screen or on the robot."""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

from woz_tui.cli import console_start
from woz_tui.cli.argument_types import number
from woz_tui.cli.console_start import detect_appearance
from woz_tui.cli.experiment_changes import change_lines, error_lines
from woz_tui.cli.shared_options import add_keymap, add_language, add_theme
from woz_tui.config.bundled_files import bundled_file
from woz_tui.config.experiment import Experiment
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.keys.terminals import detect_terminal
from woz_tui.config.loading import load
from woz_tui.config.screen_language import choose
from woz_tui.drivers.plugins import Catalogue, installed
from woz_tui.host.experiment_view import ExperimentView, plan_of
from woz_tui.log.coding_file import Coding, CodingError, coding_path
from woz_tui.log.file_names import check_code
from woz_tui.log.log_index import LogIndex
from woz_tui.log.log_reader import files_of
from woz_tui.protocol.messages import SessionPlan
from woz_tui.replay import experiment_origin
from woz_tui.replay.experiment_origin import ExperimentOrigin, origin_of
from woz_tui.replay.opened_log import (
    IndexedSamples,
    LogError,
    has_beginning,
    log_in,
    notes_of,
    open_log,
)
from woz_tui.replay.player import FASTEST, SLOWEST, ReplayPlayer, ReplayStart
from woz_tui.replay.recording import Recording
from woz_tui.replay.replay_feed import ReplayFeed
from woz_tui.replay.seek import ReplayError, seek_time


def add(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "file", type=Path, metavar="FILE", help="a session's log, or a folder: its newest session"
    )
    screen = parser.add_argument_group("on the screen")
    screen.add_argument(
        "--at", default="", metavar="TIME", help="start at a time (12:34) or at a marker (its text)"
    )
    screen.add_argument("--speed", type=_speed, default=1.0, metavar="N", help="speed, 0.25 to 16")
    screen.add_argument(
        "--max-idle",
        type=_seconds,
        default=None,
        metavar="SECONDS",
        help="shorten pauses without events to this length",
    )
    screen.add_argument(
        "--coder",
        type=_coder,
        default=None,
        metavar="CODE",
        help="code the session: m and n set codes and notes; the condition is hidden",
    )
    screen.add_argument("--paused", action="store_true", help="start paused")
    robot = parser.add_argument_group("on the robot")
    add_keymap(parser)
    add_theme(parser)
    add_language(parser)
    robot.add_argument("--robot", action="store_true", help="send its commands to the robot again")
    robot.add_argument(
        "--dry-run", action="store_true", help="show and check what --robot would do"
    )
    robot.add_argument(
        "--yes", action="store_true", help="with --robot: do not ask for confirmation"
    )
    robot.add_argument("--headless", action="store_true", help="with --robot: without a console")
    parser.add_argument(
        "--reveal",
        action="store_true",
        help="show also what was hidden from the wizard: conditions, meters",
    )
    parser.add_argument(
        "--changed",
        action="store_true",
        help="also if the experiment has changed since the session",
    )
    parser.add_argument(
        "--experiment",
        type=Path,
        default=None,
        metavar="FILE",
        help="path of its experiment file now",
    )


def _speed(text: str) -> float:
    return number(SLOWEST, FASTEST)(text.lower().removesuffix("x"))


def _seconds(text: str) -> float:
    seconds = number(0.0, 1e6, "s")(text)
    if not seconds:
        raise argparse.ArgumentTypeError("give seconds, above 0")
    return seconds


def _coder(text: str) -> str:
    try:
        return check_code("coder", text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def run(arguments: argparse.Namespace) -> int:
    """Replay it; the exit code."""
    wrong = _mixed(arguments)
    if wrong:
        print(f"woz: {wrong}", file=sys.stderr)
        return 2
    choose(arguments.language)
    if arguments.robot or arguments.dry_run:
        from woz_tui.cli import rerun  # noqa: PLC0415

        return rerun.play(arguments)
    if console_start.lacks_terminal():
        return 2
    try:
        path = log_in(arguments.file)
        with open_log(path) as index:
            feed = replay_feed(index, path, arguments)
            if feed is None:
                return 1
            from woz_tui.console.replay.app import ReplayConsole  # noqa: PLC0415
            from woz_tui.console.replay.commands import ReplayKeyboard  # noqa: PLC0415
            from woz_tui.console.wizard_terminal import WizardDriver  # noqa: PLC0415

            console = ReplayConsole(
                feed,
                ReplayKeyboard(feed),
                look=detect_appearance(arguments.theme)[0],
                terminal=detect_terminal(os.environ),
                driver_class=WizardDriver,
            )
            _, code = console_start.run_console(console)
            feed.close()
            return code
    except (LogError, ReplayError, CodingError) as error:
        print(f"woz: {error}", file=sys.stderr)
        return 1


def _mixed(arguments: argparse.Namespace) -> str:
    """Which options do not go together; empty: all do."""
    again = {"--robot": arguments.robot, "--dry-run": arguments.dry_run}
    if arguments.coder:
        why, alien = "--coder hides the condition", {"--reveal": arguments.reveal, **again}
    elif any(again.values()):
        why = "the robot is sent the whole session at its own speed"
        alien = {
            "--at": arguments.at,
            "--paused": arguments.paused,
            "--speed": arguments.speed != 1.0,
            "--max-idle": arguments.max_idle,
            "--keymap": arguments.keymap and (arguments.dry_run or arguments.headless),
        }
    else:
        why = "a replay on the screen has keys of its own and does not move the robot"
        alien = {
            "--yes": arguments.yes,
            "--headless": arguments.headless,
            "--keymap": arguments.keymap,
        }
    given = ", ".join(name for name, value in alien.items() if value)
    return f"{why}: leave {given} out" if given else ""


def replay_feed(index: LogIndex, path: Path, arguments: argparse.Namespace) -> ReplayFeed | None:
    """The feed that plays the log; None after printing why it cannot be shown."""
    if not has_beginning(index) and not arguments.changed:
        print(
            f"woz: {path}: the log has no beginning: its first line, session.start, is missing\n"
            "     put its first segment into the same folder; use --changed to show the rest",
            file=sys.stderr,
        )
        return None
    plan, objections = _experiment(index, path, arguments)
    if objections and not arguments.changed:
        print(
            *objections,
            "woz: use --changed to show the log nevertheless",
            sep="\n",
            file=sys.stderr,
        )
        return None
    coder = arguments.coder
    recording = Recording(
        *(index.actions, IndexedSamples(index), plan), reveal=arguments.reveal, coded=bool(coder)
    )
    coding = Coding(coding_path(files_of(path).paths[0]), coder, recording.start) if coder else None
    start = ReplayStart(
        speed=arguments.speed,
        at_us=seek_time(arguments.at, recording, 0) if arguments.at.strip() else 0,
        paused=arguments.paused,
        max_idle_us=arguments.max_idle and round(arguments.max_idle * 1_000_000),
    )
    return ReplayFeed(ReplayPlayer(recording, start, str(path), notes_of(index, recording), coding))


def _experiment(
    index: LogIndex, path: Path, arguments: argparse.Namespace
) -> tuple[SessionPlan | None, list[str]]:
    """What the experiment shows, for a log that does not contain it, and what has changed in it.

    A missing experiment is no objection: the log has what is needed.
    """
    origin = origin_of(index.actions)
    catalogue = installed()
    try:
        experiment = experiment_origin.find_experiment(
            path, origin, catalogue, arguments.experiment
        )
    except experiment_origin.OriginError:
        return _bundled_plan(origin, catalogue), []
    except ExperimentError as error:
        return None, [
            *error_lines(origin, error, reveal=arguments.reveal),
            f"woz: {origin.name} has errors now, so it is not the version of the session",
        ]
    objections = change_lines(origin, experiment, reveal=arguments.reveal)
    return (None, objections) if objections else (_plan(experiment), [])


def _bundled_plan(origin: ExperimentOrigin, catalogue: Catalogue) -> SessionPlan | None:
    """The plan of the bundled experiment of this name, if it has not changed."""
    file = bundled_file(Path(origin.name).name) if origin.name else None
    if file is None:
        return None
    try:
        experiment = load(file, catalogue, robot=origin.robot)
    except ExperimentError:
        return None
    return _plan(experiment) if origin.made_with(experiment) else None


def _plan(experiment: Experiment) -> SessionPlan:
    return plan_of(ExperimentView(experiment, values=dict(experiment.variables)))
