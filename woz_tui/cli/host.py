"""`woz host FILE`: the robot process alone; consoles attach to it."""

from __future__ import annotations

import logging
import sys
from argparse import SUPPRESS, ArgumentParser, Namespace
from collections.abc import Iterable
from pathlib import Path

from woz_tui.cli.argument_types import number
from woz_tui.cli.shared_options import add_language, add_robot, add_session, start_values
from woz_tui.feature import pieces
from woz_tui.host.session_kind import SessionKind
from woz_tui.protocol.refusal import RequestError
from woz_tui.session.participant_identity import SessionIdentity
from woz_tui.system.addresses import without_passwords

LONGEST_WAIT_S = 3600.0


#: How long a re-run waits for its drivers, unless somebody says otherwise, in seconds.
RERUN_WAIT_S = 20.0


def add(parser: ArgumentParser) -> None:
    parser.add_argument("experiment", type=Path, help="experiment file")
    add_robot(parser)
    add_session(parser)
    add_language(parser)
    parser.add_argument(
        "--rerun",
        type=Path,
        default=None,
        metavar="LOG",
        help="run the commands of this log again, once a wizard is attached (see `woz replay`)",
    )
    parser.add_argument(
        "--headless",
        action="store_true",
        help="with --rerun: run without a wizard; the session ends with the re-run",
    )
    parser.add_argument(
        "--rerun-wait",
        type=number(0, LONGEST_WAIT_S, "s"),
        default=None,
        metavar="SECONDS",
        help="with --rerun: longest time in s for the drivers to connect"
        f" (default {RERUN_WAIT_S:g})",
    )
    for kind in pieces("session_kind", SessionKind).values():
        kind.add(parser)
    parser.add_argument(
        "--fitted",
        action="store_true",
        help="without actions of which the robot of --robot does nothing: for demos",
    )
    parser.add_argument("--announce", action="store_true", help=SUPPRESS)
    parser.add_argument("--restarted", action="store_true", help=SUPPRESS)


def _mixed(arguments: Namespace, kinds: Iterable[str]) -> str:
    """Which options do not go together; empty: all do. `kinds`: features whose kind is wanted."""
    flags = [pieces("session_kind", SessionKind)[name].flag for name in kinds]
    wanted = ["--rerun"] * (arguments.rerun is not None) + flags
    if len(wanted) > 1:
        return f"{' and '.join(wanted)}: leave one out"
    if arguments.rerun is None and (arguments.headless or arguments.rerun_wait is not None):
        return f"{'--headless' if arguments.headless else '--rerun-wait'} needs --rerun"
    return ""


class _LogFormatter(logging.Formatter):
    """Leaves passwords in addresses out, which an error's traceback may repeat."""

    def format(self, record: logging.LogRecord) -> str:
        """The text of one line, or several."""
        return without_passwords(super().format(record))


def run(arguments: Namespace) -> int:
    """Serve until the session ends."""
    try:
        kinds = {
            name: value
            for name, kind in pieces("session_kind", SessionKind).items()
            if (value := kind.start(arguments)) is not None
        }
        wrong = _mixed(arguments, kinds)
    except RequestError as error:
        wrong = str(error)
    if wrong:
        print(f"woz: {wrong}", file=sys.stderr)
        return 2
    from woz_tui.host import robot_process  # noqa: PLC0415 - only this command needs it

    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(_LogFormatter("%(asctime)s %(name)s %(message)s"))
    logging.basicConfig(level=logging.INFO, handlers=[handler])

    rerun = None
    if arguments.rerun is not None:
        from woz_tui.host.rerun_session import RerunOptions  # noqa: PLC0415

        wait = RERUN_WAIT_S if arguments.rerun_wait is None else arguments.rerun_wait
        rerun = RerunOptions(arguments.rerun, arguments.headless, wait)
    return robot_process.run(
        robot_process.HostOptions(
            experiment=arguments.experiment,
            identity=SessionIdentity(
                session=arguments.session,
                participant=arguments.participant,
                condition=arguments.condition,
                wizard=arguments.wizard,
                seed=arguments.seed,
            ),
            name=arguments.name,
            recordings=arguments.recordings,
            spill=arguments.spill,
            announce=arguments.announce,
            restarted=arguments.restarted,
            starts={**start_values(arguments), **kinds},
            kind=next(iter(kinds), ""),
            rerun=rerun,
            robot=arguments.robot,
            fitted=arguments.fitted,
            listen=arguments.listen,
        )
    )
