"""`woz report FILE...`: the figures of one session, or of many side by side."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from woz_tui.analysis.spreadsheets import PLAIN, SPREADSHEETS
from woz_tui.cli.argument_types import file_or_word, number
from woz_tui.cli.error_sentences import os_error_text
from woz_tui.cli.progress import progress
from woz_tui.cli.safe_streams import json_text

if TYPE_CHECKING:
    from woz_tui.analysis.csv_package import TableFiles
    from woz_tui.analysis.figure_counting import FigureOptions
    from woz_tui.analysis.figures import SessionFigures
    from woz_tui.analysis.html.report_page import ReportPage
    from woz_tui.analysis.html.session_pages import SessionPages
    from woz_tui.analysis.participant_groups import GroupedSessions
    from woz_tui.analysis.session_reading import ReportExtras, SessionReport

#: Seconds in which an answer to a cue counts as one.
_WINDOW = 10.0


def add(parser: argparse.ArgumentParser) -> None:
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
    parser.add_argument(
        "--figures",
        type=Path,
        metavar="FOLDER",
        help="write what conditions differ by as pictures (SVG), each with its table",
    )
    parser.add_argument("--html", type=Path, metavar="FILE", help="write one self-contained page")
    parser.add_argument(
        "--sessions",
        choices=("inside", "beside"),
        help="with --html: sessions on the page itself, or each on a page of its own in a folder "
        "beside it (default: beside if there are more than 50)",
    )
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
        type=file_or_word,
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
    parser.add_argument(
        "--anew",
        action="store_true",
        help="read all logs anew; figures that were kept of logs read before are forgotten",
    )


def run(arguments: argparse.Namespace) -> int:
    """Print the figures; 1 if anything that was named could not be read."""
    from woz_tui.cli import log_from_stdin  # noqa: PLC0415

    return log_from_stdin.with_logs(arguments, _report, "woz report")


def _report(arguments: argparse.Namespace) -> int:
    from woz_tui.analysis.csv_package import table_files  # noqa: PLC0415
    from woz_tui.analysis.participant_groups import GroupedSessions  # noqa: PLC0415
    from woz_tui.analysis.session_reading import ReportExtras  # noqa: PLC0415

    if arguments.spreadsheet and not arguments.csv:
        print("woz report: --spreadsheet needs --csv; leave it out", file=sys.stderr)
        return 1
    reading = SessionReader(arguments)
    grouped = GroupedSessions()
    on_page = arguments.html is not None
    detailed = on_page or (len(reading.paths) == 1 and not arguments.json)
    extras = ReportExtras(
        timeline=detailed, curves=on_page, people=detailed, verified=arguments.verify
    )
    pages = _pages(arguments, len(reading.paths), extras) if arguments.html else None
    alone: SessionReport | None = None
    try:
        with ExitStack() as opened:
            files: TableFiles | None = None
            page: ReportPage | None = None
            output = JsonOutput() if arguments.json else None
            for report in reading.reports(extras, pages):
                grouped.add(report.figures)
                # Files are opened late: of no session, older ones are not emptied.
                if arguments.csv:
                    csv_format = SPREADSHEETS.get(arguments.spreadsheet, PLAIN)
                    files = files or opened.enter_context(table_files(arguments.csv, csv_format))
                    for sentence in files.add(report.figures):
                        print(f"woz report: {sentence}", file=sys.stderr)
                if output:
                    output.add(report.figures)
                if arguments.html:
                    from woz_tui.analysis.html.report_page import writing  # noqa: PLC0415

                    page = page or opened.enter_context(
                        writing(arguments.html, grouped, len(reading.paths), pages)
                    )
                    page.add(report)
                if len(reading.paths) == 1:
                    alone = report
            if output:
                output.end(grouped, reading.problems)
            if arguments.figures:
                from woz_tui.analysis.figure_files import write_figures  # noqa: PLC0415

                write_figures(arguments.figures, grouped)
    except OSError as error:
        print(f"woz report: {os_error_text(error)}", file=sys.stderr)
        return 1
    if not (arguments.json or arguments.html) and grouped.sessions:
        _print_on_terminal(arguments, grouped, alone)
    # Of no session no file was written: older ones may be there.
    for path in filter(None, (arguments.csv, arguments.figures, arguments.html)):
        nothing = f"{path} was not written: there is nothing to report"
        print(f"woz report: {f'wrote {path}' if grouped.sessions else nothing}", file=sys.stderr)
    return reading.print_problems("woz report")


def _pages(
    arguments: argparse.Namespace, sessions: int, extras: ReportExtras
) -> SessionPages | None:
    """Where sessions have pages of their own; None: they are on the page."""
    from woz_tui.analysis.html.report_page import is_beside  # noqa: PLC0415
    from woz_tui.analysis.html.session_pages import SessionPages  # noqa: PLC0415

    asked = {"beside": True, "inside": False}.get(arguments.sessions)
    if not is_beside(sessions, asked):
        return None
    return SessionPages(arguments.html, options_of(arguments), extras)


class SessionReader:
    """Reads the sessions that were named; what cannot be read is kept as a sentence."""

    def __init__(self, arguments: argparse.Namespace) -> None:
        from woz_tui.log.sessions import sessions_in  # noqa: PLC0415

        self._arguments = arguments
        self.paths, self.problems = sessions_in(arguments.logs)

    def reports(
        self, extras: ReportExtras, pages: SessionPages | None = None
    ) -> Iterator[SessionReport]:
        """Reads one session after the other; only one is in memory at a time. `pages`: those that
        stand there already need not be read.
        """
        read = self._way_of_reading(extras)
        if pages is not None:
            read = pages.report
        with progress() as show:
            for number, path in enumerate(self.paths, 1):
                show(f"Reading session {number} of {len(self.paths)}: {path.name}")
                try:
                    report = read(path)
                except (OSError, ValueError) as error:
                    reason = os_error_text(error) if isinstance(error, OSError) else str(error)
                    self.problems.append(reason)
                    continue
                yield report

    def _way_of_reading(self, extras: ReportExtras) -> Callable[[Path], SessionReport]:
        """Of many sessions the figures may be those that were kept when they were read before."""
        from woz_tui.analysis.kept_figures import forget_all, forget_lost, kept_report  # noqa: PLC0415
        from woz_tui.analysis.session_reading import NO_EXTRAS, read_report  # noqa: PLC0415

        options = options_of(self._arguments)
        (forget_all if self._arguments.anew else forget_lost)()
        if extras == NO_EXTRAS and len(self.paths) > 1:
            return partial(kept_report, options=options)
        return partial(read_report, options=options, extras=extras)

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


class JsonOutput:
    """One JSON object on standard output, written session by session: one a line."""

    def __init__(self) -> None:
        self._before = '{"sessions": ['

    def add(self, figures: SessionFigures) -> None:
        from woz_tui.analysis import figures_json  # noqa: PLC0415

        print(self._before + json_text(figures_json.plain(figures), allow_nan=False), end="")
        self._before = ",\n"

    def end(self, grouped: GroupedSessions, problems: list[str]) -> None:
        """Print what there is to be said of all of them."""
        from woz_tui.analysis import figures_json  # noqa: PLC0415

        found = {
            "experiments": figures_json.grouped(grouped),
            **figures_json.apart(grouped),
            "problems": problems,
        }
        if self._before != ",\n":
            print(self._before, end="")
        print("],\n" + json_text(found, allow_nan=False).removeprefix("{"))


def _print_on_terminal(
    arguments: argparse.Namespace, grouped: GroupedSessions, alone: SessionReport | None
) -> None:
    from woz_tui.cli import report_sessions as terminal  # noqa: PLC0415
    from woz_tui.cli.report_layout import report_page  # noqa: PLC0415

    page = report_page()
    if page.console.is_terminal and not arguments.all:
        terminal.show_summary(page, grouped, alone)
    elif alone is not None:
        terminal.show_session(page, alone, sys.maxsize if arguments.all else terminal.TOP)
        if len(alone.figures.participants) > 1:
            for experiment in grouped.experiments:
                terminal.show_means(page, grouped, experiment)
    else:
        terminal.show_sessions(page, grouped)
