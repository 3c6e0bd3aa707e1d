"""How long a sentence takes, and what is left of it without its markup (`protocol.markup`)."""

from __future__ import annotations

import re
from dataclasses import dataclass

from woz_tui.protocol import markup

#: A single word still takes this long, in seconds.
SHORTEST = 0.3

#: Rates a tag may set, in per cent of the normal one; beyond them the limit counts.
SLOWEST, FASTEST = 20.0, 500.0


@dataclass(frozen=True, slots=True)
class Utterance:
    """What is heard, and for how many seconds; 0 if nothing is left without the tags."""

    text: str
    seconds: float


def utterance(tagged: str, characters_per_second: float) -> Utterance:
    """Time `tagged` at so many characters a second; pauses count, rates stretch."""
    seconds = pauses = 0.0
    rate = 1.0
    position = 0
    for mark in markup.marks(tagged):
        part = tagged[position : mark.start]
        position = mark.end
        seconds += len(part.strip()) / (characters_per_second * rate)
        pauses += mark.pause or 0.0
        if mark.rate is not None:
            rate = min(max(mark.rate, SLOWEST), FASTEST) / 100
    seconds += len(tagged[position:].strip()) / (characters_per_second * rate)
    text = " ".join(markup.sentence(tagged).split())
    if not text:
        return Utterance("", 0.0)
    return Utterance(text, max(SHORTEST, seconds) + pauses)


def word_times(spoken: Utterance) -> tuple[tuple[float, str], ...]:
    """When each word begins, in seconds: by its place among the characters."""
    length = max(1, len(spoken.text))
    return tuple(
        (match.start() / length * spoken.seconds, match.group())
        for match in re.finditer(r"\S+", spoken.text)
    )
