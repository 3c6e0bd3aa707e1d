"""`woz attach`: join a session that is running."""

from __future__ import annotations

import shlex
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Callable
from pathlib import Path
from pkgutil import resolve_name

from woz_tui.cli import console_start
from woz_tui.cli.session_choice import add_session_choice, find_session
from woz_tui.cli.shared_options import (
    add_keymap,
    add_language,
    add_part,
    add_pictures,
    add_theme,
    builtins,
    part_again,
)
from woz_tui.console.link.message_feed import Loss
from woz_tui.feature import ParticipantScreen, features
from woz_tui.system import session_sockets


def add(parser: ArgumentParser) -> None:
    add_session_choice(parser)
    parser.add_argument("--watch", action="store_true", help="watch only")
    parser.add_argument(
        "--take-over",
        action="store_true",
        help="take over: play the robot even if another console plays it",
    )
    add_part(parser)
    for screen in _screens():
        parser.add_argument(
            screen.flag, nargs="?", const="", default=None, metavar="NAME", help=screen.help
        )
    add_keymap(parser)
    add_pictures(parser)
    add_theme(parser)
    add_language(parser)


def run(arguments: Namespace) -> int:
    """Open the console on a running session."""
    given = _of_wizards(arguments) if _screen(arguments) is not None else ""
    if given:
        print(f"woz: a participant plays no robot: leave {given} out", file=sys.stderr)
        return 2
    if console_start.lacks_terminal():
        return 2
    if arguments.access is not None:
        from woz_tui.cli.remote_start import remote_session  # noqa: PLC0415 - few come from afar

        with remote_session(arguments.access, arguments.name) as line:
            if line is None or line.socket is None:
                return 1
            return _open(arguments, line.socket, line.explained)
    socket = find_socket(arguments)
    return 1 if socket is None else _open(arguments, socket)


def _screens() -> dict[ParticipantScreen, str]:
    """Screens for participants, and the class of each."""
    return {
        each.screen: f"{type(each).__module__}.{each.screen.app}"
        for each in features().values()
        if each.screen is not None
    }


def _screen(arguments: Namespace) -> ParticipantScreen | None:
    """The one that is wanted; None: a console."""
    wanted = (each for each in _screens() if getattr(arguments, each.dest) is not None)
    return next(wanted, None)


def _of_wizards(arguments: Namespace) -> str:
    """The options that were given and mean nothing at a participant's terminal."""
    alien = {
        "--watch": arguments.watch,
        "--take-over": arguments.take_over,
        "--as": arguments.part,
        "--keymap": arguments.keymap,
        "--pictures": arguments.pictures != "auto",
    }
    return ", ".join(name for name, value in alien.items() if value)


def _open(arguments: Namespace, socket: Path, explain: Callable[[Loss], Loss] | None = None) -> int:
    if (screen := _screen(arguments)) is not None:
        only = getattr(arguments, screen.dest)
        app = resolve_name(_screens()[screen])
        return console_start.open_participant(app, socket, only, arguments.theme, explain)[1]
    closed = console_start.open_console(
        console_start.ScreenOptions(
            socket=socket,
            watch=arguments.watch,
            take_over=arguments.take_over,
            builtins=builtins(arguments),
            pictures=arguments.pictures,
            theme=arguments.theme,
            language=arguments.language,
            part=arguments.part,
            explain=explain,
        )
    )
    here = Path(closed.log) if closed.log and arguments.access is None else None
    log = here if closed.left == "ended" else None  # while it goes on it is somebody else's
    access = f" --access {shlex.quote(str(arguments.access))}" if arguments.access else ""
    name = f" {shlex.quote(arguments.name)}" if arguments.name else ""
    again = f"attach{access}{name}{_repeated_options(arguments)}"
    if lines := console_start.farewell(closed, again, log):
        print("\n".join(lines))
    return closed.code


def find_socket(arguments: Namespace) -> Path | None:
    """The socket of the chosen session, or None after printing why there is none."""
    _sort_names(arguments)
    options = _repeated_options(arguments) + " --take-over" * arguments.take_over
    return find_session(arguments.name, "woz attach", options)


def _sort_names(arguments: Namespace) -> None:
    """In `--questionnaire S02` the word is meant as the session, if one of this name runs."""
    if (screen := _screen(arguments)) is None:
        return
    word = getattr(arguments, screen.dest)
    if word and not arguments.name and word in {path.stem for path in session_sockets.running()}:
        arguments.name = word
        vars(arguments)[screen.dest] = ""


def _repeated_options(arguments: Namespace) -> str:
    """The options that a proposal has to repeat: a participant must get no wizard's console."""
    if (screen := _screen(arguments)) is not None:
        return f" {screen.flag} {getattr(arguments, screen.dest)}".rstrip()
    return f"{' --watch' * arguments.watch}{part_again(arguments)}"
