r"""Markup of sentences: the table of what texts for robots' voices have in them beside words.

Two families: tags with backslashes (`\pau=500\`, `\rspd=80\`), as NAOqi robots and Acapela's voices
have them, with gestures of NAOqi robots (`^start(animations/...)`); and SSML (`<break time="1s"/>`,
`<prosody rate="80%">`). A voice says what it can do of it (`Verb.markup`): the rest is taken out
before the text reaches it, else it would read it aloud. A pause stays one: as the voice writes it,
or as a comma.
"""

from __future__ import annotations

import html
import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass

#: What a voice can do of it, and what that is in words.
ABILITIES = {
    "tags": "tags with backslashes",
    "gestures": "gestures within a sentence",
    "ssml": "SSML",
    "pause": "pauses",
    "speed": "changes of speed",
}

#: Seconds of a `<break strength="..."/>`, and of one that says nothing.
_STRENGTHS = {"none": 0.0, "x-weak": 0.0, "weak": 0.25, "strong": 0.75, "x-strong": 1.0}
_BREAK_S = 0.5
#: No pause is longer, in seconds.
_LONGEST_S = 60.0
#: Per cent of a rate that is a word.
_RATES = {"x-slow": "50", "slow": "75", "fast": "150", "x-fast": "200"}
_TAGS = "audio|aud|bound|emph|eos|mrk|pau|prompt|readmode|rmw|rspd|rst|sel|style|toi|vct|vol"
_MOVES = "call|mode|pCall|run|start|stop|wait"
#: Elements around words of a sentence: no gap is left where they are taken out.
_AROUND = frozenset(
    ("emphasis", "lang", "phoneme", "prosody", "say-as", "sub", "token", "voice", "w")
)
_ELEMENTS = (
    "amazon:[a-z-]+|audio|break|desc|emphasis|google:[a-z-]+|lang|lexicon|mark|meta|metadata"
    "|mstts:[a-z-]+|p|phoneme|prosody|s|say-as|speak|ssml|sub|token|voice|w"
)
# No part may look further than the next tag's beginning: the search has to stay quick in a text of
# nothing but beginnings.
_MARK = re.compile(
    rf"""\\(?P<tag>(?i:{_TAGS}))(?:=(?P<value>[^\\\s]*)(?:\\|(?=\s|$))|\\)
      | \^(?P<move>(?:{_MOVES})(?:Sound|Tag)?)\((?:[^()]*\)|[^()\s^]+(?=\s|$))
      | <(?P<close>/?)(?P<element>(?:{_ELEMENTS}))(?P<attributes>(?:[\s/][^<>]*)?)>""",
    re.VERBOSE,
)
_ATTRIBUTE = re.compile(r"""([a-z:-]+)\s*=\s*["']([^"'<>]*)["']""")
_SECONDS = re.compile(r"(\d{1,6}(?:\.\d{0,6})?|\.\d{1,6})\s*(ms|s)")
_NUMBER = re.compile(r"-?\d{1,9}(?:\.\d{0,6})?")


@dataclass(frozen=True, slots=True)
class Mark:
    """One piece of markup in a text.

    Attributes:
        written: As it stands there.
        start: Its place: characters from the beginning.
        family: Which of `ABILITIES` takes it as it is: tags, gestures or ssml.
        pause: Seconds, if it is a pause.
        rate: Per cent of the usual speed from here on, if it sets one; 100 if it sets it back.
        around: Whether it belongs to the words beside it, so that no gap is left without it.
    """

    written: str
    start: int
    family: str
    pause: float | None = None
    rate: float | None = None
    around: bool = False

    @property
    def end(self) -> int:
        """Where the text goes on."""
        return self.start + len(self.written)


def marks(text: str) -> Iterator[Mark]:
    """All markup of a text, in its order."""
    for found in _MARK.finditer(text):
        if found["tag"]:
            yield _mark_of_tag(found)
        elif found["move"]:
            yield Mark(found[0], found.start(), "gestures")
        else:
            yield _mark_of_element(found)


def sentence(text: str) -> str:
    """A text without its markup, as somebody hears it; one without any as it is."""
    return _replaced(text, None)


def for_voice(text: str, can: Collection[str]) -> str:
    """What a voice gets that can do so much of `ABILITIES`: what it cannot do is taken out."""
    return _replaced(text, can)


def left_out(text: str, can: Collection[str]) -> list[Mark]:
    """What a voice cannot do of a text that has something to be heard or seen; each once."""
    found = {
        mark.written: mark
        for mark in marks(text)
        if _kept(mark, can) in ("", _COMMA) and _does_something(mark)
    }
    return [*found.values()]


def pieces(text: str) -> list[tuple[str, float]]:
    """What is said between pauses, each with the seconds of silence behind it; signs without a
    letter or digit stand with the words beside them.
    """
    found: list[tuple[str, float]] = []
    at = 0
    for mark in marks(text):
        if mark.pause is not None:
            found.append((sentence(text[at : mark.start]).strip(), mark.pause))
            at = mark.end
    found.append((sentence(text[at:]).strip(), 0.0))
    if not any(_has_words(said) for said, _ in found):
        return found
    joined: list[tuple[str, float]] = []
    words, signs = -1, ""
    for number, (said, pause) in enumerate(found):
        if _has_words(said):
            words = number
            joined.append((f"{signs} {said}".strip(), pause))
            signs = ""
            continue
        joined.append(("", pause))
        if words < 0:
            signs = f"{signs} {said}".strip()
        elif said:
            joined[words] = (f"{joined[words][0]} {said}", joined[words][1])
    return joined


def _has_words(said: str) -> bool:
    return any(map(str.isalnum, said))


_COMMA = ","
#: What stands at the end of a word: no gap is left before it.
_CLOSING = frozenset(".,;:!?)")


def _mark_of_tag(found: re.Match[str]) -> Mark:
    name, value = found["tag"].lower(), found["value"] or ""
    number = float(value) if _NUMBER.fullmatch(value) else None
    mark = Mark(found[0], found.start(), "tags")
    match name:
        case "pau":
            pause = min(max(number or 0.0, 0.0) / 1000, _LONGEST_S)
            return Mark(mark.written, mark.start, "tags", pause=pause)
        case "rspd" if number is not None:
            return Mark(mark.written, mark.start, "tags", rate=number)
        case "rst":
            return Mark(mark.written, mark.start, "tags", rate=100.0)
    return mark


def _mark_of_element(found: re.Match[str]) -> Mark:
    name, around = found["element"], found["element"] in _AROUND
    given = dict(_ATTRIBUTE.findall(found["attributes"]))
    pause = rate = None
    if name == "break" and not found["close"]:
        pause = _STRENGTHS.get(given.get("strength", ""), _BREAK_S)
        if time := _SECONDS.fullmatch(given.get("time", "").strip()):
            pause = min(float(time[1]) / (1000 if time[2] == "ms" else 1), _LONGEST_S)
    elif name == "prosody" and found["close"]:
        rate = 100.0
    elif name == "prosody" and "rate" in given:
        percent = _RATES.get(given["rate"], given["rate"].removesuffix("%"))
        rate = float(percent) if _NUMBER.fullmatch(percent) else None
    return Mark(found[0], found.start(), "ssml", pause, rate, around)


def _does_something(mark: Mark) -> bool:
    """Frames such as `<speak>`, ends of elements and what sets the speed back say nothing alone."""
    if mark.family == "ssml":
        begins = not mark.written.startswith(("</", "<speak", "<ssml", "<p>", "<s>"))
        return begins and mark.pause != 0
    return mark.rate != 100.0 and mark.pause != 0


def _kept(mark: Mark, can: Collection[str]) -> str:
    if mark.family in can:
        return mark.written
    if mark.pause is not None:
        if "tags" in can or "pause" in can:
            return rf"\pau={mark.pause * 1000:.0f}" + "\\"
        if "ssml" in can:
            return f'<break time="{mark.pause * 1000:.0f}ms"/>'
        return _COMMA if mark.pause else ""
    if mark.rate is not None and ("tags" in can or "speed" in can):
        return r"\rst" + "\\" if mark.rate == 100.0 else rf"\rspd={mark.rate:g}" + "\\"
    return ""


def _replaced(text: str, can: Collection[str] | None) -> str:
    """The text for a voice that can do so much; None: for nobody, and without pauses."""
    made, at, whole = "", 0, True
    for mark in marks(text):
        made += text[at : mark.start]
        at, new = mark.end, "" if can is None else _kept(mark, can)
        if new == mark.written:
            made += new
            continue
        whole = False
        if new == _COMMA:  # only between words: a pause behind a full stop is one already
            made = made.rstrip()
            made += (_COMMA if made[-1:].isalnum() and text[at:].strip() else "") + " "
        elif new:
            made += new
        elif text[at : at + 1] in _CLOSING:
            made = made.rstrip()
        elif not mark.around:
            made += " "
    made += text[at:]
    if whole:
        return text
    made = " ".join(made.split())
    return html.unescape(made) if "<speak" in text and "<speak" not in made else made
