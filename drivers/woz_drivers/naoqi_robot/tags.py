r"""The tags of an utterance, and sentences about those that the robot does not understand.

Two families: `\rspd=80\\` changes the voice from there on, `^run(animations/...)` moves the body
meanwhile. A tag that is wrong is told and still sent as it was written: whoever wrote it decides.
Ranges as the manufacturer documents them for ALTextToSpeech and ALAnimatedSpeech.

The simulated robot (`naoqi_simulator.speech`) reads tags by rules of its own, on purpose: it is the
far end, and would otherwise take whatever is let through here, right or wrong.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from woz_drivers.simulated.speech import utterance
from woz_tui.drivers.contract import UNKNOWN, RejectedError
from woz_tui.drivers.fields import Range
from woz_tui.protocol.robot_outline import Tag
from woz_tui.system.files import NotRegularError, open_regular


@dataclass(frozen=True, slots=True)
class VoiceTag:
    r"""A tag `\name=number\`; without a range it takes no number."""

    name: str
    help: str
    range: Range | None = None
    example: str = ""


VOICE_TAGS = {
    tag.name: tag
    for tag in (
        VoiceTag("vct", "pitch of the voice from here on, 50 to 200 %", Range(50, 200, "%"), "100"),
        VoiceTag("rspd", "speed from here on, 50 to 400 %", Range(50, 400, "%"), "80"),
        VoiceTag("pau", "a pause of so many milliseconds", Range(0, 60_000, "ms"), "500"),
        VoiceTag("vol", "volume from here on, 0 to 100 %", Range(0, 100, "%"), "80"),
        VoiceTag("rst", "voice, speed and volume as they were"),
    )
}

#: Moves inside of a sentence; each takes the path of an animation.
MOVE_TAGS = {
    "run": "stop speaking, play this animation, speak on",
    "start": "begin this animation and speak on meanwhile",
    "stop": "end this animation here",
    "wait": "wait until this animation has ended",
}

#: Further tags that the robot takes, whose values nobody checks here.
_VOICE_OTHERS = frozenset(
    ("audio", "bound", "emph", "eos", "mrk", "prompt", "readmode", "rmw", "sel", "style", "toi")
)
_MOVE_OTHERS = frozenset(
    ("call", "mode", "pCall", "runSound", "runTag", "startSound", "startTag", "stopSound")
) | {"stopTag", "waitSound", "waitTag"}
_SLASH = "\\"

_VOICE = re.compile(r"\\(?P<name>[A-Za-z]+)(?:=(?P<value>[^\\\s]*))?(?P<end>\\)?")
_MOVE = re.compile(r"\^(?P<name>[A-Za-z]+)\((?P<value>[^()]*)(?P<end>\))?")


def offered() -> list[Tag]:
    """All tags with their help, for completion in the console."""
    voice = [
        Tag(text=f"\\{tag.name}={tag.example}\\" if tag.range else f"\\{tag.name}\\", help=tag.help)
        for tag in VOICE_TAGS.values()
    ]
    moves = [
        Tag(text=f"^{name}(animations/Stand/Gestures/Hey_1)", help=help_)
        for name, help_ in MOVE_TAGS.items()
    ]
    return [*voice, *moves]


def problems(text: str) -> list[str]:
    """A sentence for each tag in `text` that is unknown, not closed or out of its range."""
    return [sentence for _, sentence in placed(text)]


def placed(text: str) -> list[tuple[int, str]]:
    """The same, each sentence behind the place of its tag: characters from the beginning.

    Where `contract.UNKNOWN` stands in a tag or right behind it, nobody knows how it will read.
    """
    return [
        (match.start(), sentence)
        for pattern, judged in ((_VOICE, _of_voice), (_MOVE, _of_body))
        for match in pattern.finditer(text)
        if UNKNOWN not in text[match.start() : match.end() + 1]
        for sentence in judged(match)
    ]


def _of_voice(match: re.Match[str]) -> Iterator[str]:
    name, value, closed = match["name"], match["value"], match["end"] is not None
    tag_text = match[0]
    tag = VOICE_TAGS.get(name)
    if tag is None:
        if (closed or value is not None) and name not in _VOICE_OTHERS:
            hint = _suggestion(name, VOICE_TAGS, _SLASH)
            yield f"{tag_text} is no tag that the robot knows{hint}"
    elif not closed:
        yield f"the tag {tag_text} is not closed: it needs another backslash behind it"
    elif tag.range is None:
        if value is not None:
            yield f"{tag_text} takes no value: write \\{name}\\"
    elif not _within(value, tag.range):
        yield f"{tag_text} needs a number of {tag.range}, as in \\{name}={tag.example}\\"


def _of_body(match: re.Match[str]) -> Iterator[str]:
    name, value = match["name"], match["value"].strip()
    tag_text = match[0]
    if name not in MOVE_TAGS:
        if name not in _MOVE_OTHERS:
            yield f"{tag_text} is no tag that the robot knows{_suggestion(name, MOVE_TAGS, '^')}"
    elif match["end"] is None:
        yield f"the tag {tag_text} is not closed: it needs a ) behind it"
    elif not value:
        yield f"{tag_text} names no animation, as in ^{name}(animations/Stand/Gestures/Hey_1)"


def _within(value: str | None, allowed: Range) -> bool:
    try:
        return allowed.contains(float(value or "nothing"))
    except ValueError:
        return False


def _suggestion(name: str, names: dict[str, VoiceTag] | dict[str, str], sign: str) -> str:
    near = difflib.get_close_matches(name, names, 1, 0.5)
    return f"; did you mean {sign}{near[0]}?" if near else ""


# -- texts to be spoken ----------------------------------------------------------------------------

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
    parts = (" ".join(part.split("\n")).strip() for part in _BLANK_LINES.split(plain))
    return [part for part in parts if part]


def read_text(path: Path) -> str:
    """A text file, in UTF-8 or else in Latin-1. Raises `RejectedError` for one that
    cannot be read.
    """
    try:
        data = _bytes(path)
    except FileNotFoundError:
        raise RejectedError(
            f"there is no file {path}", "put it there, or correct the path"
        ) from None
    except (OSError, ValueError) as error:  # ValueError: a name that no file can have
        why = getattr(error, "strerror", None) or error
        raise RejectedError(f"{path} cannot be read: {why}", "correct the path") from None
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
        raise RejectedError(f"{path} is no text file", "correct the path") from None
    if len(data) > LONGEST:
        raise RejectedError(
            f"{path} is longer than {LONGEST >> 20} MiB", "check that it is the right file"
        )
    return data
