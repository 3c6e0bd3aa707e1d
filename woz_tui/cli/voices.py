"""`woz voices [FILE]`: which voices there are for `say`."""

from __future__ import annotations

import asyncio
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Mapping
from dataclasses import asdict

from rich.table import Table
from rich.text import Text

from woz_tui.cli.error_sentences import with_error_sentences
from woz_tui.cli.safe_streams import json_text
from woz_tui.cli.say import add_speakers, speakers
from woz_tui.console.text_console import TextConsole
from woz_tui.drivers import plugins
from woz_tui.drivers.contract import Driver, Probe, VoiceFound


def add(parser: ArgumentParser) -> None:
    """Declare the command's options."""
    add_speakers(parser)
    parser.add_argument("--language", default="", help="only those of a language, such as de")
    parser.add_argument("--json", action="store_true", help="for programs: a JSON list")


def run(arguments: Namespace) -> int:
    """List them; 0 if there is one."""
    return with_error_sentences(
        lambda: _voices(arguments, plugins.installed()), ValueError, who="woz voices"
    )


def _voices(arguments: Namespace, catalogue: Mapping[str, type[Driver]]) -> int:
    wanted = arguments.language.lower()
    found: dict[VoiceFound, None] = {}
    for one in speakers(arguments, catalogue):
        probe = Probe(one.name, one.settings, one.folder)
        for voice in asyncio.run(one.kind.voices(probe)):
            if voice.language.lower().replace("_", "-").startswith(wanted):
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
        print("no voices found: sudo apt install espeak-ng", file=sys.stderr)
    return 0 if found else 1
