"""Texts on their way to the voice: paragraphs of a file, and how long saying one will take."""

from __future__ import annotations

import re
from pathlib import Path

from woz_drivers.simulated.speech import utterance
from woz_tui.core.driver import Rejected
from woz_tui.core.regular import NotRegularError, open_regular

#: Characters a second at speed 100; only what the console counts down is made of it.
CHARACTERS_A_SECOND = 14.0
#: The longest text file that is read, in bytes: a day of speech.
LONGEST = 1 << 20

_BLANK_LINES = re.compile(r"\n[ \t]*(?:\n[ \t]*)+")


def seconds(text: str, speed: float) -> float:
    """About how long `text` takes at `speed` per cent, its pauses included."""
    return utterance(text, CHARACTERS_A_SECOND * max(speed, 10.0) / 100).seconds


def paragraphs(text: str) -> list[str]:
    """What blank lines part; line breaks inside of a paragraph are spaces."""
    plain = text.replace("\r\n", "\n").replace("\r", "\n")
    found = (" ".join(part.split("\n")).strip() for part in _BLANK_LINES.split(plain))
    return [part for part in found if part]


def read_text(path: Path) -> str:
    """A text file, in UTF-8 or else in Latin-1. Raises `Rejected` for one that cannot be read."""
    try:
        data = _bytes(path)
    except FileNotFoundError:
        raise Rejected(f"there is no file {path}", "put it there, or correct the path") from None
    except (OSError, ValueError) as error:  # ValueError: a name that no file can have
        why = getattr(error, "strerror", None) or error
        raise Rejected(f"{path} cannot be read: {why}", "correct the path") from None
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def _bytes(path: Path) -> bytes:
    """All of a regular file; nothing without an end is read."""
    try:
        with open_regular(path) as file:
            data = file.read(LONGEST + 1)
    except NotRegularError:
        raise Rejected(f"{path} is no text file", "correct the path") from None
    if len(data) > LONGEST:
        raise Rejected(f"{path} is longer than {LONGEST >> 20} MiB", "is it the right one?")
    return data
