"""`woz visitors`: lists, changes and deletes the data kept about named visitors."""

from __future__ import annotations

import sys
from argparse import SUPPRESS, ArgumentParser, Namespace
from collections.abc import Callable
from pathlib import Path

from rich.table import Table
from rich.text import Text

from woz_tui.cli.safe_streams import json_text
from woz_tui.console.drawing.text_console import TextConsole
from woz_tui.drivers.contract import DriverError
from woz_tui.drivers.face_store import FaceStore, default_path
from woz_tui.protocol.messages import Json
from woz_tui.sensing.visitor_keeping import Forgetting, as_json, renamed, visitor_named
from woz_tui.sensing.visitor_store import (
    UnsavedError,
    Visitor,
    VisitorRefusedError,
    VisitorsError,
    VisitorStore,
    store_at,
)

#: Columns of a page that goes into a file or a pipe.
_PAGE = 120
_Command = Callable[[VisitorStore, Namespace], int]


def add(parser: ArgumentParser) -> None:
    """Declare the command's options. Without a command it lists everybody."""
    _add_store_options(parser)
    parser.set_defaults(command=_list, recordings=Path("recordings"))
    # A default after the command would take the place of what was given before it.
    store_options = ArgumentParser(add_help=False, argument_default=SUPPRESS)
    _add_store_options(store_options)
    commands = parser.add_subparsers(title="commands", metavar="COMMAND")

    def add_command(name: str, summary: str, command: _Command) -> ArgumentParser:
        parser = commands.add_parser(
            name, help=summary, description=summary, parents=[store_options]
        )
        parser.set_defaults(command=command)
        return parser

    add_command("list", "list all named visitors", _list)
    show = add_command("show", "show all stored data of a visitor", _show)
    show.add_argument("name", help="name or face label, in any letter case")
    new = add_command("add", "add a visitor before the first meeting", _add)
    new.add_argument("name", help="a code or a name")
    rename = add_command("rename", "give a visitor another name", _rename)
    rename.add_argument("name", help="present name")
    rename.add_argument("new", help="new name")
    profile = add_command("profile", 'change the data of a visitor; "" removes a value', _profile)
    profile.add_argument("name")
    for editor in (new, profile):
        editor.add_argument("--age-group", metavar="TEXT", help="for example child, adult")
        editor.add_argument("--address", metavar="TEXT", help="form of address, for example Ms")
        editor.add_argument("--label", metavar="TEXT", help="label of the face in the recogniser")
    forget = add_command("forget", "delete all stored data of visitors", _forget)
    forget.add_argument("name", nargs="*", help="visitors to delete")
    forget.add_argument("--all", action="store_true", help="everybody")
    forget.add_argument("--yes", action="store_true", help="do not ask for confirmation")


def _add_store_options(parser: ArgumentParser) -> None:
    """Options that stand before or after the command."""
    where = parser.add_argument_group("choose the store")
    file = where.add_mutually_exclusive_group()
    file.add_argument("--file", type=Path, metavar="FILE", help="path of the store")
    file.add_argument("--experiment", type=Path, metavar="FILE", help="store of this experiment")
    where.add_argument(
        "--recordings",
        type=Path,
        metavar="FOLDER",
        help="folder of the logs, which has the store by default (default: recordings)",
    )
    parser.add_argument("--json", action="store_true", help="one object, for programs")


def run(arguments: Namespace) -> int:
    """Do what the command says."""
    try:
        command: _Command = arguments.command
        return command(VisitorStore(_path(arguments)), arguments)
    except DriverError as error:
        print(f"woz visitors: {error.what}\n{error.remedy}", file=sys.stderr)
        return 1
    except VisitorsError as error:
        # What could not be written is gone when this process ends.
        unchanged = "\nnothing was changed" if isinstance(error, UnsavedError) else ""
        print(f"woz visitors: {error.reason}\n{error.remedy}{unchanged}", file=sys.stderr)
        return 1


def _path(arguments: Namespace) -> Path:
    if arguments.file is not None:
        file: Path = arguments.file
        return file
    named = ""
    if arguments.experiment is not None:
        # Drivers are needed to read an experiment, and for nothing else here.
        from woz_tui.config.loading import load  # noqa: PLC0415
        from woz_tui.drivers import plugins  # noqa: PLC0415

        engagement = load(arguments.experiment, plugins.installed()).engagement
        named = engagement.settings.visitors if engagement is not None else ""
    return store_at(named, arguments.recordings)


# -- the commands -------------------------------------------------------------------------------


def _list(store: VisitorStore, arguments: Namespace) -> int:
    everybody = store.everybody()
    faces = [one.name for one in FaceStore(default_path()).faces()]
    if arguments.json:
        visitors: list[Json] = [as_json(visitor) for visitor in everybody]
        kept: list[Json] = [*faces]
        _print(arguments, {"file": str(store.path), "visitors": visitors, "faces": kept}, "")
    elif everybody:
        table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
        table.add_column("name", overflow="fold", style="bold")
        for fact, _ in _facts(everybody[0]):
            number = fact == "meetings"
            table.add_column(fact, overflow="fold", justify="right" if number else "left")
        for visitor in everybody:
            table.add_row(Text(visitor.name), *(Text(value) for _, value in _facts(visitor)))
        TextConsole(page=_PAGE).print(table)
    else:
        missing = "" if store.path.exists() else " (the file does not exist yet)"
        print(f"{store.path}: nobody{missing}")
    if faces and not arguments.json:
        print(f"faces that are recognised on this machine: {', '.join(faces)}")
    return 0


def _show(store: VisitorStore, arguments: Namespace) -> int:
    _print_visitor(store.called(arguments.name) or visitor_named(store, arguments.name), arguments)
    return 0


def _add(store: VisitorStore, arguments: Namespace) -> int:
    visitor = store.add(
        arguments.name,
        on=None,
        age_group=arguments.age_group or "",
        address=arguments.address or "",
        label=arguments.label or "",
    )
    _print_visitor(visitor, arguments)
    return 0


def _rename(store: VisitorStore, arguments: Namespace) -> int:
    before = visitor_named(store, arguments.name)
    after = renamed(store, FaceStore(default_path()), before, arguments.new)
    _print(arguments, {**as_json(after), "was": before.name}, f"{before.name} is now {after.name}")
    return 0


def _profile(store: VisitorStore, arguments: Namespace) -> int:
    given = (arguments.age_group, arguments.address, arguments.label)
    if given == (None, None, None):
        raise VisitorRefusedError("nothing to change", "give --age-group, --address or --label")
    before = visitor_named(store, arguments.name)
    after = store.profile(
        before.name,
        age_group=arguments.age_group,
        address=arguments.address,
        label=arguments.label,
        anew=True,
    )
    old = dict(_facts(before))
    changes = [
        f"  {fact}: {old[fact] or '-'} -> {value or '-'}"
        for fact, value in _facts(after)
        if value != old[fact]
    ]
    text = "\n".join([after.name, *(changes or ["  as it was"])])
    _print(arguments, as_json(after), text)
    return 0


def _forget(store: VisitorStore, arguments: Namespace) -> int:
    if bool(arguments.name) == arguments.all:
        raise VisitorRefusedError(
            "no visitor is named", "name visitors, or use --all without names"
        )
    names = None if arguments.all else arguments.name
    forgetting = Forgetting.of(store, FaceStore(default_path()), names)
    visitors, faces = forgetting.visitors, forgetting.faces
    if (visitors or faces) and not arguments.yes and not _confirmed(visitors, faces):
        print("woz visitors: no visitor was deleted", file=sys.stderr)
        return 1
    gone = forgetting.carry_out()
    forgotten: list[Json] = [visitor.name for visitor in visitors]
    told: list[Json] = [*gone]
    text = ", ".join(dict.fromkeys([*(visitor.name for visitor in visitors), *gone])) or "nobody"
    if gone:
        text += f"; deleted faces: {', '.join(gone)}"
    _print(arguments, {"forgotten": forgotten, "faces": told}, f"forgotten: {text}")
    left = forgetting.left(gone)
    if left:
        print(
            f"woz visitors: the face recogniser still has {', '.join(left)}; remove it there too",
            file=sys.stderr,
        )
    return 0


# -- questions and output -------------------------------------------------------------------------


def _confirmed(visitors: list[Visitor], faces: list[str]) -> bool:
    """Whether the person at the terminal confirms; `VisitorRefusedError` if nobody can be asked."""
    if not sys.stdin.isatty():
        raise VisitorRefusedError(
            "standard input is not a terminal, so this cannot be confirmed", "use --yes to confirm"
        )
    for visitor in visitors:
        times = {0: "not met yet", 1: "met once"}
        met = times.get(visitor.meetings, f"met {visitor.meetings} times")
        last = f", last on {visitor.last_met}" if visitor.last_met else ""
        print(f"{visitor.name}: {met}{last}", file=sys.stderr)
    for face in faces:
        print(f"{face}: a face that is recognised", file=sys.stderr)
    print("Delete for ever? [y/N] ", end="", file=sys.stderr, flush=True)
    return sys.stdin.readline().strip().casefold() in ("y", "yes")


def _print_visitor(visitor: Visitor, arguments: Namespace) -> None:
    facts = [f"  {fact}: {value or '-'}" for fact, value in _facts(visitor)]
    _print(arguments, as_json(visitor), "\n".join([visitor.name, *facts]))


def _print(arguments: Namespace, value: Json, text: str) -> None:
    print(json_text(value, indent=2) if arguments.json else text)


def _facts(visitor: Visitor) -> list[tuple[str, str]]:
    return [
        ("age group", visitor.age_group),
        ("address", visitor.address),
        ("meetings", str(visitor.meetings)),
        ("first met", visitor.first_met),
        ("last met", visitor.last_met),
        ("face labels", ", ".join(visitor.labels)),
    ]
