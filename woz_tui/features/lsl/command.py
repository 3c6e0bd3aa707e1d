"""`woz lsl`: send a running session to a lab's recorder, and take other programs' streams."""

from __future__ import annotations

import asyncio
import contextlib
import sys
from argparse import ArgumentParser, Namespace
from functools import partial
from typing import Any

from woz_tui.cli.error_sentences import CommandErrors
from woz_tui.cli.session_choice import add_session_choice, joined_session
from woz_tui.client import WozError, connect
from woz_tui.features.lsl.library import LslMissingError, load, version
from woz_tui.features.lsl.program import SessionSender, adopted_in

ERRORS = CommandErrors(LslMissingError, WozError)


def add(parser: ArgumentParser) -> None:
    add_session_choice(parser, "session")


def run(arguments: Namespace) -> int:
    """Send the session until it ends, or until ctrl+c."""
    lsl = load()
    with joined_session(arguments.access, arguments.session, "woz lsl") as session:
        if session is None:
            return 1
        with contextlib.suppress(KeyboardInterrupt):
            asyncio.run(_send(lsl, str(session.path)))
    return 0


async def _send(lsl: Any, path: str) -> None:
    say = partial(print, file=sys.stderr, flush=True)
    say(f"woz lsl: {version(lsl)}; ctrl+c ends it, the session goes on")
    async with connect(path, name="lsl", samples=True, sees="wizard") as client:
        if "conditions" not in adopted_in(client).shares:
            await SessionSender(lsl, client, say).run()
            return
    async with connect(path, name="lsl", samples=True) as client:
        await SessionSender(lsl, client, say).run()
