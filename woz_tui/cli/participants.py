"""`woz participants`: which codes there are, where one of them stands, and taking it out."""

from __future__ import annotations

import getpass
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Iterable
from datetime import UTC, datetime
from pathlib import Path

from woz_tui.cli.error_sentences import CommandErrors
from woz_tui.cli.report_layout import text_table
from woz_tui.cli.safe_streams import json_text
from woz_tui.config.about_file import RetentionEntry, read_about
from woz_tui.console.drawing.text_console import TextConsole
from woz_tui.log.file_names import check_code
from woz_tui.log.withdrawals import WithdrawalRecordError
from woz_tui.withdrawal.own_copy import copy_of
from woz_tui.withdrawal.participant_list import ParticipantList
from woz_tui.withdrawal.removal import (
    Removal,
    WithdrawalError,
    finish,
    forget,
    is_unfinished,
    planned,
    withdraw,
)
from woz_tui.withdrawal.retention import overdue
from woz_tui.withdrawal.stored_files import (
    StoredFile,
    StoredFiles,
    stored_files,
    stored_sessions,
)

_WHO = "woz participants"
ERRORS = CommandErrors(WithdrawalError, WithdrawalRecordError, ValueError, who=_WHO)


def add(parser: ArgumentParser) -> None:
    parser.add_argument(
        "folders",
        nargs="*",
        type=Path,
        default=[Path("recordings")],
        metavar="FOLDER",
        help="folders to search, with all below (default: recordings)",
    )
    parser.add_argument("--code", metavar="CODE", help="list every file in which this code stands")
    parser.add_argument(
        "--withdraw",
        action="store_true",
        help="with --code: take out all that is kept of this participant; asks first",
    )
    parser.add_argument(
        "--copy",
        type=Path,
        metavar="NEW_FOLDER",
        help="with --code: copy what is kept of this participant, without others, to hand it over",
    )
    parser.add_argument(
        "--by", default="", metavar="WHO", help="for the record: who does it (default: this user)"
    )
    parser.add_argument(
        "--due",
        action="store_true",
        help="list what is kept longer than --about says; nothing is deleted",
    )
    parser.add_argument(
        "--about",
        type=Path,
        default=Path("about.yaml"),
        metavar="FILE",
        help="with --due: the file with retention: {media: 30 d, logs: 10 y} (default: about.yaml)",
    )
    parser.add_argument("--yes", action="store_true", help="do not ask for confirmation")
    parser.add_argument("--json", action="store_true", help="one object, for programs")


def run(arguments: Namespace) -> int:
    """List or take out; 1 if something is wrong or left to do by hand."""
    arguments.folders = [folder.absolute() for folder in arguments.folders]
    for folder in arguments.folders:
        if not folder.is_dir():
            _complain(f"{folder}: there is no such folder")
            return 1
    for option in ("withdraw", "copy"):
        if getattr(arguments, option) and arguments.code is None:
            _complain(f"--{option} needs --code: whom?")
            return 2
    if arguments.withdraw and arguments.copy:
        _complain("copy first, look at the copy, then withdraw")
        return 2
    if arguments.due and arguments.code is not None:
        _complain("--due is about everybody: leave --code out")
        return 2
    for folder in arguments.folders:
        if arguments.withdraw:
            if finish(folder, arguments.folders):
                _complain(f"{folder}: a withdrawal that was interrupted is finished now")
        elif is_unfinished(folder):
            _complain(f"{folder}: a withdrawal was interrupted here: --withdraw finishes it")
    if arguments.due:
        return _print_due(arguments)
    if arguments.code is None:
        return _print_list(stored_files(arguments.folders), arguments)
    code = check_code("participant", arguments.code)
    found = stored_files(arguments.folders, [code])
    if arguments.withdraw:
        status = _withdraw(found, code, arguments)
    elif arguments.copy:
        status = _copy(found, code, arguments)
    else:
        status = 0
        plan = planned(found, code)
        if arguments.json:
            print(json_text(plan.as_json(), indent=2))
        else:
            _print_plan(plan, found)
    return 1 if _complain_all(found.problems) else status


# -- everybody ------------------------------------------------------------------------------------


def _print_list(found: StoredFiles, arguments: Namespace) -> int:
    listed = ParticipantList.of(found, arguments.folders)
    if arguments.json:
        print(json_text(listed.as_json(), indent=2))
    elif listed.codes:
        table = text_table("participant", "sessions", "files")
        for code in listed.codes:
            table.add_row(code, str(listed.sessions[code]), str(listed.files[code]))
        console = TextConsole()
        console.print(table)
        if listed.alike:
            console.print(listed.alike, soft_wrap=True)
    else:
        print("no log has the code of a participant")
    if listed.withdrew and not arguments.json:
        told = ", ".join(f"{each.code} ({each.day})" for each in listed.withdrew)
        print(f"Withdrew, and their codes are not given again: {told}")
    return 1 if _complain_all(found.problems) else 0


def _print_due(arguments: Namespace) -> int:
    retention = read_about(arguments.about).retention
    if retention == RetentionEntry():
        _complain(
            f"{arguments.about} does not say it: write retention: {{media: 30 d, logs: 10 y}}"
        )
        return 1
    found = stored_sessions(arguments.folders)
    over = [*overdue(found.sessions, retention, datetime.now(UTC).date())]
    if arguments.json:
        print(json_text({"due": [each.as_json() for each in over]}, indent=2))
    elif over:
        table = text_table("until", "what", "path")
        for each in over:
            table.add_row(each.until.isoformat(), each.what, str(each.path))
        TextConsole().print(table)
        print("Nothing was deleted. Copies, exports and bundles are yours to look for.")
    else:
        print("Nothing is kept longer than it says.")
    return 1 if _complain_all(found.problems) else 0


# -- one of them ----------------------------------------------------------------------------------


def _print_plan(plan: Removal, found: StoredFiles) -> None:
    if plan.is_empty() and not plan.by_hand:
        print(f"{plan.code} stands in no file that can be searched")
    if plan.deleted:
        print("Files of this participant alone, or made again at any time: to be deleted")
        _print_files(plan.deleted)
    if plan.cut:
        print("Sessions of several people: only this participant is to be taken out")
        for session in plan.cut:
            kinds = session.named.get(plan.code, {}).items()
            said = ", ".join(f"{count} {kind}" for kind, count in kinds)
            print(f"  {session.log}{said and f': stands in {said}'}")
            for path, what in session.beside_of([plan.code]):
                if path != session.log:
                    print(f"    {path} ({what})")
    if plan.forgotten:
        print("Stores in which this participant has an entry: to be deleted")
        _print_files(plan.forgotten)
    if plan.by_hand:
        print("To look at by hand")
        _print_files(plan.by_hand)
    if found.closed:
        names = ", ".join(path.name for path in found.closed[:3])
        more = " ..." if len(found.closed) > 3 else ""
        print(f"Not searched, as they are no text: {len(found.closed)} files ({names}{more})")
    for history in found.histories:
        print(
            f"Not searched: {history}, in which git keeps earlier versions, also of deleted files"
        )


def _print_files(stored: list[StoredFile]) -> None:
    for file in stored:
        print(f"  {file.path} ({file.what}){f': {file.remedy}' if file.remedy else ''}")


def _copy(found: StoredFiles, code: str, arguments: Namespace) -> int:
    day = datetime.now(UTC).date().isoformat()
    copied = copy_of(found, code, arguments.copy, day)
    if arguments.json:
        logs = [str(session.log) for session in copied]
        print(json_text({"code": code, "copied": logs, "folder": str(arguments.copy)}, indent=2))
    elif copied:
        print(f"Copied to {arguments.copy}: {len(copied)} sessions; README.txt says what is what")
        if found.closed or found.histories:
            print("Not searched: archives, documents and histories; see --code without --copy")
    else:
        print(f"{code} took part in no session that can be searched")
    return 0


# -- taking out -----------------------------------------------------------------------------------


def _withdraw(found: StoredFiles, code: str, arguments: Namespace) -> int:
    plan = planned(found, code)
    if not arguments.json:
        _print_plan(plan, found)
    if plan.is_empty():
        if arguments.json:
            print(json_text(plan.as_json(), indent=2))
        return 1 if plan.by_hand else 0
    if not arguments.yes and not _confirmed(code):
        _complain("nothing was changed")
        return 1
    by = arguments.by or getpass.getuser()
    withdraw(plan, arguments.folders[0], datetime.now(UTC).date().isoformat(), by)
    problems = forget(plan)
    if arguments.json:
        print(json_text({**plan.as_json(), "done": plan.done_json()}, indent=2))
    else:
        print(
            f"Done: {len(plan.deleted)} files deleted; {plan.lines} lines and {plan.samples}"
            f" samples taken out of {len(plan.cut)} logs. Deleted blocks may remain on the disk,"
            " and in backups."
        )
        if left := plan.left:
            kinds = ", ".join(f"{count} {kind}" for kind, count in left.items())
            print(f"The code, or the same word, still stands in lines of other people: {kinds}")
        if plan.by_hand:
            print("Left to look at by hand")
            _print_files(plan.by_hand)
    return 1 if _complain_all(problems) or plan.by_hand else 0


def _confirmed(code: str) -> bool:
    """Whether the person at the terminal types the code."""
    if not sys.stdin.isatty():
        _complain("standard input is not a terminal, so this cannot be confirmed; use --yes")
        return False
    print(f"Delete for ever? Type {code}: ", end="", file=sys.stderr, flush=True)
    return sys.stdin.readline().strip() == code


def _complain(text: str) -> None:
    print(f"{_WHO}: {text}", file=sys.stderr)


def _complain_all(problems: Iterable[str]) -> bool:
    """Say each; whether there is any."""
    said = [*problems]
    for problem in said:
        _complain(problem)
    return bool(said)
