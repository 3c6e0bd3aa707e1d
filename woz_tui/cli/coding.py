"""`woz coding LOG`: what coders have set in replays, and how much two of them agree."""

from __future__ import annotations

import argparse
import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from woz_tui.cli.argument_types import number
from woz_tui.cli.error_sentences import CommandErrors
from woz_tui.cli.safe_streams import json_text
from woz_tui.log.coding_file import CodingError

if TYPE_CHECKING:
    from woz_tui.analysis.coder_agreement import Agreement
    from woz_tui.cli.report_layout import ReportPage
    from woz_tui.log.coding_file import Codings

ERRORS = CommandErrors(CodingError, who="woz coding")
#: What stands for a bin without a code.
NO_CODE = "(none)"


def add(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("log", type=Path, metavar="FILE", help="a session's log")
    parser.add_argument(
        "--coders", nargs=2, metavar="CODE", help="compare these two; without it all are listed"
    )
    parser.add_argument(
        "--bin",
        type=number(0.04, 600),
        default=1.0,
        metavar="SECONDS",
        help="length of a bin (default: 1)",
    )
    parser.add_argument("--tier", default="", metavar="NAME", help="only this tier")
    parser.add_argument(
        "--all-trials",
        action="store_true",
        help="also trials that do not count: aborted, excluded, practice, cut off",
    )
    parser.add_argument("--json", action="store_true", help="one object, for programs")


def run(arguments: argparse.Namespace) -> int:
    """Print codes or agreement; 1 if there is nothing to compare."""
    from woz_tui.log.coding_file import coding_path, read_codings  # noqa: PLC0415
    from woz_tui.log.log_reader import files_of  # noqa: PLC0415

    try:
        path = coding_path(files_of(arguments.log).paths[0])
    except (FileNotFoundError, ValueError) as error:
        print(f"woz coding: {error}", file=sys.stderr)
        return 1
    found = read_codings(path)
    if not any(found.by_coder.values()):
        print(
            f"woz coding: {path.name} has no codes\n"
            f"woz coding: set some with woz replay {shlex.quote(str(arguments.log))} --coder K1",
            file=sys.stderr,
        )
        return 1
    if found.unread:
        print(f"woz coding: {found.unread} line(s) of {path.name} left out", file=sys.stderr)
    if arguments.coders is None:
        return _print_coders(found, as_json=arguments.json)
    return _print_agreements(arguments, found)


def _print_coders(found: Codings, *, as_json: bool) -> int:
    from woz_tui.cli.report_layout import fitted, report_page, text_table  # noqa: PLC0415
    from woz_tui.log.coding_file import tiers_of  # noqa: PLC0415

    coders = {coder: found.of(coder) for coder in sorted(found.by_coder)}
    if as_json:
        print(json_text({coder: [code.text for code in mine] for coder, mine in coders.items()}))
        return 0
    made = text_table("coder", "tiers", "codes", "notes", left=2)
    for coder, mine in coders.items():
        notes = sum(code.note for code in mine)
        made.add_row(coder, ", ".join(tiers_of(mine)), str(len(mine) - notes), str(notes))
    page = report_page()
    page.console.print(*fitted(made, page.width), sep="\n")
    return 0


def _print_agreements(arguments: argparse.Namespace, found: Codings) -> int:
    from woz_tui.analysis.coder_agreement import agreements, coded_spans, coded_trials  # noqa: PLC0415
    from woz_tui.analysis.text_format import counted  # noqa: PLC0415
    from woz_tui.cli.report_layout import report_page  # noqa: PLC0415
    from woz_tui.log.log_reader import LogLine, messages  # noqa: PLC0415
    from woz_tui.timeline.timeline import timeline_of  # noqa: PLC0415

    one, other = arguments.coders
    for coder in arguments.coders:
        if not found.by_coder.get(coder):
            listed = ", ".join(sorted(name for name, mine in found.by_coder.items() if mine))
            print(f"woz coding: {coder} has set no code; {listed} did", file=sys.stderr)
            return 1
    lines = (each for each in messages(arguments.log) if not isinstance(each, LogLine))
    timeline = timeline_of(lines)
    within = coded_spans(timeline, every=arguments.all_trials)
    every = agreements(found.of(one), found.of(other), within, round(arguments.bin * 1e6))
    if not every:
        print(f"woz coding: neither {one} nor {other} has set a code", file=sys.stderr)
        return 1
    selected = [each for each in every if arguments.tier in ("", each.tier)]
    if not selected:
        tiers = ", ".join(each.tier for each in every)
        print(f"woz coding: there is no tier {arguments.tier!r}; {tiers}", file=sys.stderr)
        return 1
    if arguments.json:
        found_json = [
            {
                "tier": each.tier,
                "coders": arguments.coders,
                "bin_s": arguments.bin,
                "bins": each.bins,
                "agreement": each.agreed,
                "kappa": each.kappa,
                "table": [[*codes, count] for codes, count in sorted(each.table.items())],
            }
            for each in selected
        ]
        print(json_text(found_json))
        return 0
    paper = report_page()
    seconds = sum(end - begin for begin, end in within) / 1e6
    trials = counted(coded_trials(timeline, every=arguments.all_trials), "trial")
    where = trials if timeline.has_trials else "the whole session"
    paper.say(f"{one} and {other}: bins of {arguments.bin:g} s in {where}, {seconds:.1f} s")
    for each in selected:
        _print_agreement(paper, each, one, other)
    return 0


def _print_agreement(paper: ReportPage, found: Agreement, one: str, other: str) -> None:
    from rich.text import Text  # noqa: PLC0415

    from woz_tui.cli.report_layout import text_table  # noqa: PLC0415

    agreed = "no bins" if found.agreed is None else f"{found.agreed:.1%} of {found.bins} bins"
    kappa = "not defined (only one code)" if found.kappa is None else f"{found.kappa:.3f}"
    title = f"{found.tier}: agreement {agreed}, Cohen's kappa {kappa}"
    codes = found.codes
    made = text_table(f"{one} \\ {other}", *(code or NO_CODE for code in codes), "all")
    for row in codes:
        counts = [found.table.get((row, column), 0) for column in codes]
        made.add_row(row or NO_CODE, *map(str, counts), str(sum(counts)))
    totals = [sum(found.table.get((row, column), 0) for row in codes) for column in codes]
    made.add_row("all", *map(str, totals), str(sum(totals)))
    paper.print([Text(title, "bold"), made])
