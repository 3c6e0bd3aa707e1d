"""`woz talk`: a voice from standard input through the robot, while the wizard's key has it on:
`arecord -f S16_LE -r 16000 -c 1 | ssh robot woz talk`.
"""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace

from woz_tui.cli.sound_session import StatusLine, add_sound, with_session
from woz_tui.client.voice_sender import VoiceSender


def add(parser: ArgumentParser) -> None:
    add_sound(parser, "loudspeaker")
    parser.add_argument(
        "--rate",
        type=int,
        default=0,
        metavar="HZ",
        help="of bare samples, S16_LE, one channel (default: what the robot file asks for; a WAV"
        " file says it itself)",
    )


def run(arguments: Namespace) -> int:
    """Send the voice until it ends, or the session does."""
    if sys.stdin is None or sys.stdin.isatty():
        print(
            "woz talk: the voice is read from standard input:"
            " arecord -f S16_LE -r 16000 -c 1 | woz talk",
            file=sys.stderr,
        )
        return 2
    tell = StatusLine("woz talk").show
    sender = VoiceSender(sys.stdin.fileno(), arguments.on, arguments.rate, tell)
    return with_session(arguments, "woz talk", sender.run, sender.idle)
