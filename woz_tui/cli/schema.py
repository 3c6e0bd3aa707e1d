"""`woz schema`: the JSON Schema of experiment, robot, move or map files, for editors."""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from typing import Any

from woz_tui.cli.error_sentences import CommandErrors
from woz_tui.cli.safe_streams import json_text
from woz_tui.config.json_schema import experiment_schema, included_schema, robot_schema
from woz_tui.drivers import plugins
from woz_tui.motion.move_schema import move_schema

ERRORS = CommandErrors(who="woz schema")


def add(parser: ArgumentParser) -> None:
    kind = parser.add_mutually_exclusive_group()
    kind.add_argument("--robot", action="store_true", help="schema of robot files")
    kind.add_argument("--move", action="store_true", help="schema of move files")
    kind.add_argument("--midi", action="store_true", help="schema of MIDI panel maps")


def run(arguments: Namespace) -> int:
    """Print the schema for the drivers that are installed; what is left out is said on stderr."""
    print(json_text(_schema(arguments), indent=2))
    return 0


def _schema(arguments: Namespace) -> dict[str, Any]:
    if arguments.move:
        return move_schema()
    catalogue = plugins.installed()
    if arguments.midi:
        if "midi" not in catalogue:
            raise plugins.PluginError("no installed package offers the driver 'midi'")
        return included_schema(catalogue["midi"], "map")
    usable = {}
    for name in catalogue:  # a broken driver must not take the others' schema away
        try:
            usable[name] = catalogue[name]
        except plugins.PluginError as error:
            _warn(f"left out: {error}")
    return robot_schema(usable) if arguments.robot else experiment_schema(usable, _warn)


def _warn(text: str) -> None:
    print(f"woz schema: {text}", file=sys.stderr)
