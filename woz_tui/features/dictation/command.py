"""`woz dictate`: the wizard's own voice becomes text in the field of `say`.

arecord -q -t raw -f S16_LE -r 16000 -c 1 | ssh robot woz dictate --experiment study.yaml
"""

from __future__ import annotations

import asyncio
import contextlib
import sys
import tempfile
from argparse import ArgumentParser, Namespace
from functools import partial
from pathlib import Path

from woz_tui.cli.argument_types import number
from woz_tui.cli.error_sentences import CommandErrors
from woz_tui.cli.session_choice import add_session_choice, joined_session
from woz_tui.client import WozConnectionError, WozError, connect
from woz_tui.config.loading import load
from woz_tui.drivers.contract import FileTranscriber
from woz_tui.drivers.plugins import installed
from woz_tui.features.dictation.dictating import Dictating


class NoTranscriberError(Exception):
    """Why nothing turns the voice into text."""


ERRORS = CommandErrors(NoTranscriberError, WozError)


def add(parser: ArgumentParser) -> None:
    """Declare the command's options."""
    add_session_choice(parser, "session")
    parser.add_argument(
        "--experiment",
        type=Path,
        metavar="FILE",
        help="use the recogniser that a microphone of this experiment has",
    )
    parser.add_argument(
        "--transcribe",
        default="",
        metavar="COMMAND",
        help="or this program, which writes the text of the WAV file {file} to stdout",
    )
    parser.add_argument(
        "--threshold",
        type=number(0, 1),
        default=0.02,
        help="louder than this RMS (0 to 1) is speech (default: 0.02)",
    )


def run(arguments: Namespace) -> int:
    """Dictate until the voice or the session ends, or until ctrl+c."""
    if sys.stdin is None or sys.stdin.isatty():
        print(
            "woz dictate: the voice is read from standard input:"
            " arecord -q -t raw -f S16_LE -r 16000 -c 1 | woz dictate --experiment study.yaml",
            file=sys.stderr,
        )
        return 2
    with (
        tempfile.TemporaryDirectory(prefix="woz-dictate-") as folder,
        joined_session(arguments.access, arguments.session, "woz dictate") as session,
    ):
        if session is None:
            return 1
        with contextlib.suppress(KeyboardInterrupt):
            asyncio.run(_dictate(str(session.path), arguments, Path(folder)))
    return 0


def transcriber_of(arguments: Namespace, folder: Path) -> FileTranscriber:
    """What the options name. Raises `NoTranscriberError`, `ExperimentError`."""
    catalogue = installed()
    if arguments.transcribe:
        kind = catalogue["microphone"]
        settings = kind.Settings(transcribe=arguments.transcribe)
        for _, message in settings.problems():
            raise NoTranscriberError(f"--transcribe {message}")
        made = kind.transcriber(settings, folder)
        assert made is not None
        return made
    if arguments.experiment is None:
        raise NoTranscriberError(
            "what turns the voice into text? --experiment FILE takes the recogniser of its"
            " microphone, --transcribe names a program"
        )
    for spec in load(arguments.experiment, catalogue).drivers:
        kind = catalogue[spec.type]
        if (made := kind.transcriber(spec.settings, folder)) is not None:
            return made
    raise NoTranscriberError(
        f"{arguments.experiment} has no microphone with transcribe: or resident_transcriber:;"
        " --transcribe names a program"
    )


async def _dictate(path: str, arguments: Namespace, folder: Path) -> None:
    say = partial(print, file=sys.stderr, flush=True)
    transcriber = transcriber_of(arguments, folder)
    try:
        async with connect(path, name="dictate", sees="wizard") as client:
            work = Dictating(client, transcriber, folder, say, arguments.threshold)
            with contextlib.suppress(WozConnectionError):
                await work.run(sys.stdin.buffer)
    finally:
        await transcriber.close()
