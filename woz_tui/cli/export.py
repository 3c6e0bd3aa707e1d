"""`woz export FILE... --to FORMAT --out FOLDER`: sessions for other programs."""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from pathlib import Path

from woz_tui.analysis.participants import alike_sentence
from woz_tui.analysis.spreadsheets import SPREADSHEETS
from woz_tui.analysis.text_format import counted
from woz_tui.cli.error_sentences import CommandErrors
from woz_tui.export.export_run import export, formats
from woz_tui.export.exporter import ExportOptions
from woz_tui.export.log_sources import ExportError, find_sources
from woz_tui.export.other_recording import OtherRecording, readers

ERRORS = CommandErrors(ExportError, who="woz export")


def add(parser: ArgumentParser) -> None:
    parser.add_argument(
        "file", nargs="+", type=Path, metavar="FILE", help="a log, or a folder of logs"
    )
    parser.add_argument(
        "--to",
        required=True,
        choices=list(formats()),
        help="; ".join(f"{name}: {each.meaning}" for name, each in formats().items()),
    )
    parser.add_argument(
        "--out", required=True, type=Path, metavar="FOLDER", help="a new or empty folder"
    )
    parser.add_argument("--force", action="store_true", help="replace an earlier export in FOLDER")
    parser.add_argument(
        "--redact-text",
        action="store_true",
        help="replace all spoken, typed and written text, and remove dates and sound",
    )
    parser.add_argument(
        "--private",
        action="store_true",
        help="include answers that the experiment file calls private",
    )
    parser.add_argument(
        "--samples", action="store_true", help="include the values of the sensors (csv, bids, mcap)"
    )
    parser.add_argument(
        "--no-sound",
        action="store_true",
        help="leave out the sound of the visitor's voice (eaf, textgrid)",
    )
    parser.add_argument(
        "--spreadsheet",
        choices=sorted(SPREADSHEETS),
        default="",
        metavar="LANGUAGE",
        help="tables as a spreadsheet in this language opens them by a double click (csv):"
        f" {', '.join(sorted(SPREADSHEETS))}",
    )
    other = parser.add_argument_group("a lab's recording of the session, for --to bids")
    other.add_argument(
        "--with",
        dest="recording",
        type=Path,
        metavar="FILE",
        help=f"join the session with it ({', '.join(readers())}): onsets are in its time",
    )
    other.add_argument(
        "--stream",
        default="",
        metavar="NAME",
        help="the stream whose first value is its time 0 (default: the EEG)",
    )
    media = parser.add_argument_group("a video of the session, for --to eaf")
    media.add_argument("--media", type=Path, metavar="FILE", help="a video or sound")
    media.add_argument(
        "--offset",
        type=float,
        default=0.0,
        metavar="SECONDS",
        help=(
            "time in the video at which the session begins; negative: the session began"
            " earlier (default: 0)"
        ),
    )


def run(arguments: Namespace) -> int:
    """Write the folder, and say what could not be exported."""
    if arguments.samples and not formats()[arguments.to].takes_samples:
        raise ExportError(
            f"--to {arguments.to} cannot include --samples", "use --to csv, bids or mcap for them"
        )
    if arguments.spreadsheet and arguments.to != "csv":
        raise ExportError("--spreadsheet needs --to csv", "leave it out")
    if arguments.private and arguments.redact_text:
        raise ExportError("--redact-text takes private answers out", "leave out --private")
    if arguments.stream and arguments.recording is None:
        raise ExportError("--stream needs --with", "name the recording with --with")
    options = ExportOptions(
        redact=arguments.redact_text,
        private=arguments.private,
        samples=arguments.samples,
        sound=not (arguments.no_sound or arguments.redact_text),
        media=arguments.media,
        spreadsheet=arguments.spreadsheet,
        offset=_microseconds(arguments),
        recording=OtherRecording(arguments.recording, arguments.stream)
        if arguments.recording is not None
        else None,
    )
    sources, problems = find_sources(arguments.file)
    for problem in problems:
        print(f"woz export: {problem}", file=sys.stderr)
    sessions = unread = 0
    codes: list[str] = []
    for summary in export(sources, arguments.to, arguments.out, options, force=arguments.force):
        session = summary.session
        sessions += 1
        unread += not session.lines
        codes += summary.participants
        print(f"{session.name}: {summary.events} events, {session.duration / 1e6:.1f} s")
        for sentence in [*(f"damage: {each}" for each in session.damage), *summary.notes]:
            print(f"woz export: {session.name}: {sentence}", file=sys.stderr)
    if alike := alike_sentence(codes):
        print(f"woz export: {alike}", file=sys.stderr)
    print(f"{counted(sessions, 'session')} in {arguments.out}")
    return 1 if unread or problems else 0


def _microseconds(arguments: Namespace) -> int:
    if arguments.offset and arguments.media is None:
        raise ExportError("--offset needs --media", "name the video with --media")
    if not abs(arguments.offset) < 1e6:
        raise ExportError(f"--offset {arguments.offset} is not a time", "give it in seconds")
    seconds: float = arguments.offset
    return round(seconds * 1_000_000)
