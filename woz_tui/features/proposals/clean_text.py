"""Sentences that somebody else wrote, as they may be offered."""

from __future__ import annotations

import unicodedata

#: Characters and items that are offered at the most.
LONGEST, MOST = 200, 3
#: Categories of characters that nobody sees, and that could change how a text is read or shown.
_UNSEEN = frozenset(("Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp"))


def cleaned(text: str) -> str:
    """On one line, without control characters and those that turn the direction of writing."""
    kept = (" " if unicodedata.category(sign) in _UNSEEN else sign for sign in text)
    return " ".join("".join(kept).split())


def without_variables(text: str) -> str:
    """With its braces doubled: it is said as it is read."""
    return text.replace("{", "{{").replace("}", "}}")
