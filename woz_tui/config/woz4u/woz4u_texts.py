"""Texts of a WoZ4U file, which were written for a web page and for no templates."""

from __future__ import annotations

import html
import re
from html.entities import html5

from woz_tui.config.problems import quoted
from woz_tui.config.yaml_cursor import Cursor
from woz_tui.protocol.sentence import Sentence

_ENTITY = re.compile(r"&(#\d{1,7}|#[xX][0-9a-fA-F]{1,6}|[A-Za-z][A-Za-z0-9]{0,31});")


def decoded(cursor: Cursor, text: str) -> str:
    """`text` with its HTML entities as characters; a warning names those that there are not."""
    unknown: dict[str, None] = {}

    def character(match: re.Match[str]) -> str:
        entity, name = match[0], match[1]
        known = name.startswith("#") or f"{name};" in html5
        found = html.unescape(entity) if known else entity
        if found in ("", entity, "\ufffd"):  # it is none, or nothing that can stand in a text
            unknown.setdefault(entity)
            return entity
        return found

    made = _ENTITY.sub(character, text)
    if unknown:
        words = ", ".join(quoted(word) for word in unknown)
        cursor.warning(
            Sentence(
                "woz4u.no_entities",
                "{words}: no HTML entities; they stay as they are",
                one="{words}: no HTML entity; it stays",
                words=words,
                count=len(unknown),
            )
        )
    return made


def literal(text: str) -> str:
    """`text` so that our templates give it back as it is: braces doubled."""
    return text.replace("{", "{{").replace("}", "}}")


def one_line(text: str) -> str:
    """What stands on a button: printable, on one line."""
    return " ".join("".join(sign if sign.isprintable() else " " for sign in text).split())
