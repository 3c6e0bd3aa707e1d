"""`woz voices [FILE]`: which voices there are for `say`."""

from __future__ import annotations

import asyncio
import sys
from argparse import ArgumentParser, Namespace
from dataclasses import asdict

from rich.table import Table
from rich.text import Text

from woz_tui.cli.error_sentences import CommandErrors
from woz_tui.cli.safe_streams import json_text
from woz_tui.cli.say import Speaker, add_speakers, speakers
from woz_tui.console.drawing.text_console import TextConsole
from woz_tui.drivers import plugins
from woz_tui.drivers.contract import Driver, Probe, VoiceFound

ERRORS = CommandErrors(ValueError, who="woz voices")


def add(parser: ArgumentParser) -> None:
    add_speakers(parser)
    parser.add_argument(
        "--language",
        dest="spoken",  # errors are told in the screen's `language`
        metavar="LANGUAGE",
        default="",
        help="only those of a language, such as de",
    )
    parser.add_argument("--json", action="store_true", help="for programs: a JSON list")


def run(arguments: Namespace) -> int:
    """List them; 0 if there is one."""
    wanted = arguments.spoken.lower()
    found: dict[VoiceFound, None] = {}
    languages: set[str] = set()
    asked = speakers(arguments, plugins.installed())
    for one in asked:
        probe = Probe(one.name, one.settings, one.folder)
        for voice in asyncio.run(one.kind.voices(probe)):
            language = voice.language.lower().replace("_", "-")
            languages.add(language.partition("-")[0])
            if language.startswith(wanted):
                found[voice] = None
    if arguments.json:
        print(json_text([asdict(voice) for voice in found], indent=2))
    elif found:
        table = Table(box=None, padding=(0, 2, 0, 0))
        for heading in ("engine", "voice", "language", ""):
            table.add_column(heading, overflow="fold")
        for voice in found:
            table.add_row(*map(Text, (voice.engine, voice.name, voice.language, voice.detail)))
        TextConsole(page=100).print(table)
    else:
        print(_why_none(arguments, asked, languages), file=sys.stderr)
    return 0 if found else 1


def _why_none(arguments: Namespace, asked: list[Speaker], languages: set[str]) -> str:
    """Why there is nothing to list, and what helps. `languages`: of all voices that there are."""
    if languages:
        there = ", ".join(sorted(languages - {""})) or "voices whose language is unknown"
        return f"no voice speaks {arguments.spoken!r}; there are: {there}"
    if not asked:
        return f"no driver of {arguments.experiment} speaks"
    none = getattr(Driver.voices, "__func__", None)  # a driver without a list of its own has this
    silent = [one.name for one in asked if getattr(one.kind.voices, "__func__", None) is none]
    if len(silent) == len(asked):
        return f"{' and '.join(silent)}: this robot does not list its voices"
    return "no voices found: sudo apt install espeak-ng"
