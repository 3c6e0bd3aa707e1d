"""`woz participants`: which codes there are, where one of them stands, and taking it out."""

from __future__ import annotations

import getpass
import sys
from argparse import ArgumentParser, Namespace
from collections import Counter
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

from woz_tui.cli.error_sentences import CommandErrors
from woz_tui.cli.safe_streams import json_text
from woz_tui.log.withdrawals import WithdrawalRecordError
from woz_tui.withdrawal.removal import WithdrawalError

if TYPE_CHECKING:
    from woz_tui.protocol.messages import Json
    from woz_tui.withdrawal.removal import Removal
    from woz_tui.withdrawal.stored_files import StoredFile, StoredFiles

_WHO = "woz participants"
ERRORS = CommandErrors(WithdrawalError, WithdrawalRecordError, ValueError, who=_WHO)


def add(parser: ArgumentParser) -> None:
    """Declare the command's options."""
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
    from woz_tui.log.file_names import check_code  # noqa: PLC0415
    from woz_tui.withdrawal.removal import finish, is_unfinished  # noqa: PLC0415
    from woz_tui.withdrawal.stored_files import stored_files  # noqa: PLC0415

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
        return _due(arguments)
    if arguments.code is None:
        return _list(stored_files(arguments.folders), arguments)
    code = check_code("participant", arguments.code)
    found = stored_files(arguments.folders, [code])
    do = _withdraw if arguments.withdraw else _copy if arguments.copy else _show
    status = do(found, code, arguments)
    for problem in found.problems:
        _complain(problem)
    return 1 if found.problems else status


# -- everybody ------------------------------------------------------------------------------------


def _list(found: StoredFiles, arguments: Namespace) -> int:
    from woz_tui.analysis.participants import alike_sentence  # noqa: PLC0415
    from woz_tui.cli.report_layout import text_table  # noqa: PLC0415
    from woz_tui.console.drawing.text_console import TextConsole  # noqa: PLC0415
    from woz_tui.log.sessions import sessions_in  # noqa: PLC0415
    from woz_tui.log.withdrawals import withdrawals  # noqa: PLC0415

    withdrew = [each for folder in arguments.folders for each in withdrawals(folder)]
    counted, _ = sessions_in([str(folder) for folder in arguments.folders])
    sessions = Counter(
        code for each in found.sessions if each.log in counted for code in each.turns
    )
    stored = Counter(code for file in found.files() for code in file.codes)
    codes = sorted({code for each in found.sessions for code in each.turns})
    alike = alike_sentence(codes)
    if arguments.json:
        rows: list[Json] = [
            {"participant": code, "sessions": sessions[code], "files": stored[code]}
            for code in codes
        ]
        gone: list[Json] = [{"participant": each.code, "day": each.day} for each in withdrew]
        listed: dict[str, Json] = {"participants": rows, "alike": alike, "withdrawn": gone}
        print(json_text(listed, indent=2))
    elif codes:
        table = text_table("participant", "sessions", "files")
        for code in codes:
            table.add_row(code, str(sessions[code]), str(stored[code]))
        console = TextConsole()
        console.print(table)
        if alike:
            console.print(alike, soft_wrap=True)
    else:
        print("no log has the code of a participant")
    if withdrew and not arguments.json:
        told = ", ".join(f"{each.code} ({each.day})" for each in withdrew)
        print(f"Withdrew, and their codes are not given again: {told}")
    for problem in found.problems:
        _complain(problem)
    return 1 if found.problems else 0


def _due(arguments: Namespace) -> int:
    from woz_tui.cli.report_layout import text_table  # noqa: PLC0415
    from woz_tui.config.about_file import RetentionEntry, read_about  # noqa: PLC0415
    from woz_tui.console.drawing.text_console import TextConsole  # noqa: PLC0415
    from woz_tui.withdrawal.retention import overdue  # noqa: PLC0415
    from woz_tui.withdrawal.stored_files import stored_sessions  # noqa: PLC0415

    retention = read_about(arguments.about).retention
    if retention == RetentionEntry():
        _complain(
            f"{arguments.about} does not say it: write retention: {{media: 30 d, logs: 10 y}}"
        )
        return 1
    found = stored_sessions(arguments.folders)
    over = [*overdue(found.sessions, retention, datetime.now(UTC).date())]
    if arguments.json:
        rows: list[Json] = [
            {
                "path": str(each.path),
                "what": each.what,
                "recorded": each.recorded.isoformat(),
                "until": each.until.isoformat(),
            }
            for each in over
        ]
        print(json_text({"due": rows}, indent=2))
    elif over:
        table = text_table("until", "what", "path")
        for each in over:
            table.add_row(each.until.isoformat(), each.what, str(each.path))
        TextConsole().print(table)
        print("Nothing was deleted. Copies, exports and bundles are yours to look for.")
    else:
        print("Nothing is kept longer than it says.")
    for problem in found.problems:
        _complain(problem)
    return 1 if found.problems else 0


# -- one of them ----------------------------------------------------------------------------------


def _show(found: StoredFiles, code: str, arguments: Namespace) -> int:
    from woz_tui.withdrawal.removal import planned  # noqa: PLC0415

    plan = planned(found, code)
    if arguments.json:
        print(json_text(_fields(plan), indent=2))
    else:
        _print(plan, found)
    return 0


def _print(plan: Removal, found: StoredFiles) -> None:
    if plan.is_empty() and not plan.by_hand:
        print(f"{plan.code} stands in no file that can be searched")
    if plan.deleted:
        print("Files of this participant alone, or made again at any time: to be deleted")
        _print_files(plan.deleted)
    if plan.cut:
        print("Sessions of several people: only this participant is to be taken out")
        for session in plan.cut:
            print(f"  {session.log}{_lines(session.named.get(plan.code, {}))}")
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


def _lines(kinds: dict[str, int]) -> str:
    said = ", ".join(f"{count} {kind}" for kind, count in kinds.items())
    return f": stands in {said}" if said else ""


def _fields(plan: Removal) -> dict[str, Json]:
    def rows(stored: list[StoredFile]) -> list[Json]:
        return [
            {"path": str(file.path), "what": file.what, "remedy": file.remedy} for file in stored
        ]

    cut: list[Json] = [
        {
            "log": str(session.log),
            "files": [str(path) for path, _ in session.beside_of([plan.code])],
            "lines": {**session.named.get(plan.code, {})},
        }
        for session in plan.cut
    ]
    return {
        "code": plan.code,
        "delete": rows(plan.deleted),
        "take_out": cut,
        "forget": rows(plan.forgotten),
        "by_hand": rows(plan.by_hand),
    }


def _copy(found: StoredFiles, code: str, arguments: Namespace) -> int:
    from woz_tui.withdrawal.own_copy import copy_of  # noqa: PLC0415

    day = datetime.now(UTC).date().isoformat()
    copied = copy_of(found, code, arguments.copy, day)
    if arguments.json:
        logs: list[Json] = [str(session.log) for session in copied]
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
    from woz_tui.withdrawal.removal import forget, planned, withdraw  # noqa: PLC0415

    plan = planned(found, code)
    if not arguments.json:
        _print(plan, found)
    if plan.is_empty():
        if arguments.json:
            print(json_text(_fields(plan), indent=2))
        return 1 if plan.by_hand else 0
    if not arguments.yes and not _confirmed(code):
        _complain("nothing was changed")
        return 1
    by = arguments.by or getpass.getuser()
    withdraw(plan, arguments.folders[0], datetime.now(UTC).date().isoformat(), by)
    problems = forget(plan)
    _tell(plan, arguments)
    for problem in problems:
        _complain(problem)
    return 1 if problems or plan.by_hand else 0


def _confirmed(code: str) -> bool:
    """Whether the person at the terminal types the code."""
    if not sys.stdin.isatty():
        _complain("standard input is not a terminal, so this cannot be confirmed; use --yes")
        return False
    print(f"Delete for ever? Type {code}: ", end="", file=sys.stderr, flush=True)
    return sys.stdin.readline().strip() == code


def _tell(plan: Removal, arguments: Namespace) -> None:
    """What was done, in words that a lab can keep: they name nobody."""
    lines = sum(summary.lines for summary in plan.summaries.values())
    samples = sum(summary.samples for summary in plan.summaries.values())
    left = Counter(kind for summary in plan.summaries.values() for kind in summary.left)
    if arguments.json:
        done: dict[str, Json] = {
            "deleted_files": len(plan.deleted),
            "logs": len(plan.cut),
            "lines": lines,
            "samples": samples,
            "left": {**left},
        }
        print(json_text({**_fields(plan), "done": done}, indent=2))
        return
    print(
        f"Done: {len(plan.deleted)} files deleted; {lines} lines and {samples} samples taken out of"
        f" {len(plan.cut)} logs. Deleted blocks may remain on the disk, and in backups."
    )
    if left:
        kinds = ", ".join(f"{count} {kind}" for kind, count in left.items())
        print(f"The code, or the same word, still stands in lines of other people: {kinds}")
    if plan.by_hand:
        print("Left to look at by hand")
        _print_files(plan.by_hand)


def _complain(text: str) -> None:
    print(f"{_WHO}: {text}", file=sys.stderr)
