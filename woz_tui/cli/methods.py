"""`woz methods FILE...`: sentences for the method section of a paper, out of sessions' logs."""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from pathlib import Path

from woz_tui.cli.error_sentences import CommandErrors
from woz_tui.cli.report import SessionReader, add_sessions

ERRORS = CommandErrors(who="woz methods")


def add(parser: ArgumentParser) -> None:
    add_sessions(parser)
    parser.add_argument("--markdown", action="store_true", help="with headings")
    parser.add_argument(
        "--about", type=Path, metavar="FILE", help="about.yaml: what no log knows of the study"
    )


def run(arguments: Namespace) -> int:
    """Print the sentences; what no log can know, and what could not be read, goes to stderr."""
    from woz_tui.cli import log_from_stdin  # noqa: PLC0415

    return log_from_stdin.with_logs(arguments, _print_methods, "woz methods")


def _print_methods(arguments: Namespace) -> int:
    from woz_tui.analysis.methods_section import by_hand, paragraphs  # noqa: PLC0415
    from woz_tui.analysis.participants import alike_sentence  # noqa: PLC0415
    from woz_tui.analysis.session_reading import NO_EXTRAS  # noqa: PLC0415
    from woz_tui.analysis.study_figures import Studies  # noqa: PLC0415
    from woz_tui.config.about_file import NOTHING, read_about  # noqa: PLC0415

    about = NOTHING if arguments.about is None else read_about(arguments.about)
    reading = SessionReader(arguments)
    studies = Studies()
    for report in reading.reports(NO_EXTRAS):
        studies.add(report.figures)
    for place, facts in enumerate(studies.found.values()):
        if place:
            print()
        if arguments.markdown:
            print(f"## Method ({facts.experiment or 'experiment not recorded'})")
        elif len(studies.found) > 1:
            print(f"{facts.experiment or 'experiment not recorded'}:")
        found = paragraphs(facts, about)
        if arguments.markdown:
            for each in found:
                print(f"\n### {each.head}\n\n{' '.join(each.sentences)}")
        else:
            print(" ".join(sentence for each in found for sentence in each.sentences))
        if alike := alike_sentence(facts.participants):
            print(f"woz methods: {alike}", file=sys.stderr)
    if studies.found and (missing := by_hand(about)):
        print("woz methods: no log contains the following; write it by hand:", file=sys.stderr)
        for item in missing:
            print(f"  - {item}", file=sys.stderr)
    return reading.print_problems("woz methods")
