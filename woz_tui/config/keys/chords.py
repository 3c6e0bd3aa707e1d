"""Keys as people write them, in one normal form.

A printable key is its character as the terminal sends it (`a`, `A`, `!`, `é`); others have names
(`space`, `f1`, `pageup`). Modifiers stand in front, in the order ctrl, alt, shift; shift alone on
a printable key vanishes into the character (`shift+1` is `!` on an American keyboard). With ctrl
or alt the key is named by its unshifted character (`ctrl+!` is `ctrl+shift+1`). Two keys one after
the other are two normal forms with one blank between them (`c r`).
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import msgspec

from woz_tui.config.keys.keyboard_layouts import KeyboardLayout, layout_of
from woz_tui.config.problems import hint, quoted, together
from woz_tui.protocol.sentence import Sentence

FUNCTION_KEYS = tuple(f"f{number}" for number in range(1, 13))
#: Of foot pedals and macro pads: no keyboard has them.
PEDALS = tuple(f"f{number}" for number in range(13, 25))
ARROWS = ("up", "down", "left", "right")
#: Every key that has a name instead of a character.
NAMED = (
    *("space", "tab", "enter", "backspace", "escape"),
    *("delete", "insert", "home", "end", "pageup", "pagedown"),
    *ARROWS,
    *FUNCTION_KEYS,
    *PEDALS,
)

_WORDS: dict[str, dict[str, list[str]]] = msgspec.json.decode(
    Path(__file__).with_name("key_names.json").read_bytes()
)
#: Modifiers by the words for them; empty: one that no terminal sends.
_MODIFIERS = {word: name for name, words in _WORDS["modifiers"].items() for word in words}
#: The short ones of Emacs and readline, with a dash only: `C-a`.
_SHORT = {"c": "ctrl", "m": "alt", "s": "shift"}
_NAMES = {
    **{name: name for name in NAMED},
    **{word: name for name, words in _WORDS["keys"].items() for word in words},
    **{f"{arrow}arrow": arrow for arrow in ARROWS},
    **{f"arrow{arrow}": arrow for arrow in ARROWS},
}

_PREFIX = re.compile(r"(?P<long>[A-Za-z]{2,})[+-](?P<rest>.+)|(?P<short>[CMScms])-(?P<tail>.+)")


class KeyNameError(ValueError):
    """Not a key that can be bound; the text says why and what to write."""


@dataclass(frozen=True, slots=True)
class Chord:
    """One press: a key with the modifiers held down."""

    base: str
    ctrl: bool = False
    alt: bool = False
    shift: bool = False

    def __str__(self) -> str:
        held = [name for name in ("ctrl", "alt", "shift") if getattr(self, name)]
        return "+".join([*held, self.base])

    @property
    def named(self) -> bool:
        """Whether the key has a name instead of a character."""
        return len(self.base) > 1


def normal_key(written: object, layout: str = "us") -> str:
    """The normal form of a key, a chord or two keys one after the other.

    `written` is text (`Ctrl-A`, `F1`, `c r`, `^A`), a digit, or a list of keys held down together
    (`["shift", 1]`). Raises `KeyNameError`.
    """
    keyboard = layout_of(layout)
    if isinstance(written, int) and not isinstance(written, bool):
        written = str(written)
    if isinstance(written, str):
        return " ".join(
            str(_typed(_chord(part), keyboard)) for part in _one_after_the_other(written)
        )
    if isinstance(written, Sequence):
        return str(_typed(_held_together([str(part) for part in written]), keyboard))
    raise KeyNameError(
        Sentence(
            "check.key_is_text",
            "a key is text such as a, F1 or ctrl+a, not {kind}",
            kind=type(written).__name__,
        )
    )


def parse_chord(chord: str) -> Chord:
    """The parts of one chord that is in normal form already."""
    held = set()
    while (cut := chord.find("+", 1)) > 0 and chord[:cut] in ("ctrl", "alt", "shift"):
        held.add(chord[:cut])
        chord = chord[cut + 1 :]
    return Chord(chord, "ctrl" in held, "alt" in held, "shift" in held)


def _one_after_the_other(text: str) -> list[str]:
    text = unicodedata.normalize("NFC", text)
    if text == " ":
        return ["space"]
    parts = text.split()
    if "_".join(parts).lower() in _NAMES:
        return ["_".join(parts)]
    if not parts:
        raise KeyNameError(Sentence("check.key_missing", "a key is missing here"))
    if len(parts) > 2:
        raise KeyNameError(
            Sentence(
                "check.too_many_keys",
                "{text} has {number} keys; at most two keys can follow each other",
                text=quoted(text),
                number=len(parts),
            )
        )
    if len(parts) == 2 and parts[0].lower() in _MODIFIERS:
        raise KeyNameError(
            Sentence(
                "check.keys_together",
                "{text}: for keys held down together, write {names}",
                text=quoted(text),
                names="+".join(parts),
            )
        )
    return parts


def _held_together(parts: list[str]) -> Chord:
    """A list: modifiers in any place, and one key."""
    parts = [unicodedata.normalize("NFC", part) for part in parts]
    held = [part for part in parts if part.strip().lower() in _MODIFIERS]
    keys = [part for part in parts if part.strip().lower() not in _MODIFIERS]
    if len(keys) != 1:
        if not keys:
            raise KeyNameError(
                Sentence("check.modifiers_alone", "a list of modifiers without a key")
            )
        raise KeyNameError(
            Sentence(
                "check.never_together",
                "no terminal can send {names} held down together; for one after the"
                " other, write {keys}",
                names=together(keys[:3]),
                keys=quoted(" ".join(keys[:2])),
            )
        )
    (key,) = keys if keys[0] == " " else [keys[0].strip()]
    chord = _chord("space" if key == " " else key)
    for modifier in held:
        chord = _hold(chord, modifier.strip().lower())
    return chord


def _chord(text: str) -> Chord:
    """One chord as written, modifiers stripped from the front one by one."""
    whole = text
    held = []
    if len(text) == 2 and text[0] == "^":
        held, text = ["ctrl"], text[1]
    while (match := _PREFIX.fullmatch(text)) is not None:
        word = (match["long"] or "").lower()
        short = _SHORT.get((match["short"] or "").lower(), "")
        if word not in _MODIFIERS and not short:
            break
        held.append(word or short)
        text = match["rest"] or match["tail"]
    if text.lower() in _MODIFIERS or not text:
        raise KeyNameError(
            Sentence(
                "check.modifier_alone",
                "{key} is not a key by itself; write it like ctrl+a",
                key=quoted(whole),
            )
        )
    chord = _key_alone(text, whole)
    for modifier in held:
        chord = _hold(chord, modifier)
    return chord


def _hold(chord: Chord, modifier: str) -> Chord:
    name = _MODIFIERS[modifier]
    if not name:
        raise KeyNameError(
            Sentence(
                "check.desktop_key",
                "{modifier} never reaches a terminal; the desktop uses it",
                modifier=modifier,
            )
        )
    return Chord(
        chord.base,
        chord.ctrl or name == "ctrl",
        chord.alt or name == "alt",
        chord.shift or name == "shift",
    )


def _key_alone(text: str, whole: str) -> Chord:
    if len(text) == 1:
        if not text.isprintable() or text.isspace() or unicodedata.combining(text):
            raise KeyNameError(
                Sentence(
                    "check.not_pressed", "{key} is not a key that can be pressed", key=quoted(whole)
                )
            )
        return Chord(text)
    name = _NAMES.get(text.lower()) or _unicode_named(text)
    if name == "shift+tab":
        return Chord("tab", shift=True)
    if name is not None:
        return Chord(name)
    if re.fullmatch(r"[fF]\d+", text):
        raise KeyNameError(
            Sentence("check.function_keys", "{key}: function keys are F1 to F24", key=quoted(whole))
        )
    if re.fullmatch(r".[+-].", text):
        raise KeyNameError(
            Sentence(
                "check.never_together_key",
                "{key}: no terminal can send two keys held down together; for one"
                " after the other, write {keys}",
                key=quoted(whole),
                keys=quoted(text[0] + " " + text[2]),
            )
        )
    raise KeyNameError(
        Sentence(
            "check.no_key", "{key} is not a key{near}", key=quoted(whole), near=hint(text, _NAMES)
        )
    )


def _unicode_named(text: str) -> str | None:
    """Textual's names, `exclamation_mark`, are Unicode's."""
    try:
        character = unicodedata.lookup(text.replace("_", " "))
    except KeyError:
        return None
    plain = unicodedata.normalize("NFC", character)
    printable = len(plain) == 1 and plain.isprintable() and not plain.isspace()
    return plain if printable and not unicodedata.combining(plain) else None


def _typed(chord: Chord, layout: KeyboardLayout) -> Chord:
    """The chord as this keyboard types it: shift folded in or out."""
    if chord.named:
        return chord
    base = chord.base
    key = layout.without_shift(base)
    if not (chord.ctrl or chord.alt):
        if chord.shift and key is None:
            base = layout.with_shift(base)
        return Chord(unicodedata.normalize("NFC", base))
    shift = chord.shift
    if key is not None and key != _lower(base):
        base, shift = key, True
    return Chord(_lower(base), chord.ctrl, chord.alt, shift)


def _lower(character: str) -> str:
    lower = unicodedata.normalize("NFC", character.lower())
    return lower if len(lower) == 1 else character
