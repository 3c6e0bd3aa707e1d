"""Texts that look like markup and hold what a terminal obeys, for messages and files."""

from __future__ import annotations

import re
from collections.abc import Container
from typing import Any

#: Markup that would be obeyed or end in an error, and an emoji's code.
MARKUP = "[/x] [bold]b[/bold] [link=http://e.x]l[/link] :smile:"
#: What a terminal obeys: writing into the clipboard (OSC 52), C1 sequences, right to left.
HOSTILE = f"{MARKUP} \x1b]52;c;aGk=\x07 \x9b31m \x1b[2J \u202e\u2066\u200f"
OBEYED = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u2028-\u202e\u2066-\u2069]")
#: Fields of messages whose words mean something to who reads them.
WORDS = frozenset(
    {
        *("kind", "ts", "clock", "experiment_sha256", "sha256", "files", "signs", "source"),
        *("outcome", "reason", "state", "was", "now", "level", "role", "method", "scope"),
    }
)


def hostile(value: Any, words: Container[str] = WORDS, name: str = "") -> Any:
    """`value`, of JSON, with `HOSTILE` behind each text in it but those of the fields `words`."""
    if name in words:
        return value
    match value:
        case str():
            return f"{value} {HOSTILE}" if value else value
        case list():
            return [hostile(each, words) for each in value]
        case dict():
            return {key: hostile(each, words, key) for key, each in value.items()}
    return value
