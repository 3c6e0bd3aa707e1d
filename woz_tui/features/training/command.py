"""`woz train EXPERIMENT`: cues by a simulated visitor, the wizard's answers, and a score."""

from __future__ import annotations

import random
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Sequence
from pathlib import Path

from rich.table import Table

from woz_tui.cli import console_start
from woz_tui.cli.argument_types import number
from woz_tui.cli.console_start import ScreenOptions, run_session
from woz_tui.cli.shared_options import add_keymap, add_robot, add_theme, builtins
from woz_tui.cli.wizard_code import remembered_wizard, wizard_code
from woz_tui.console.drawing.text_console import TextConsole
from woz_tui.console.link.host_start import host_arguments
from woz_tui.features.training.score_history import TrainingScore, history, score_of
from woz_tui.sensing.sample_values import percent
from woz_tui.session.participant_identity import check_code

#: Beside the recordings of sessions with participants, never among them.
FOLDER = Path("recordings/training")


def add(parser: ArgumentParser) -> None:
    parser.add_argument("experiment", type=Path, nargs="?", help="experiment file")
    parser.add_argument(
        "--wizard", default="", help="code of the wizard, for the scores (default: as given last)"
    )
    parser.add_argument(
        "--count",
        type=number(1, 1000, whole=True),
        default=None,
        metavar="N",
        help="number of cues (default: from the file, or 20)",
    )
    parser.add_argument(
        "--seed", type=int, default=0, help="repeat the same cues (default: other cues each time)"
    )
    parser.add_argument(
        "--recordings", type=Path, default=FOLDER, help=f"folder of the logs (default: {FOLDER})"
    )
    parser.add_argument(
        "--history",
        action="store_true",
        help="only show the scores so far, of --wizard or of all wizards",
    )
    parser.add_argument("--name", default="", help="name of the socket (default: the session code)")
    add_robot(parser)
    add_keymap(parser)
    add_theme(parser)


def run(arguments: Namespace) -> int:
    """Train, or show the scores."""
    if arguments.history:
        return _history(arguments)
    arguments.wizard = arguments.wizard or remembered_wizard() or ""
    refusal = _refusal(arguments)
    if refusal:
        print(f"woz: {refusal}", file=sys.stderr)
        return 2
    return _train(arguments)


def _refusal(arguments: Namespace) -> str:
    """Why no training can begin; empty if one can."""
    if arguments.experiment is None:
        return "name an experiment file: woz train EXPERIMENT --wizard W1"
    if not arguments.wizard:
        return "name the wizard's code: --wizard W1 (no names)"
    return console_start.terminal_problem()


def _history(arguments: Namespace) -> int:
    scores = history(arguments.recordings, arguments.wizard)
    if not scores:
        whose = f" of {arguments.wizard}" if arguments.wizard else ""
        print(f"woz: no training{whose} in {arguments.recordings}", file=sys.stderr)
        return 1
    _print(scores)
    return 0


def _train(arguments: Namespace) -> int:
    check_code(arguments.wizard, "wizard")
    wizard_code(arguments.wizard)
    own_keys = builtins(arguments)
    result = run_session(
        _host_command(arguments),
        lambda robot: ScreenOptions(socket=robot.socket, builtins=own_keys, theme=arguments.theme),
    )
    if result is None:
        return 1
    if result.left != "ended":
        result.launch.abandon()  # nobody comes back to a training
    _print_result(arguments, result.robot.log)
    return result.code


def _host_command(arguments: Namespace) -> list[str]:
    words = host_arguments(
        arguments.experiment,
        recordings=arguments.recordings,
        spill=None,
        name=arguments.name,
        codes={
            "wizard": arguments.wizard,
            "seed": str(arguments.seed or random.SystemRandom().randrange(1, 1 << 31)),
        },
        robot=arguments.robot,
    )
    words.append("--train")
    if arguments.count is not None:
        words += ["--train-count", str(arguments.count)]
    return words


def _print_result(arguments: Namespace, log: Path) -> None:
    score = score_of(log)
    if score is None:
        print(f"No cue was given. Log: {log}")
        return
    _print(history(arguments.recordings, arguments.wizard) or [score])
    print(f"Log: {log}")


#: Cells of a row without the experiment's title.
_FIGURES = 73
_COUNTS = ("cues", "right", "wrong", "missed", "uncalled")


def _print(scores: Sequence[TrainingScore]) -> None:
    console = TextConsole()
    table = Table(box=None, pad_edge=False, padding=(0, 1, 0, 0), header_style="bold")
    table.add_column("wizard", no_wrap=True, min_width=6)
    table.add_column("day (UTC)", no_wrap=True, min_width=10)
    room = max(3, console.width - _FIGURES)
    table.add_column("experiment", no_wrap=True, overflow="ellipsis", max_width=room)
    for name in (*_COUNTS, "score", "median", "p95"):
        table.add_column(name, justify="right", no_wrap=True, min_width=len(name))
    for score in scores:
        table.add_row(*_row(score))
    console.print(table)


def _row(score: TrainingScore) -> tuple[str, ...]:
    training = score.training
    return (
        score.wizard or "-",
        score.started[:10],
        score.title,
        *(str(getattr(training, name)) for name in _COUNTS),
        "-" if training.score is None else percent(training.score),
        _seconds(training.times.median),
        _seconds(training.times.p95),
    )


def _seconds(microseconds: float | None) -> str:
    return "-" if microseconds is None else f"{microseconds / 1_000_000:.2f}s"
