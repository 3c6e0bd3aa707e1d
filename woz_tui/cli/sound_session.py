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
from woz_tui.client.sound_client import SoundClient, SoundEndError

#: How often the line with the delay comes again where nothing else changes, in seconds.
REPORT_S = 10.0
#: A robot process that has not answered for so long is told of, in seconds.
LATE_S = 2.0


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
                again = end.gone and session.comes_back(lambda text: status.show(text, text), idle)
                if not again:
                    return print_end(
                        command, SoundEndError(session.barred) if session.barred else end
                    )
                status.show("back", "the line is back")
    return 1


def print_end(command: str, end: SoundEndError) -> int:
    """Print why there is no sound, and what helps; the exit code."""
    print(f"{command}: {end}", file=sys.stderr)
    if end.remedy:
        print(f"  {end.remedy}", file=sys.stderr)
    return end.code


class StatusLine:
    """What a person reads on standard error: at once when it is about another thing, and again
    after a while.
    """

    def __init__(self, who: str) -> None:
        self._who = who
        self._about = ""
        self._due = 0.0

    def show(self, about: str, text: str) -> None:
        """`text` is about `about`: `sound`, `no sound` ..."""
        now = time.monotonic()
        if about == self._about and now < self._due:
            return
        self._about, self._due = about, now + REPORT_S
        print(f"{self._who}: {text}", file=sys.stderr, flush=True)

    def late(self, client: SoundClient) -> None:
        """Say so if the robot process stands still."""
        if client.asked_at is not None and time.monotonic() - client.asked_at > LATE_S:
            seconds = time.monotonic() - client.asked_at
            self.show("late", f"the robot process has not answered for {seconds:.0f} s")


def add_sound(parser: ArgumentParser, what: str) -> None:
    """Declare which session, and which of its drivers."""
    add_session_choice(parser)
    parser.add_argument("--on", default="", metavar="DRIVER", help=f"whose {what} (default: first)")
