"""`woz schema`: the JSON Schema of experiment or robot files, for editors."""

from __future__ import annotations

import argparse
import json
import sys

from woz_tui import plugins
from woz_tui.experiment.schema import experiment_schema, robot_schema


def add(parser: argparse.ArgumentParser) -> None:
    """Declare the command's options."""
    parser.add_argument(
        "--robot", action="store_true", help="of robot files instead of experiment files"
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Print the schema for the drivers that are installed."""
    try:
        catalogue = plugins.installed()
        schema = robot_schema(catalogue) if arguments.robot else experiment_schema(catalogue)
    except plugins.PluginError as error:
        print(f"woz schema: {error}", file=sys.stderr)
        return 1
    print(json.dumps(schema, indent=2, ensure_ascii=False))
    return 0
