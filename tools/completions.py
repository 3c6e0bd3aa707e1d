"""Makes what completes commands, options and files in shells: `woz_tui/cli/completions`."""

from __future__ import annotations

from argparse import ArgumentParser, _SubParsersAction
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import shtab

from woz_tui.cli import whole_parser
from woz_tui.cli.argument_types import file_or_word

ROOT_PREFIX = "woz"


@cache
def _parser() -> ArgumentParser:
    """Where a value is a path, files are offered."""
    parser = whole_parser()
    for each in _with_commands(parser):
        for action in each._actions:
            if action.type in (Path, file_or_word):
                action.complete = shtab.FILE  # type: ignore[attr-defined]
    return parser


def _with_commands(parser: ArgumentParser) -> Iterator[ArgumentParser]:
    yield parser
    for action in parser._actions:
        if isinstance(action, _SubParsersAction):
            for command in action.choices.values():
                yield from _with_commands(command)


def script(shell: str) -> str:
    """The file's text."""
    text = shtab.complete(_parser(), shell, root_prefix=ROOT_PREFIX)
    return "\n".join(line.rstrip() for line in text.splitlines()) + "\n"
