"""Texts without what a terminal would obey: a title, a note or a path may hold any character."""

from __future__ import annotations

import re

#: Control characters (C0 and C1), line and paragraph separators, marks that turn the direction of
#: writing: a terminal acts on them, or shows a text in another order than it stands in.
_OBEYED = "\x00-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069"
_ON_A_LINE = re.compile(f"[{_OBEYED}]")
_ON_LINES = re.compile(f"(?![\t\n])[{_OBEYED}]")


def clean(text: str) -> str:
    """`text` on one line, with a blank for each character that a terminal would obey."""
    return text if text.isprintable() else _ON_A_LINE.sub(" ", text)


def clean_lines(text: str) -> str:
    """As `clean`, but line feeds and tabs stay."""
    return text if text.isprintable() else _ON_LINES.sub(" ", text)


def escaped(json: str) -> str:
    """A JSON text in which such characters are escapes: the same data, and safe to be shown."""
    if json.isprintable():
        return json
    return _ON_LINES.sub(lambda found: f"\\u{ord(found[0]):04x}", json)
