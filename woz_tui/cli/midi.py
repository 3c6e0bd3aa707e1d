"""`woz midi`: learn which control of a panel does what, and show a map."""

from __future__ import annotations

import os
import select
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rich.table import Table

from woz_tui.cli.argument_types import file_or_word
from woz_tui.cli.error_sentences import CommandErrors
from woz_tui.cli.single_keys import single_keys
from woz_tui.config.annotated_decoder import settings_from_texts
from woz_tui.console.drawing.text_console import TextConsole
from woz_tui.drivers import plugins
from woz_tui.drivers.contract import Driver, DriverError
from woz_tui.system.files import replace

ERRORS = CommandErrors(DriverError)
#: The driver that knows panels.
DRIVER = "midi"
_STANDARD = "nanokontrol2"
_HELP = "s skips, b goes back, q ends"


#: The driver's lesson: `woz_drivers.midi.learning`, which this package must not import.
_Lesson = Any


def add(parser: ArgumentParser) -> None:
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)
    learn = commands.add_parser("learn", help="move each control once; then a map file is written")
    learn.add_argument(
        "file", type=Path, help="map file to write; if it exists, its controls are asked for"
    )
    learn.add_argument(
        "--device", default="", help="the panel: its card's name or a path (default: the first)"
    )
    learn.add_argument(
        "--like",
        type=file_or_word,
        default="",
        metavar="MAP",
        help=f"controls to ask for: nanokontrol2, thesis or a file (default: {_STANDARD})",
    )
    learn.set_defaults(work=_learn)
    show = commands.add_parser("show", help="show what each control sends and does")
    show.add_argument(
        "map",
        nargs="?",
        type=file_or_word,
        default=_STANDARD,
        help="nanokontrol2, thesis or a map file",
    )
    show.add_argument("--yaml", action="store_true", help="as a map file, as a start for your own")
    show.set_defaults(work=_show)


def run(arguments: Namespace) -> int:
    """Learn a panel, or show a map."""
    return int(arguments.work(arguments))


def _panel(catalogue: Mapping[str, type[Driver]]) -> Any:
    if DRIVER not in catalogue:
        raise plugins.PluginError(f"no installed package offers the driver {DRIVER!r}")
    return catalogue[DRIVER]


def _settings(panel: Any, name: str) -> Any:
    return settings_from_texts(panel.Settings, {"map": name}, Path.cwd())


def _show(arguments: Namespace) -> int:
    panel = _panel(plugins.installed())
    settings = _settings(panel, arguments.map)
    if arguments.yaml:
        print(panel.map_file(settings), end="")
        return 0
    table = Table("control", "sends", "does", box=None)
    for row in panel.table(settings):
        table.add_row(*row)
    TextConsole().print(table)
    return 0


# -- learning -----------------------------------------------------------------------------------


def _learn(arguments: Namespace) -> int:
    file: Path = arguments.file
    panel = _panel(plugins.installed())
    relearn = file.exists() and not arguments.like
    settings = _settings(panel, str(file) if relearn else arguments.like or _STANDARD)
    lesson: _Lesson = panel.lesson(arguments.device, settings, keep=relearn)
    try:
        print(f"Learning {file}: {_HELP}.")
        with single_keys():
            _ask_controls(lesson)
        if not lesson.count:
            print("No control was learnt; no file was written.")
            return 1
        replace(file, lesson.text())
    finally:
        lesson.close()
    print(f"{file}: {lesson.count} controls. In the robot file, at the panel: map: {file}")
    return 0


def _ask_controls(lesson: _Lesson) -> None:
    """Ask until all is answered or the wizard has enough."""
    printed = ""
    sources: list[Any] = [lesson, sys.stdin]
    while not lesson.over:
        if lesson.question != printed:
            printed = lesson.question
            print(printed, flush=True)
        ready, _, _ = select.select(sources, [], [])
        if lesson in ready:
            answer = lesson.hear()
            if answer:
                print(f"    {answer}", flush=True)
        if sys.stdin in ready and not _handle_keys(lesson, os.read(sys.stdin.fileno(), 64)):
            return


def _handle_keys(lesson: _Lesson, typed: bytes) -> bool:
    """Do what the keys say; False ends. So does the end of the input."""
    for key in typed.decode("utf-8", "replace").lower():
        if key in "q\x04":
            return False
        if key == "s" and not lesson.over:
            lesson.skip()
        elif key == "b":
            lesson.back()
    return bool(typed)
