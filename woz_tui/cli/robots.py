"""`woz robots`: which robots and devices there are, and what each offers."""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Iterable, Mapping
from pathlib import Path

from rich.table import Table
from rich.text import Text

from woz_tui.cli.check import verb_rows
from woz_tui.cli.error_sentences import CommandErrors
from woz_tui.cli.safe_streams import json_text
from woz_tui.config.problems import hint
from woz_tui.config.robot_descriptions import RobotDescription, descriptions
from woz_tui.config.settings_table import settings_rows
from woz_tui.console.drawing.text_console import TextConsole
from woz_tui.drivers import plugins
from woz_tui.drivers.contract import SHOWN, Driver

ERRORS = CommandErrors(who="woz robots")
#: Columns of a page that goes into a file or a pipe.
_PAGE = 80


def add(parser: ArgumentParser) -> None:
    parser.add_argument("type", nargs="?", default="", help="one of them, in detail")
    parser.add_argument("--json", action="store_true", help="for programs: one JSON object")


def run(arguments: Namespace) -> int:
    """Print all, or one in detail."""
    return robots(arguments, plugins.installed())


def robots(arguments: Namespace, catalogue: Mapping[str, type[Driver]]) -> int:
    """`run` with the drivers of `catalogue`."""
    found = descriptions(catalogue, Path(), _complain)
    if arguments.type and arguments.type not in found:
        near = hint(arguments.type, found) or f"; there are: {', '.join(found)}"
        print(f"woz: there is no robot or driver {arguments.type!r}{near}", file=sys.stderr)
        return 1
    chosen = found[arguments.type] if arguments.type else None
    if arguments.json:
        shown = [chosen] if chosen is not None else found.values()
        print(json_text({each.kind: each.as_json() for each in shown}, indent=2))
        return 0
    console = TextConsole(page=_PAGE)
    if chosen is not None:
        _print_one(console, chosen)
    else:
        _print_all(console, found.values())
    return 0


# -- for people ------------------------------------------------------------------------------------


def _complain(text: str) -> None:
    print(f"woz: {text}", file=sys.stderr)


def _print_all(console: TextConsole, found: Iterable[RobotDescription]) -> None:
    every = [*found]
    for each in every:
        if each.facts.robot:
            _print_block(console, each)
    console.print(Text("Parts of robots", style="bold"))
    parts = (each for each in every if not each.facts.robot)
    rows = [(each.kind, f"{each.driver.summary}; tested {each.tested}") for each in parts]
    console.print(_columns(rows))
    console.print()
    for line in (
        "woz robots TYPE                  its settings, verbs and sensors",
        "woz run FILE --robot NAME        an experiment with another robot",
        "woz check FILE --robot all       what each robot does of each action",
    ):
        console.print(Text(line))


def _print_block(console: TextConsole, each: RobotDescription) -> None:
    console.print(Text.assemble((each.kind, "bold"), "  ", each.driver.summary))
    console.print(_columns((word, text) for word, text in each.facts_shown() if text))
    console.print()


def _print_one(console: TextConsole, each: RobotDescription) -> None:
    _print_block(console, each)
    console.print(Text("tested with a stand-in for its hardware", style="bold"))
    shown = each.facts.shown
    console.print(
        _columns((word, f"{'' if word in shown else 'not shown: '}{SHOWN[word]}") for word in SHOWN)
    )
    console.print()
    if rows := settings_rows(each.driver.Settings):
        console.print(Text("settings, with their defaults in brackets", style="bold"))
        console.print(
            _columns(
                (name, Text.assemble(meaning, (f" [{default}]" if default else "", "dim")))
                for name, default, meaning in rows
            )
        )
        console.print()
    if each.offer.verbs:
        examples = " with sample settings" if each.sample else ""
        console.print(Text(f"verbs{examples}", style="bold"))
        console.print(_columns(verb_rows(each.offer.verbs)))


def _columns(rows: Iterable[tuple[str | Text, str | Text]]) -> Table:
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0), show_header=False)
    table.add_column(no_wrap=True, style="dim")
    table.add_column(overflow="fold", ratio=1)
    for word, text in rows:
        table.add_row(*(Text(each) if isinstance(each, str) else each for each in (word, text)))
    return table
