"""What stands on an action's key cap."""

from __future__ import annotations

from dataclasses import dataclass

from woz_tui.config.keys.keymap import AssignedKey
from woz_tui.console.drawing.glyphs import Glyphs

_NAMES = {
    "space": "Space",
    "enter": "Enter",
    "tab": "Tab",
    "backspace": "Bksp",
    "delete": "Del",
    "insert": "Ins",
    "home": "Home",
    "end": "End",
    "pageup": "PgUp",
    "pagedown": "PgDn",
    "escape": "Esc",
}
_MODIFIERS = {"ctrl": "^", "alt": "A-", "shift": "S-"}


@dataclass(frozen=True, slots=True)
class KeyCap:
    """A key as the wizard finds it. `reserve`: it stands in for the file's own key, which does
    not arrive from this terminal for the reason `why`. Without any key `chord` is empty.
    """

    chord: str
    reserve: bool = False
    why: str = ""


def cap_of(assigned: AssignedKey) -> KeyCap:
    """The cap for what the key map assigned."""
    return KeyCap(assigned.press, assigned.reserve, assigned.why)


def caption(cap: KeyCap, glyphs: Glyphs) -> str:
    """Short text for a key cap; a reserve key carries a star."""
    text = " ".join(_chord(part, glyphs) for part in cap.chord.split(" ") if part)
    return f"{text}*" if cap.reserve and text else text


def key_name(chord: str, glyphs: Glyphs) -> str:
    """A chord in short, as on key caps and in hints."""
    return caption(KeyCap(chord), glyphs)


def _chord(chord: str, glyphs: Glyphs) -> str:
    if len(chord) == 1:
        return chord
    *modifiers, key = (
        chord.split("+") if not chord.endswith("++") else [*chord[:-2].split("+"), "+"]
    )
    prefix = "".join(_MODIFIERS.get(modifier, f"{modifier}-") for modifier in modifiers)
    if key in ("up", "down", "left", "right"):
        return prefix + str(getattr(glyphs, key))
    if key in _NAMES:
        return prefix + _NAMES[key]
    if key.startswith("f") and key[1:].isdigit():
        return prefix + key.upper()
    return prefix + (key.upper() if prefix == "^" and len(key) == 1 else key)
