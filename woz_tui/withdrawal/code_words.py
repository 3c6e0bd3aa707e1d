"""Finds the code of a participant in texts and names of files."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

#: What stands in the place of a code in a text that is somebody else's.
WITHDRAWN = "[withdrawn]"
#: Dates and times of day as logs, names of files and people write them.
_DATE = (
    r"\d{4}-\d\d-\d\d(?:[T _]\d\d[-:]\d\d(?:[-:]\d\d(?:[.,]\d+)?)?)?(?:Z|[+-]\d\d:?\d\d)?"
    r"|\d\d?[./]\d\d?[./]\d{4}|\d\d?:\d\d(?::\d\d(?:[.,]\d+)?)?Z?"
)


class CodeWords:
    """Codes as words: `P07` stands in `2026-03-01_P07_S01` and in *P07 was late*, not in `P071`;
    `03` stands in *03 was late*, not in a date or a time of day.
    """

    def __init__(self, codes: Iterable[str]) -> None:
        self.codes = frozenset(filter(None, codes))
        listed = "|".join(sorted(map(re.escape, self.codes))) or r"(?!)"
        self._words = re.compile(rf"(?<![A-Za-z0-9])(?:{_DATE}|({listed}))(?![A-Za-z0-9])")
        self._bytes = re.compile(self._words.pattern.encode())

    def within(self, text: str | bytes) -> frozenset[str]:
        """The codes that stand in a text."""
        if isinstance(text, bytes):
            return frozenset(found.decode() for found in self._bytes.findall(text) if found)
        return frozenset(filter(None, self._words.findall(text)))

    def without(self, text: str) -> str:
        """The text with `WITHDRAWN` in the place of each code."""
        return self._words.sub(lambda found: WITHDRAWN if found[1] else found[0], text)


def is_distinct(code: str) -> bool:
    """Whether the code can be nothing else in a text: it has letters and digits (`P07`), and is
    no number or word (`7`, `anna`).
    """
    return not code.isdigit() and not code.isalpha()


def texts_in(value: Any) -> Iterator[str]:
    """All texts within a line's fields, names of fields included."""
    match value:
        case str():
            yield value
        case list():
            for item in value:
                yield from texts_in(item)
        case Mapping():
            for name, item in value.items():
                yield name
                yield from texts_in(item)
