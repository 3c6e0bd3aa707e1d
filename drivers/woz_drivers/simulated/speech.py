r"""How long a sentence takes, and what is left of it without its tags.

Understood are the tags of two families: those with backslashes (`\pau=500\`, `\rspd=80\`,
`\rst\`), with gestures written as `^run(name)`, and SSML (`<break time="500ms"/>`,
`<prosody rate="80%">`).
"""

from __future__ import annotations

import re
from dataclasses import dataclass

# No part may look further than the next tag's beginning: the search has to stay quick in a text of
# nothing but beginnings.
_TAG = re.compile(
    r"""\\(?P<name>[a-z]+)(?:=(?P<value>-?\d+(?:\.\d+)?))?\\
      | \^(?:run|start|stop|wait|mode|runTag|startTag)\([^()]*\)
      | <break\s+time=["'](?P<time>\d+(?:\.\d+)?)(?P<unit>ms|s)["']\s*/?>
      | <prosody\s(?>[^<>]*?rate=["'](?P<rate>\d+(?:\.\d+)?)%["'])[^<>]*>
      | (?P<reset></prosody>)
      | </?[a-zA-Z][^<>]*>""",
    re.VERBOSE,
)

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
    parts: list[str] = []
    seconds = pauses = 0.0
    rate = 1.0
    position = 0
    for tag in _TAG.finditer(tagged):
        part = tagged[position : tag.start()]
        position = tag.end()
        parts.append(part)
        seconds += len(part.strip()) / (characters_per_second * rate)
        pauses += _pause(tag)
        rate = _rate(tag, rate)
    parts.append(tagged[position:])
    seconds += len(parts[-1].strip()) / (characters_per_second * rate)
    text = " ".join(" ".join(parts).split())
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


def _pause(tag: re.Match[str]) -> float:
    if tag["name"] == "pau" and tag["value"]:
        return max(0.0, float(tag["value"])) / 1000
    if tag["time"]:
        return float(tag["time"]) / (1000 if tag["unit"] == "ms" else 1)
    return 0.0


def _rate(tag: re.Match[str], rate: float) -> float:
    value = tag["value"] if tag["name"] == "rspd" else tag["rate"]
    if value:
        return min(max(float(value), SLOWEST), FASTEST) / 100
    return 1.0 if tag["name"] == "rst" or tag["reset"] else rate
