"""`woz access`: who may join this user's sessions from another machine."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from datetime import UTC, datetime
from pathlib import Path

from rich.table import Table

from woz_tui.cli.argument_types import listen_address, number
from woz_tui.cli.error_sentences import CommandErrors
from woz_tui.console.drawing.text_console import TextConsole
from woz_tui.network.certificates import AccessError, Authority
from woz_tui.network.listen_address import DRIVERS_LISTEN, ListenAddress

ERRORS = CommandErrors(AccessError)
LONGEST_DAYS = 3650
#: Where the manual's sessions listen for other machines.
USUAL_PORT = 8765


def add(parser: ArgumentParser) -> None:
    """Declare the commands and their options."""
    commands = parser.add_subparsers(metavar="COMMAND", required=True)
    new = commands.add_parser("new", help="write an access file for somebody")
    new.add_argument("name", help="what the experiment and the log call them")
    new.add_argument(
        "--address",
        type=listen_address,
        default="",
        metavar="HOST:PORT",
        help="where they find the robot (written into the file; can be given later)",
    )
    new.add_argument(
        "--days",
        type=number(1, LONGEST_DAYS, "days", whole=True),
        default=365,
        help="how long it is valid (default 365)",
    )
    new.add_argument(
        "-o", "--output", type=Path, default=None, help="the file (default: NAME.access)"
    )
    new.set_defaults(command=_new)
    listed = commands.add_parser("list", help="list names, and until when they have access")
    listed.set_defaults(command=_list)
    revoke = commands.add_parser("revoke", help="take the access of a name away")
    revoke.add_argument("name")
    revoke.set_defaults(command=_revoke)


def run(arguments: Namespace) -> int:
    """Carry out the command that was chosen."""
    return int(arguments.command(arguments))


def _new(arguments: Namespace) -> int:
    target = arguments.output or Path(f"{arguments.name}.access")
    if target.exists():
        raise AccessError(f"{target} exists; choose another file with -o")
    issued = Authority().new(arguments.name, int(arguments.days), arguments.address, target)
    port = ListenAddress.read(arguments.address).port if arguments.address else USUAL_PORT
    where = "" if arguments.address else f" HOST:{port}"
    drivers = "" if arguments.address else f" HOST:{ListenAddress.read(DRIVERS_LISTEN).port}"
    print(
        f"{target}: gives {issued.name} access until {issued.expires[:10]}. Keep it secret.\n"
        f"1. Write the role into the experiment: session: {{access: {{{issued.name}: wizard}}}}\n"
        "   (or program, watcher, participant)\n"
        "2. Copy the file to the other machine in a safe way, such as scp.\n"
        f"3. Start here: woz run FILE --listen 0.0.0.0:{port}\n"
        f"   and there: woz attach --access {target.name}{where}\n"
        "   (a program or watcher adds --watch, a participant --questionnaire)\n"
        f"For a computer that has drivers of the robot: `at: {issued.name}` in the robot file,\n"
        f"   there: woz drivers --serve ROBOT_FILE --access {target.name}{drivers}"
    )
    return 0


def _list(_: Namespace) -> int:
    names = Authority().names()
    if not names:
        print("Nobody has access from another machine; `woz access new NAME` gives it.")
        return 0
    now = datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
    table = Table("name", "since", "until", "", box=None, pad_edge=False)
    for each in names:
        state = "revoked" if each.revoked else "expired" if each.expires < now else ""
        table.add_row(each.name, each.made[:10], each.expires[:10], state)
    TextConsole().print(table)
    return 0


def _revoke(arguments: Namespace) -> int:
    authority = Authority()
    if not authority.revoke(arguments.name):
        known = any(each.name == arguments.name for each in authority.names())
        why = "has no access any more" if known else "was never given access"
        raise AccessError(f"{arguments.name} {why}; see `woz access list`")
    print(f"{arguments.name} has no access any more; whoever is connected so is cut off.")
    return 0
