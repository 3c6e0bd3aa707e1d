"""What a text for ALAnimatedSpeech says and does: words, pauses, animations, tags of the voice.

Not shared with what the driver knows of tags (`woz_drivers.pepper.tags`), on purpose: this is the
far end of the wire, and takes what a Pepper takes, whatever the driver lets through.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace

#: Letters a second at speed 100, about three words.
LETTERS_PER_S = 15.0
# Blanks around a value are taken off afterwards: beside them, the search would take hours.
_TAG = re.compile(r"\\\s*([a-z]+)\s*(?:=([^\\]*))?\\", re.IGNORECASE)
_RUN = re.compile(r"\^([A-Za-z]+)\(((?:[^()]|\([^()]*\))*)\)")
_RANGES = {"vct": (50, 200), "rspd": (50, 400), "vol": (0, 100), "pau": (0, 65535)}


@dataclass(frozen=True, slots=True)
class Manner:
    """How it is said, in percent: pitch, speed, volume."""

    vct: int = 100
    rspd: int = 100
    vol: int = 100


@dataclass(frozen=True, slots=True)
class Words:
    """Words said in one manner."""

    text: str
    manner: Manner

    def seconds(self, speed: float) -> float:
        """How long they take at the voice's own speed in percent."""
        return len(self.text) / LETTERS_PER_S / (self.manner.rspd / 100) / (speed / 100)


@dataclass(frozen=True, slots=True)
class Pause:
    """Silence in seconds."""

    seconds: float


@dataclass(frozen=True, slots=True)
class Animate:
    """What is done with an animation: run, start, stop, wait, and `runTag` and so on."""

    how: str
    path: str


Piece = Words | Pause | Animate


def plain(text: str) -> list[Piece]:
    """The pieces of a text for ALTextToSpeech, which knows no animations."""
    return list(_voiced(text, Manner()))


def animated(text: str) -> list[Piece]:
    """The pieces of a text for ALAnimatedSpeech; a tag's effect lasts until the end or a reset."""
    pieces: list[Piece] = []
    manner, position = Manner(), 0
    for match in [*_RUN.finditer(text), None]:
        end = match.start() if match else len(text)
        pieces += _voiced(text[position:end], manner)
        manner = _manner_after(text[position:end], manner)
        if match:
            pieces.append(Animate(match[1], match[2].strip()))
            position = match.end()
    return pieces


def _voiced(text: str, manner: Manner) -> Iterator[Piece]:
    position = 0
    for match in [*_TAG.finditer(text), None]:
        words = text[position : match.start() if match else len(text)].strip()
        if words:
            yield Words(words, manner)
        if match:
            manner = _changed(manner, match)
            if match[1].lower() == "pau":
                yield Pause(_number(match) / 1000)
            position = match.end()


def _manner_after(text: str, manner: Manner) -> Manner:
    for match in _TAG.finditer(text):
        manner = _changed(manner, match)
    return manner


def _changed(manner: Manner, match: re.Match[str]) -> Manner:
    name = match[1].lower()
    if name == "rst":
        return Manner()
    # Tags that are not simulated are not read out either.
    return replace(manner, **{name: _number(match)}) if name in asdict(manner) else manner


def _number(match: re.Match[str]) -> int:
    """The value within its range; 100 when there is none."""
    low, high = _RANGES[match[1].lower()]
    value = (match[2] or "").strip()
    return min(high, max(low, int(value))) if value.isdigit() else 100
