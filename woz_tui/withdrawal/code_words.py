"""Finds the code of a participant in texts and names of files."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

#: What stands in the place of a code in a text that is somebody else's.
WITHDRAWN = "[withdrawn]"


class CodeWords:
    """Codes as words: `P07` stands in `2026-03-01_P07_S01` and in *P07 was late*, not in `P071`."""

    def __init__(self, codes: Iterable[str]) -> None:
        self.codes = frozenset(filter(None, codes))
        listed = "|".join(sorted(map(re.escape, self.codes))) or r"(?!)"
        self._words = re.compile(rf"(?<![A-Za-z0-9])(?:{listed})(?![A-Za-z0-9])")
        self._bytes = re.compile(self._words.pattern.encode())

    def within(self, text: str | bytes) -> frozenset[str]:
        """The codes that stand in a text."""
        if isinstance(text, bytes):
            return frozenset(found.decode() for found in self._bytes.findall(text))
        return frozenset(self._words.findall(text))

    def without(self, text: str) -> str:
        """The text with `WITHDRAWN` in the place of each code."""
        return self._words.sub(WITHDRAWN, text)


def is_distinct(code: str) -> bool:
    """Whether the code can be nothing else in a text: it has letters and digits (`P07`), and is
    no number or word (`7`, `anna`).
    """
    return not code.isdigit() and not code.isalpha()


def without_code(name: str, code: str) -> str:
    """The name of a file or folder of a session, without the participant's code."""
    return re.sub(rf"_?(?<![A-Za-z0-9]){re.escape(code)}(?![A-Za-z0-9])", "", name).lstrip("_ ")


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
