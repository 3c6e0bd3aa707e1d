"""`woz report FILE...`: the figures of one session, or of many side by side."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

from woz_tui.analysis.spreadsheets import PLAIN, SPREADSHEETS
from woz_tui.cli.argument_types import number
from woz_tui.cli.error_sentences import os_error_text
from woz_tui.cli.progress import progress
from woz_tui.cli.safe_streams import json_text

if TYPE_CHECKING:
    from woz_tui.analysis.csv_package import TableFiles
    from woz_tui.analysis.figure_counting import FigureOptions
    from woz_tui.analysis.participant_groups import GroupedSessions
    from woz_tui.analysis.session_reading import ReportExtras, SessionReport

#: Seconds in which an answer to a cue counts as one.
_WINDOW = 10.0


def add(parser: argparse.ArgumentParser) -> None:
    """Declare the command's options."""
    add_sessions(parser)
    parser.add_argument(
        "--csv", type=Path, metavar="FOLDER", help="write the figures as tidy CSV files"
    )
    parser.add_argument(
        "--spreadsheet",
        choices=sorted(SPREADSHEETS),
        default="",
        metavar="LANGUAGE",
        help="with --csv: as a spreadsheet in this language opens them by a double click",
    )
    parser.add_argument("--html", type=Path, metavar="FILE", help="write one self-contained page")
    parser.add_argument("--json", action="store_true", help="one JSON object, for programs")
    parser.add_argument(
        "--verify",
        action="store_true",
        help="check all line numbers and checksums, also of the samples",
    )
    parser.add_argument(
        "--all",
        action="store_true",
        help="everything on a terminal, which shows ten lines else; tables without a limit of rows",
    )


def add_sessions(parser: argparse.ArgumentParser) -> None:
    """Options that say which sessions are meant and what counts."""
    parser.add_argument(
        "logs",
        nargs="+",
        metavar="FILE",
        help="a session's log, a folder of them, or a pattern; - is a log from standard input",
    )
    parser.add_argument(
        "--window",
        type=number(0.1, 600),
        default=_WINDOW,
        metavar="SECONDS",
        help=f"longest time from a cue to its answer (default: {_WINDOW:g})",
    )
    parser.add_argument(
        "--cue-state",
        action="append",
        default=[],
        metavar="STATE",
        help="state of the engagement model that counts as a cue (default: RobotThinks)",
    )
    parser.add_argument(
        "--all-trials",
        action="store_true",
        help="also what happened in trials that do not count: aborted, excluded, practice, cut off",
    )


def run(arguments: argparse.Namespace) -> int:
    """Print the figures; 1 if anything that was named could not be read."""
    from woz_tui.cli import log_from_stdin  # noqa: PLC0415

    return log_from_stdin.with_logs(arguments, _report, "woz report")


def _report(arguments: argparse.Namespace) -> int:
    from woz_tui.analysis import figures_json  # noqa: PLC0415
    from woz_tui.analysis.csv_package import table_files  # noqa: PLC0415
    from woz_tui.analysis.participant_groups import GroupedSessions  # noqa: PLC0415

    if arguments.spreadsheet and not arguments.csv:
        print("woz report: --spreadsheet needs --csv; leave it out", file=sys.stderr)
        return 1
    reading = SessionReader(arguments)
    grouped = GroupedSessions()
    kept: list[SessionReport] = []
    sessions: list[object] = []
    try:
        with ExitStack() as opened:
            files: TableFiles | None = None
            for report in reading.reports(_extras(arguments, len(reading.paths))):
                grouped.add(report.figures)
                if arguments.csv:  # opened late: of no session, older ones are not emptied
                    csv_format = SPREADSHEETS.get(arguments.spreadsheet, PLAIN)
                    files = files or opened.enter_context(table_files(arguments.csv, csv_format))
                    for sentence in files.add(report.figures):
                        print(f"woz report: {sentence}", file=sys.stderr)
                if arguments.json:
                    sessions.append(figures_json.plain(report.figures))
                if arguments.html or len(reading.paths) == 1:
                    kept.append(report)
        if arguments.html and kept:
            from woz_tui.analysis.html.report_page import write  # noqa: PLC0415

            write(kept, arguments.html)
    except OSError as error:
        print(f"woz report: {os_error_text(error)}", file=sys.stderr)
        return 1
    if arguments.json:
        _print_json(sessions, grouped, reading.problems)
    elif (kept or grouped.sessions) and not arguments.html:
        _print(arguments, grouped, kept, len(reading.paths))
    _print_written(arguments, nothing=not grouped.sessions)
    return reading.print_problems("woz report")


def _print_written(arguments: argparse.Namespace, *, nothing: bool) -> None:
    """Prints which files were written. Of no session there are none: older ones may be there."""
    for path in filter(None, (arguments.csv, arguments.html)):
        sentence = f"{path} was not written: there is nothing to report"
        print(f"woz report: {sentence if nothing else f'wrote {path}'}", file=sys.stderr)


class SessionReader:
    """Reads the sessions that were named; what cannot be read is kept as a sentence."""

    def __init__(self, arguments: argparse.Namespace) -> None:
        from woz_tui.log.sessions import sessions_in  # noqa: PLC0415

        self._arguments = arguments
        self.paths, self.problems = sessions_in(arguments.logs)

    def reports(self, extras: ReportExtras) -> Iterator[SessionReport]:
        """Reads one session after the other; only one is in memory at a time."""
        from woz_tui.analysis.session_reading import read_report  # noqa: PLC0415

        options = options_of(self._arguments)
        with progress() as show:
            for number, path in enumerate(self.paths, 1):
                show(f"Reading session {number} of {len(self.paths)}: {path.name}")
                try:
                    report = read_report(path, options, extras)
                except (OSError, ValueError) as error:
                    reason = os_error_text(error) if isinstance(error, OSError) else str(error)
                    self.problems.append(reason)
                    continue
                yield report

    def print_problems(self, command: str) -> int:
        """Print what was wrong; returns the exit code."""
        for problem in self.problems:
            print(f"{command}: {problem}", file=sys.stderr)
        return 1 if self.problems else 0


def options_of(arguments: argparse.Namespace) -> FigureOptions:
    """The options of the figures, from those of the command line."""
    from woz_tui.analysis.cue_responses import WAITING  # noqa: PLC0415
    from woz_tui.analysis.figure_counting import FigureOptions  # noqa: PLC0415

    return FigureOptions(
        window_us=round(arguments.window * 1e6),
        waiting=tuple(arguments.cue_state) or WAITING,
        all_trials=arguments.all_trials,
    )


def _extras(arguments: argparse.Namespace, sessions: int) -> ReportExtras:
    from woz_tui.analysis.session_reading import ReportExtras  # noqa: PLC0415

    page = arguments.html is not None
    alone = sessions == 1 and not arguments.json
    return ReportExtras(
        timeline=page or alone, curves=page, people=page or alone, verified=arguments.verify
    )


def _print_json(sessions: list[object], grouped: GroupedSessions, problems: list[str]) -> None:
    from woz_tui.analysis import figures_json  # noqa: PLC0415

    found = {
        "sessions": sessions,
        "experiments": figures_json.grouped(grouped),
        **figures_json.apart(grouped),
        "problems": problems,
    }
    print(json_text(found, allow_nan=False))


def _print(
    arguments: argparse.Namespace,
    grouped: GroupedSessions,
    kept: list[SessionReport],
    sessions: int,
) -> None:
    from woz_tui.cli import report_sessions as terminal  # noqa: PLC0415
    from woz_tui.cli.report_layout import report_page  # noqa: PLC0415

    page = report_page()
    if page.console.is_terminal and not arguments.all:
        terminal.show_summary(page, grouped, kept[0] if sessions == 1 and kept else None)
    elif sessions == 1 and kept:
        terminal.show_session(page, kept[0], sys.maxsize if arguments.all else terminal.TOP)
    else:
        terminal.show_sessions(page, grouped)
