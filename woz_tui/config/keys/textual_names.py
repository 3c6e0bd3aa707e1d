"""Textual's names of key events in our normal form. Pure strings: Textual is not imported."""

from __future__ import annotations

import unicodedata

#: Where Textual's name of a character is not Unicode's.
_NAMES = {
    "slash": "/",
    "backslash": "\\",
    "at": "@",
    "minus": "-",
    "plus": "+",
    "underscore": "_",
    "return": "enter",
}
_ORDER = ("ctrl", "alt", "shift")


def from_textual(key: str, character: str | None) -> str:
    """`exclamation_mark` with the character `!` is `!`; `alt+ctrl+a` is `ctrl+alt+a`.

    The result is what a key map's tables are looked up by.
    """
    *held, base = key.split("+") if key != "+" else [key]
    chorded = "ctrl" in held or "alt" in held
    if not chorded and character is not None and len(character) == 1:
        if character == " ":
            base = "space"
        elif character.isprintable():
            return character
    base = _base(base)
    shifted = "shift" in held
    if shifted and not chorded and len(base) == 1:
        upper = base.upper()
        return upper if len(upper) == 1 else base
    return "+".join([*(name for name in _ORDER if name in held), base])


def _base(name: str) -> str:
    if name in _NAMES:
        return _NAMES[name]
    if name.startswith("upper_") and len(name) == 7:
        return name[-1].upper()
    if "_" not in name and name not in _ONE_WORD:
        return name
    try:
        return unicodedata.lookup(name.replace("_", " "))
    except KeyError:
        try:
            return unicodedata.lookup(name.replace("_", "-"))
        except KeyError:
            return name


#: Characters whose Unicode name is one word; other single words are names of keys.
_ONE_WORD = frozenset(
    ("ampersand", "apostrophe", "asterisk", "colon", "comma", "semicolon", "tilde", "diaeresis")
)
