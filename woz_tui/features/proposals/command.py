"""`woz suggest`: ask a language model for sentences that the wizard may take."""

from __future__ import annotations

import asyncio
import contextlib
import os
import stat
import sys
from argparse import ArgumentParser, Namespace
from functools import partial
from pathlib import Path

from woz_tui.cli.error_sentences import CommandErrors
from woz_tui.cli.session_choice import add_session_choice, joined_session
from woz_tui.client import WozError, connect
from woz_tui.features.proposals.addresses import KEY
from woz_tui.features.proposals.model_program import ModelProgram, held_model


class KeyFileError(Exception):
    """Why a file with a key is not used."""


ERRORS = CommandErrors(KeyFileError, WozError)


def add(parser: ArgumentParser) -> None:
    add_session_choice(parser, "session")
    parser.add_argument(
        "--key-file", type=Path, help=f"a file (mode 600) with the server's key; else ${KEY}"
    )


def run(arguments: Namespace) -> int:
    """Ask until the session ends, or until ctrl+c."""
    key = read_key(arguments.key_file) if arguments.key_file else os.environ.get(KEY, "")
    with joined_session(arguments.access, arguments.session, "woz suggest") as session:
        if session is None:
            return 1
        with contextlib.suppress(KeyboardInterrupt):
            return asyncio.run(_ask(str(session.path), key))
    return 0


def read_key(path: Path) -> str:
    """A key that nobody else can read. Raises `KeyFileError`."""
    try:
        mode = path.stat().st_mode
        text = path.read_text().strip()
    except OSError as error:
        raise KeyFileError(f"{path}: {error.strerror}") from error
    if mode & (stat.S_IRWXG | stat.S_IRWXO):
        raise KeyFileError(f"{path} can be read by others: chmod 600 {path}")
    return text


async def _ask(path: str, key: str) -> int:
    say = partial(print, file=sys.stderr, flush=True)
    async with connect(path, name="suggest", sees="wizard") as client:
        if held_model(client) is None:
            say("woz suggest: the file names no model; add suggest: {model: {}} to it")
            return 1
        limits = client.welcome.settings.study.perception
        if "transcript" in (*limits.hide, *limits.blur):
            say("woz suggest: the wizard may not read what is said, so no model gets it either")
            return 1
        await ModelProgram(client, key, say).run()
    return 0
