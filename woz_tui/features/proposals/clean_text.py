"""Sentences that somebody else wrote, as they may be offered."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterator

from woz_tui.protocol.envelope import Json

#: Characters and items that are offered at the most.
LONGEST, MOST = 200, 3
#: Categories of characters that nobody sees, and that could change how a text is read or shown.
_UNSEEN = frozenset(("Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp"))


def cleaned(text: str) -> str:
    """On one line, without control characters and those that turn the direction of writing."""
    kept = (" " if unicodedata.category(sign) in _UNSEEN else sign for sign in text)
    return " ".join("".join(kept).split())


def is_question(text: str) -> bool:
    """Whether a sentence of it asks something."""
    return any(sign in text for sign in "?\uff1f\u061f")


def without_variables(value: Json) -> Json:
    """With the braces of its texts doubled: they are said as they are read."""
    if isinstance(value, str):
        return value.replace("{", "{{").replace("}", "}}")
    if isinstance(value, list):
        return [without_variables(each) for each in value]
    if isinstance(value, dict):
        return {name: without_variables(each) for name, each in value.items()}
    return value


def texts_of(value: Json) -> Iterator[str]:
    """All texts in a value, names of fields too."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, list | dict):
        parts = [*value, *value.values()] if isinstance(value, dict) else value
        for each in parts:
            yield from texts_of(each)
