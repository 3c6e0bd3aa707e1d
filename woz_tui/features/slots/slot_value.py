"""What may stand in a slot."""

from __future__ import annotations

import unicodedata

from woz_tui.protocol.sentence import Sentence

#: Characters, at the most.
LONGEST = 60
#: What begins a tag of a voice, which would do something instead of being said.
TAGS = "\\^<>"
#: Categories of characters that nobody hears, and that could change how the rest is read or shown.
_UNSEEN = frozenset(("Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp"))


class SlotValueError(ValueError):
    """Why a text cannot stand in a slot."""


def checked_value(text: str) -> str:
    """The text as it is said: on one line, with single blanks. Raises `SlotValueError`."""
    if any(unicodedata.category(sign) in _UNSEEN for sign in text):
        raise SlotValueError(
            Sentence("slots.unseen", "has a character that nobody can see, or a second line")
        )
    value = " ".join(text.split())
    if not value:
        raise SlotValueError(Sentence("slots.is_empty", "is empty"))
    if len(value) > LONGEST:
        raise SlotValueError(
            Sentence(
                "slots.too_long",
                "has {length} characters; {longest} are allowed",
                length=len(value),
                longest=LONGEST,
            )
        )
    if tag := next((sign for sign in value if sign in TAGS), ""):
        raise SlotValueError(
            Sentence("slots.has_tag", "has {tag}, which begins a tag of a voice", tag=tag)
        )
    return value


def tidied(text: str) -> str:
    """A text without what cannot stand in a slot, cut where it is too long; perhaps empty."""
    kept = (" " if unicodedata.category(sign) in _UNSEEN or sign in TAGS else sign for sign in text)
    return " ".join("".join(kept).split())[:LONGEST].rstrip()
