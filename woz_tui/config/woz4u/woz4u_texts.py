"""Texts of a WoZ4U file, which were written for a web page and for no templates."""

from __future__ import annotations

import html
import re
from html.entities import html5

from woz_tui.config.problems import quoted
from woz_tui.config.yaml_cursor import Cursor

_ENTITY = re.compile(r"&(#\d{1,7}|#[xX][0-9a-fA-F]{1,6}|[A-Za-z][A-Za-z0-9]{0,31});")


def decoded(cursor: Cursor, text: str) -> str:
    """`text` with its HTML entities as characters; a warning names those that there are not."""
    unknown: dict[str, None] = {}

    def character(match: re.Match[str]) -> str:
        found = _character(match[0], match[1])
        if found is None:
            unknown.setdefault(match[0])
            return match[0]
        return found

    made = _ENTITY.sub(character, text)
    if unknown:
        many = len(unknown) > 1
        what = "no HTML entities; they stay as they are" if many else "no HTML entity; it stays"
        cursor.warning(f"{', '.join(quoted(word) for word in unknown)}: {what}")
    return made


def _character(entity: str, name: str) -> str | None:
    """What an entity stands for, or None if it is none or nothing that can stand in a text."""
    if not name.startswith("#") and f"{name};" not in html5:
        return None
    found = html.unescape(entity)
    return None if found in ("", entity, "\ufffd") else found


def literal(text: str) -> str:
    """`text` so that our templates give it back as it is: braces doubled."""
    return text.replace("{", "{{").replace("}", "}}")


def one_line(text: str) -> str:
    """What stands on a button: printable, on one line."""
    return " ".join("".join(sign if sign.isprintable() else " " for sign in text).split())
