"""The parts in which a text is made into sound, so that the first of them is heard soon.

A part ends where a speaker may pause: behind a sentence, behind a comma, before a word with which a
clause or a phrase begins. Where there is no such place, it ends between two words.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

#: Between two sentences: behind a sign after a word of three letters or more, so not in "Dr. Who".
_SENTENCE_END = re.compile(r"(?<=[^\W\d_]{3}[.!?])(?<!Prof\.)(?<!Mrs\.) +(?=[^\W\d_])")
#: A part of a sentence has at least so many letters before the cut, and behind it.
_BEFORE, _BEHIND = 6, 8
_PAUSES = (",", ";", ":", "–", "—", ")")  # noqa: RUF001 - dashes of texts
#: Words with which a clause or a phrase begins: English, German, French, Spanish, Italian, Dutch.
_BEGINNINGS = """
after although and as at because before but by for from if in into of on or since so than that
though to until when where which while who with without
als an auf aus bei bevor da dass denn die doch durch für gegen indem mit nach ob obwohl ohne
seit sondern sowie über um und unter von vor während weil wenn wie wo zu zwischen
afin après avant avec car chez comme dans de depuis dont et lorsque mais ou où par parce pendant
pour quand que qui sans si sous sur vers
al antes aunque como con cuando desde después donde en entre hasta para pero por porque según
sin sobre y
che con dopo dove e fra ma mentre nel nella per perché più prima quando se senza tra
bij dat door een het maar met naar om omdat op tot uit van voor waar wanneer want zonder
"""
_BEGINS = frozenset(_BEGINNINGS.split())


def spoken_parts(text: str, first: int, following: Callable[[int], int]) -> list[str]:
    """`text` in parts that are made one after the other, each while the one before it is heard.

    Args:
        text: On one line.
        first: Letters of the first part, at most, where a sentence is longer.
        following: Letters of the next part, at most, after one of so many.
    """
    return [*_parts(text, first, following)]


def goes_on(part: str) -> bool:
    """Whether a part ends within a sentence without a sign: nobody would pause behind it."""
    return part[-1:].isalnum()


def _parts(text: str, first: int, following: Callable[[int], int]) -> Iterator[str]:
    most = first
    for sentence in _SENTENCE_END.split(text):
        left = sentence
        while len(left) > most and (cut := _cut(left, most)):
            yield left[:cut]
            left, most = left[cut + 1 :], following(cut)
        yield left
        most = following(len(left))


def _cut(sentence: str, most: int) -> int:
    """The place of the space at which a sentence is cut; 0: nowhere."""
    spaces = [
        match.start()
        for match in re.finditer(" ", sentence)
        if match.start() >= _BEFORE and len(sentence) - match.start() > _BEHIND
    ]
    near = [at for at in spaces if at <= most] or spaces[:1]
    return max(near, key=lambda at: (_rank(sentence, at), at), default=0)


def _rank(sentence: str, at: int) -> int:
    if sentence[:at].endswith(_PAUSES):
        return 2
    following = sentence[at + 1 :].partition(" ")[0].lower()
    return int(following in _BEGINS)
