"""Keyboard layouts: which characters a wizard's keyboard gives, with and without shift.

A layout matters because a terminal sends characters, not keys: shift+2 is `@` on an American
keyboard, `"` on a British, German or Spanish one, and `2` itself on a French one. Keys are always
meant by their character. (Those who think in positions must remember that a German keyboard has
y and z the other way round, and a French one a/q, z/w and m.)
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import msgspec


@dataclass(frozen=True, slots=True)
class KeyboardLayout:
    """One keyboard: the characters of its keys without (`plain`) and with shift, key by key, those
    that need AltGr, and accent keys (`dead`), which send nothing until the next key is pressed.
    """

    name: str
    plain: str
    shifted: str
    altgr: str = ""
    dead: str = ""

    def gives(self, character: str) -> bool:
        """Whether some key gives this character, with shift or AltGr if need be."""
        return character in f" {self.plain}{self.shifted}{self.altgr}"

    def with_shift(self, character: str) -> str:
        """What shift makes of a key's character."""
        key = self.plain.find(character)
        upper = character.upper()
        return self.shifted[key] if key >= 0 else upper if len(upper) == 1 else character

    def without_shift(self, character: str) -> str | None:
        """The key that gives this character with shift; None: there is none."""
        key = self.shifted.find(character)
        return self.plain[key] if key >= 0 else None


LAYOUTS: Mapping[str, KeyboardLayout] = {
    layout.name: layout
    for layout in msgspec.json.decode(
        Path(__file__).with_name("keyboard_layouts.json").read_bytes(),
        type=tuple[KeyboardLayout, ...],
    )
}


def layout_of(name: str) -> KeyboardLayout:
    """The layout called `name`; an unknown one is taken for the American."""
    return LAYOUTS.get(name, LAYOUTS["us"])
