"""`woz bundle FILE... --out FOLDER`: one folder with all that is deposited of a study."""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from pathlib import Path

from woz_tui.analysis.text_format import counted
from woz_tui.cli.error_sentences import CommandErrors
from woz_tui.config.about_file import NOTHING, read_about
from woz_tui.export.log_sources import ExportError, find_sources
from woz_tui.features.bundle.bundle import BundleError, BundleOptions, write_bundle
from woz_tui.log.withdrawals import WithdrawalRecordError

_WHO = "woz bundle"
ERRORS = CommandErrors(ExportError, BundleError, WithdrawalRecordError, who=_WHO)


def add(parser: ArgumentParser) -> None:
    parser.add_argument(
        "file", nargs="+", type=Path, metavar="FILE", help="a log, or a folder of logs"
    )
    parser.add_argument(
        "--out", required=True, type=Path, metavar="FOLDER", help="a new or empty folder"
    )
    parser.add_argument(
        "--about",
        type=Path,
        metavar="FILE",
        help="what no log knows: authors, licence, ethics and so on (default: none)",
    )
    parser.add_argument(
        "--study",
        type=Path,
        metavar="FILE",
        help="the experiment file as it was registered (default: as the first session played it)",
    )
    parser.add_argument(
        "--recode", action="store_true", help="draw new codes for participants; no key is kept"
    )
    parser.add_argument(
        "--media",
        action="store_true",
        help="sound and pictures too, if about.yaml has share: [media]",
    )
    parser.add_argument(
        "--with",
        dest="more",
        action="append",
        default=[],
        choices=("transcripts",),
        help="what people said too, if about.yaml has share: [transcripts]",
    )
    parser.add_argument(
        "--names",
        type=Path,
        metavar="FILE",
        help="names, one a line, that are taken out of transcripts; those of visitors are anyway",
    )
    parser.add_argument(
        "--samples", action="store_true", help="the values of the sensors as a table, too"
    )
    parser.add_argument(
        "--public",
        action="append",
        default=[],
        metavar="TEXT",
        help="a text that may stand in the bundle although it was withheld as somebody's word",
    )
    parser.add_argument("--force", action="store_true", help="replace an earlier bundle in FOLDER")
    parser.add_argument(
        "--strict", action="store_true", help="exit with 1 while TODO.md has anything to be done"
    )


def run(arguments: Namespace) -> int:
    """Write the folder, and say what is still missing."""
    about = read_about(arguments.about) if arguments.about is not None else NOTHING
    names: list[str] = []
    if arguments.names is not None:
        names = arguments.names.read_text(encoding="utf-8").splitlines()
    sources, problems = find_sources(arguments.file)
    for problem in problems:
        print(f"{_WHO}: {problem}", file=sys.stderr)
    options = BundleOptions(
        about=about,
        registered=arguments.study,
        recode=arguments.recode,
        media=arguments.media,
        transcripts="transcripts" in arguments.more,
        names=names,
        samples=arguments.samples,
        public=arguments.public,
    )
    result = write_bundle(sources, arguments.out, options, force=arguments.force)
    people = counted(result.participants, "participant")
    print(
        f"{counted(result.sessions, 'session')} of {people}, {counted(result.files, 'file')} in"
        f" {arguments.out}"
    )
    if result.missing:
        count = counted(len(result.missing), "thing")
        print(f"{_WHO}: {count} still to be done, see TODO.md", file=sys.stderr)
    return 1 if problems or (arguments.strict and result.missing) else 0
