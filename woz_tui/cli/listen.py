"""`woz listen`: the robot's microphone on standard output, for `ssh robot woz listen | aplay`."""

from __future__ import annotations

import contextlib
import os
import sys
from argparse import ArgumentParser, Namespace

from woz_tui.cli.sound_session import StatusLine, add_sound, with_session
from woz_tui.client.sound_receiver import SoundReceiver


def add(parser: ArgumentParser) -> None:
    add_sound(parser, "microphone")
    parser.add_argument(
        "--format",
        choices=("wav", "raw"),
        default="wav",
        help="wav, or the bare samples: S16_LE, one channel (default: wav)",
    )


def run(arguments: Namespace) -> int:
    """Write the sound until the session, the listener or the wizard ends it."""
    if sys.stdout is None or sys.stdout.isatty():
        print(
            "woz listen: sound is written to standard output: woz listen | aplay", file=sys.stderr
        )
        return 2
    tell, wav = StatusLine("woz listen").show, arguments.format == "wav"
    receiver = SoundReceiver(sys.stdout.fileno(), arguments.on, wav=wav, tell=tell)
    try:
        return with_session(arguments, "woz listen", receiver.run, receiver.idle)
    except BrokenPipeError:  # nobody listens any more
        with contextlib.suppress(OSError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    return 0
