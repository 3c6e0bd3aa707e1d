"""The ids of the console's keys, for docs/how-to/keymap.md."""

from __future__ import annotations

from tools import replaced
from woz_tui.config.keys import BUILTIN_KEYS


def refreshed(page: str) -> str:
    """The page with its table of today."""
    rows = [
        f"| `{item.id}` | `{item.chord.replace('|', chr(92) + '|')}` | {item.description}"
        f" | {'yes' if item.yields else ''} |"
        for item in BUILTIN_KEYS
        if item.movable
    ]
    return replaced(
        page, "keys", "\n".join(("| id | key | does | gives way |", "|---|---|---|---|", *rows))
    )
