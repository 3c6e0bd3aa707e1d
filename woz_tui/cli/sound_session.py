"""What `woz listen` and `woz talk` have in common: which session, and lines on standard error that
a person reads beside the sound.
"""

from __future__ import annotations

import sys
import time
from argparse import ArgumentParser, Namespace
from collections.abc import Callable
from pathlib import Path

from woz_tui.cli.session_choice import add_session_choice, joined_session
from woz_tui.client.sound_client import SoundEndError

#: How often the line with the delay comes again where nothing else changes, in seconds.
REPORT_S = 10.0


def with_session(
    arguments: Namespace,
    command: str,
    run: Callable[[Path], object],
    idle: Callable[[], None],
) -> int:
    """`run` with the chosen session's socket, and again when a lost line is back; the exit code.
    `idle` is called while it is lost, and takes a moment.
    """
    status = StatusLine(command)
    with joined_session(arguments.access, arguments.name, command) as session:
        while session is not None:
            try:
                run(session.path)
                return 0
            except SoundEndError as end:
                again = end.gone and session.comes_back(status.show, idle)
                if again:
                    status.show("back", "the line is back")
                    continue
                if session.barred:
                    end = SoundEndError(session.barred)
                print(f"{command}: {end}", file=sys.stderr)
                if end.remedy:
                    print(f"  {end.remedy}", file=sys.stderr)
                return end.code
    return 1


class StatusLine:
    """What a person reads on standard error: at once when it is about another thing, and again
    after a while.
    """

    def __init__(self, who: str) -> None:
        self._who = who
        self._about = ""
        self._due = 0.0

    def show(self, about: str, text: str = "") -> None:
        """`text` is about `about`: `sound`, `no sound` ...; empty: it says itself."""
        now = time.monotonic()
        if about == self._about and now < self._due:
            return
        self._about, self._due = about, now + REPORT_S
        print(f"{self._who}: {text or about}", file=sys.stderr, flush=True)


def add_sound(parser: ArgumentParser, what: str) -> None:
    """Declare which session, and which of its drivers."""
    add_session_choice(parser)
    parser.add_argument("--on", default="", metavar="DRIVER", help=f"whose {what} (default: first)")
