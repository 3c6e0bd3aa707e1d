"""Sound, and programs that make and play it on a machine without a sound card.

As a script: `sound.py synthesise|play|speak JOURNAL ...` behaves like espeak-ng or aplay and writes
what it was told, one JSON object a line, to the file JOURNAL.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import struct
import sys
import time
import wave
from pathlib import Path

RATE = 16_000

#: Sound made by the fake synthesiser, in seconds a character.
SECONDS_A_LETTER = 0.01


def square(seconds: float, level: float) -> bytes:
    """S16_LE mono at `RATE` whose RMS is `level` in every block: a square wave."""
    half = (
        struct.pack("<h", round(level * 32768)) * 4 + struct.pack("<h", -round(level * 32768)) * 4
    )
    return half * round(seconds * RATE / 8)


def journal_entries(journal: Path, what: str = "") -> list[dict[str, object]]:
    """What the scripts wrote to the journal, all or those that `do` one thing."""
    if not journal.exists():
        return []
    lines = [json.loads(line) for line in journal.read_text().splitlines()]
    return [line for line in lines if not what or line["do"] == what]


def _tell(journal: Path, **what: object) -> None:
    with journal.open("a") as file:
        file.write(json.dumps({**what, "pid": os.getpid()}) + "\n")


def _synthesise(options: argparse.Namespace) -> None:
    text = sys.stdin.read() if options.text is None else options.text
    _tell(options.journal, do="synthesise", text=text, voice=options.voice)
    time.sleep(options.delay)
    frames = math.ceil(len(text.strip()) * SECONDS_A_LETTER * RATE)
    file = sys.stdout.buffer if options.wav is None else str(options.wav)
    with wave.open(file, "wb") as out:
        out.setnchannels(1)
        out.setsampwidth(2)
        out.setframerate(RATE)
        out.writeframesraw(square(frames / RATE, 0.5))


def _play(options: argparse.Namespace) -> None:
    with wave.open(str(options.wav)) as file:
        seconds = file.getnframes() / file.getframerate()
        peak = max(struct.unpack("<h", file.readframes(1))) if file.getnframes() else 0
    _tell(options.journal, do="play", wav=str(options.wav), seconds=seconds, peak=peak)
    if options.fail:
        print("progress...", file=sys.stderr)  # noqa: T201 - what a program says when it fails
        print(options.fail, file=sys.stderr)  # noqa: T201
        sys.exit(1)
    time.sleep(1000.0 if options.hang else seconds)
    _tell(options.journal, do="played")


def _speak(options: argparse.Namespace) -> None:
    text = sys.stdin.read() if options.text is None else options.text
    _tell(options.journal, do="speak", text=text, volume=options.volume)


def _main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("what", choices=("synthesise", "play", "speak"))
    parser.add_argument("journal", type=Path)
    parser.add_argument("--text")
    parser.add_argument("--wav", type=Path)
    parser.add_argument("--voice", default="")
    parser.add_argument("--volume", default="")
    parser.add_argument("--delay", type=float, default=0.0)
    parser.add_argument("--fail", default="")
    parser.add_argument("--hang", action="store_true")
    options = parser.parse_args()
    {"synthesise": _synthesise, "play": _play, "speak": _speak}[options.what](options)


if __name__ == "__main__":
    _main()
