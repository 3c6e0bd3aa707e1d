"""Keyboard layouts: which characters a wizard's keyboard gives, with and without shift.

A layout matters because a terminal sends characters, not keys: shift+2 is `@` on an American
keyboard, `"` on a British, German or Spanish one, and `2` itself on a French one. Keys are always
meant by their character. (Those who think in positions must remember that a German keyboard has
y and z the other way round, and a French one a/q, z/w and m.)
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType


@dataclass(frozen=True, slots=True)
class KeyboardLayout:
    """One keyboard. `shifted` maps a key's character to the one it gives with shift."""

    name: str
    shifted: Mapping[str, str]
    unshifted: Mapping[str, str]
    #: Characters that need AltGr.
    altgr: frozenset[str]
    #: Accent keys that send nothing until the next key is pressed.
    dead: frozenset[str]

    def gives(self, character: str) -> bool:
        """Whether some key gives this character, with shift or AltGr if need be."""
        return (
            character == " "
            or character in self.shifted
            or character in self.unshifted
            or character in self.altgr
        )

    def with_shift(self, character: str) -> str:
        """What shift makes of a key's character."""
        upper = character.upper()
        return self.shifted.get(character, upper if len(upper) == 1 else character)


def _layout(name: str, plain: str, shifted: str, altgr: str = "", dead: str = "") -> KeyboardLayout:
    keys = dict(zip("".join(plain.split()), "".join(shifted.split()), strict=True))
    return KeyboardLayout(
        name,
        MappingProxyType(keys),
        MappingProxyType({upper: lower for lower, upper in keys.items()}),
        frozenset(altgr),
        frozenset(dead),
    )


LAYOUTS: Mapping[str, KeyboardLayout] = MappingProxyType(
    {
        layout.name: layout
        for layout in (
            _layout(
                "us",
                r"`1234567890-= qwertyuiop[]\ asdfghjkl;' zxcvbnm,./",
                r'~!@#$%^&*()_+ QWERTYUIOP{}| ASDFGHJKL:" ZXCVBNM<>?',
            ),
            _layout(
                "gb",
                r"`1234567890-= qwertyuiop[] asdfghjkl;'# \zxcvbnm,./",
                r'¬!"£$%^&*()_+ QWERTYUIOP{} ASDFGHJKL:@~ |ZXCVBNM<>?',
                altgr="€¦",
            ),
            _layout(
                "de",
                "^1234567890ß´ qwertzuiopü+ asdfghjklöä# <yxcvbnm,.-",  # noqa: RUF001
                "°!\"§$%&/()=?` QWERTZUIOPÜ* ASDFGHJKLÖÄ' >YXCVBNM;:_",
                altgr="@€²³{[]}\\~|µ",
                dead="^´`",  # noqa: RUF001
            ),
            _layout(
                "es",
                "º1234567890'¡ qwertyuiop`+ asdfghjklñ´ç <zxcvbnm,.-",  # noqa: RUF001
                'ª!"·$%&/()=?¿ QWERTYUIOP^* ASDFGHJKLÑ¨Ç >ZXCVBNM;:_',
                altgr="\\|@#~€¬[]{}",
                dead="`^´¨",  # noqa: RUF001
            ),
            _layout(
                "fr",
                "²&é\"'(-è_çà)= azertyuiop^$ qsdfghjklmù* <wxcvbn,;:!",
                "~1234567890°+ AZERTYUIOP¨£ QSDFGHJKLM%µ >WXCVBN?./§",
                altgr="#{[|`\\@]}€¤",
                dead="^¨",
            ),
        )
    }
)


def layout_of(name: str) -> KeyboardLayout:
    """The layout called `name`; an unknown one is taken for the American."""
    return LAYOUTS.get(name, LAYOUTS["us"])
