"""`woz attach`: join a session that is running."""

from __future__ import annotations

import shlex
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Callable
from pathlib import Path

from woz_tui.cli import console_start
from woz_tui.cli.shared_options import add_keymap, add_part, add_pictures, add_theme, builtins
from woz_tui.console.message_feed import Loss
from woz_tui.system import session_sockets


def add(parser: ArgumentParser) -> None:
    """Declare the command's options."""
    parser.add_argument(
        "name", nargs="?", default="", help="session code or socket (default: the only one)"
    )
    parser.add_argument(
        "--access",
        type=Path,
        default=None,
        metavar="FILE",
        help="join a session on another machine with this access file (see `woz access`); the name"
        " is then the machine's HOST:PORT",
    )
    parser.add_argument("--watch", action="store_true", help="watch only")
    parser.add_argument(
        "--take-over",
        action="store_true",
        help="take over: play the robot even if another console plays it",
    )
    add_part(parser)
    parser.add_argument(
        "--questionnaire",
        nargs="?",
        const="",
        default=None,
        metavar="NAME",
        help="show only the questionnaires (or this one), for the participant's terminal",
    )
    add_keymap(parser)
    add_pictures(parser)
    add_theme(parser)


def run(arguments: Namespace) -> int:
    """Open the console on a running session."""
    return console_start.with_terminal(lambda: _attach(arguments))


def _attach(arguments: Namespace) -> int:
    if arguments.access is not None:
        from woz_tui.cli.remote_start import remote_session  # noqa: PLC0415 - few come from afar

        with remote_session(arguments.access, arguments.name) as line:
            if line is None or line.socket is None:
                return 1
            return _open(arguments, line.socket, line.explained)
    socket = find_socket(arguments)
    return 1 if socket is None else _open(arguments, socket)


def _open(
    arguments: Namespace, socket: Path, explain: Callable[[Loss], Loss] = lambda loss: loss
) -> int:
    if arguments.questionnaire is not None:
        return console_start.open_questionnaire(
            socket, arguments.questionnaire, arguments.theme, explain
        )[1]
    left, code = console_start.open_console(
        console_start.ScreenOptions(
            socket=socket,
            watch=arguments.watch,
            take_over=arguments.take_over,
            builtins=builtins(arguments),
            pictures=arguments.pictures,
            theme=arguments.theme,
            part=arguments.part,
            explain=explain,
        )
    )
    if left == "detached":
        print("The session continues; join it again with `woz attach`.")
    return code


def find_socket(arguments: Namespace) -> Path | None:
    """The socket of the chosen session, or None after printing why there is none."""
    _sort_names(arguments)
    return _find(arguments.name, _repeated_options(arguments))


def _sort_names(arguments: Namespace) -> None:
    """In `--questionnaire S02` the word is meant as the session, if one of this name runs."""
    word = arguments.questionnaire
    if word and not arguments.name and word in {path.stem for path in session_sockets.running()}:
        arguments.name, arguments.questionnaire = word, ""


def _repeated_options(arguments: Namespace) -> str:
    """The options that a proposal has to repeat: a participant must get no wizard's console."""
    if arguments.questionnaire is not None:
        return f" --questionnaire {arguments.questionnaire}".rstrip()
    part = f" --as {shlex.quote(arguments.part)}" if arguments.part else ""
    return f"{' --watch' * arguments.watch}{' --take-over' * arguments.take_over}{part}"


def find_session(name: str, command: str) -> Path | None:
    """The socket of the session `name`, or of the only one; None after printing why there is none.
    `command` is what is proposed to be typed with a name.
    """
    return _find(name, "", command)


def _find(name: str, options: str, command: str = "woz attach") -> Path | None:
    if name:
        socket = Path(name) if "/" in name else session_sockets.socket_path(name)
        if session_sockets.answers(socket):
            return socket
        print(f"woz: no session is running at {socket}", file=sys.stderr)
    running = session_sockets.running()
    if not name and len(running) == 1:
        return running[0]
    if running:
        names = "\n".join(
            f"  {command} {path.stem}{options}   # for {session_sockets.age_s(path) // 60:.0f} min"
            for path in running
        )
        print(f"woz: which session?\n{names}", file=sys.stderr)
    elif not name:
        print("woz: no session is running; start one with `woz run FILE`", file=sys.stderr)
    return None
