"""Meaning of a complete escape sequence, as a token: tables and rules, no state.

Every token keeps the bytes it was made of in `raw`: put end to end, they are what was read.
"""

from __future__ import annotations

import re
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class StopToken:
    """Somebody wants everything to stop; `source` is `escape` or `ctrl+c`."""

    source: str
    raw: bytes


@dataclass(frozen=True, slots=True)
class Key:
    """A key press: `chord` in the normal form of `woz_tui.config.keys`.

    `screen` is what Textual's parser is given if nobody else wants the key; it differs from `raw`
    where that parser would trip over details (event types, key codes of other protocols).
    """

    chord: str
    raw: bytes
    screen: bytes


@dataclass(frozen=True, slots=True)
class KeyUp:
    """A key was let go, from a terminal that was asked to say so."""

    chord: str
    raw: bytes


@dataclass(frozen=True, slots=True)
class Paste:
    """Text pasted in one go, between the terminal's marks; never a key press."""

    text: str
    raw: bytes


@dataclass(frozen=True, slots=True)
class TerminalReply:
    """The terminal's answer to a question.

    `what`: `status` (to `CSI 5 n`), `kitty` (keyboard flags, in `values`), `attributes`
    (`CSI c`), `graphics` (kitty's pictures: 1 if it draws them), `ground` (its colour: red, green
    and blue in per mille), `position`, or `unknown`: not understood, and therefore kept from
    everybody.
    """

    what: str
    values: tuple[int, ...]
    raw: bytes


@dataclass(frozen=True, slots=True)
class Raw:
    """For Textual's parser alone: mouse, focus, size and mode reports, unprintable characters."""

    raw: bytes


Token = StopToken | Key | KeyUp | Paste | TerminalReply | Raw


_SHIFT, _ALT, _CTRL = 1, 2, 4
_SUPER, _HYPER, _META = 8, 16, 32

_ARROWS = dict(zip("ABCDFH", ("up", "down", "right", "left", "end", "home"), strict=True))
_LETTERS = _ARROWS | {letter: f"f{n}" for n, letter in enumerate("PQRS", 1)}
#: Numbers of F1 and so on; a few between them belong to no key.
_F_NUMBERS = (n for n in (*range(11, 35), *range(42, 46)) if n not in (16, 22, 27, 30))
_TILDES = {
    **dict(enumerate(["home", "insert", "delete", "end", "pageup", "pagedown", "home", "end"], 1)),
    **{number: f"f{n}" for n, number in enumerate(_F_NUMBERS, 1)},
}
_KEYPAD = {
    "j": "*",
    "k": "+",
    "m": "-",
    "n": ".",
    "o": "/",
    **{letter: str(digit) for digit, letter in enumerate("pqrstuvwxy")},
    "M": "enter",
}
#: Names of characters that are not written as themselves.
NAMED = {9: "tab", 13: "enter", 27: "escape", 32: "space", 127: "backspace", 8: "backspace"}
#: The kitty protocol's keypad: the key it stands for.
_KITTY = {
    **{57399 + digit: str(digit) for digit in range(10)},
    **dict(enumerate((*"./*-+", "enter", "=", ","), 57409)),
    **dict(enumerate(("left", "right", "up", "down", "pageup", "pagedown"), 57417)),
    **dict(enumerate(("home", "end", "insert", "delete"), 57423)),
    **{57376 + offset: f"f{13 + offset}" for offset in range(23)},
}
#: Code points on the key C: Latin, and Cyrillic, whose layouts have another letter there.
_C_KEYS = frozenset({0x63, 0x43, 0x441, 0x421})
_RELEASED = 3

_FIELDS = re.compile(rb"[0-9:;]*\Z")


def modifiers_of(value: int) -> int:
    """The bits of a protocol's modifier number (1 + bits), without caps lock and num lock."""
    return (value - 1 if value > 0 else 0) & 0x3F


def chord(key: str, bits: int) -> str:
    """The normal form of `key` with modifiers: `ctrl+alt+shift+key`."""
    names = (
        ("super+", _SUPER),
        ("hyper+", _HYPER),
        ("meta+", _META),
        ("ctrl+", _CTRL),
        ("alt+", _ALT),
        ("shift+", _SHIFT),
    )
    return "".join(name for name, bit in names if bits & bit) + key


def control_sequence(raw: bytes) -> Token | None:
    """The token for a complete `CSI ...`; None if no terminal would send such a thing."""
    body, final = raw[2:-1], chr(raw[-1])
    if body[:1] == b"[":  # Linux console: CSI [ A is F1
        return _key(f"f{ord(final) - 64}", 0, raw) if "A" <= final <= "E" else None
    if body[:1] in (b"?", b">", b"=", b"<"):
        return _private(raw, body, final)
    if not _FIELDS.match(body):
        return TerminalReply("unknown", (), raw)
    if final in "$^@":
        return _rxvt(raw, body, final)
    return _plain(raw, _numbers(body), final)


def _private(raw: bytes, body: bytes, final: str) -> Token:
    """Answers with a private mark, and mouse reports in their decimal form."""
    if body[:1] == b"<" and final in "Mm":
        return Raw(raw)
    if body[:1] == b"?" and final == "y":
        return Raw(raw)  # a mode's state, which Textual asked for
    values = tuple(field[0] for field in _numbers(body[1:]))
    if final == "c":
        return TerminalReply("attributes", values, raw)
    if body[:1] == b"?" and final == "u":
        return TerminalReply("kitty", values, raw)
    if body[:1] == b"?" and final == "R":
        return TerminalReply("position", values, raw)
    return TerminalReply("unknown", values, raw)


def _rxvt(raw: bytes, body: bytes, final: str) -> Token:
    """Rxvt says the modifiers with the last character: $ shift, ^ ctrl, @ both."""
    fields = _numbers(body)
    key = _TILDES.get(fields[0][0]) if len(fields) == 1 else None
    bits = {"$": _SHIFT, "^": _CTRL, "@": _SHIFT | _CTRL}[final]
    return _key(key, bits, raw) if key else TerminalReply("unknown", (), raw)


def _plain(raw: bytes, fields: list[list[int]], final: str) -> Token:
    """Sequences without a private mark."""
    if _released(fields):
        pressed = _plain(raw, [fields[0], fields[1][:1], *fields[2:]], final)
        if isinstance(pressed, Key):
            return KeyUp(pressed.chord, raw)
        return TerminalReply("unknown", (), raw)
    if final == "u":
        return _kitty(raw, fields)
    if final == "~" and fields[0][0] == 27 and len(fields) == 3:
        return _xterm(raw, fields[2][0], modifiers_of(fields[1][0]))
    return _report(raw, fields, final) or _function_key(raw, fields, final)


def _report(raw: bytes, fields: list[list[int]], final: str) -> Token | None:
    """What the terminal says by itself or when asked; None if it is a key."""
    if final in "Mt" or raw in (b"\x1b[I", b"\x1b[O"):
        return Raw(raw)  # mouse, size of the window, focus gained or lost
    if final == "n":
        return TerminalReply("status", (fields[0][0],), raw)
    if final == "R" and not _is_f3(raw, fields):
        return TerminalReply("position", tuple(field[0] for field in fields), raw)
    return None


def _function_key(raw: bytes, fields: list[list[int]], final: str) -> Token:
    """Arrows, F-keys and their neighbours."""
    first = fields[0][0]
    if final == "Z":
        return _key("tab", _SHIFT, raw)
    if final in "abcd" and len(raw) == 3:  # rxvt
        return _key(_LETTERS[final.upper()], _SHIFT, raw)
    key = _TILDES.get(first) if final == "~" else _LETTERS.get(final)
    if key is None:
        return TerminalReply("unknown", (), raw)
    # Old tmux: CSI 5 A is ctrl+up, the modifier being the only number.
    modifier = fields[1][0] if len(fields) > 1 else (first if final != "~" else 0)
    return _key(key, modifiers_of(modifier), raw, _readable(raw, key, modifier))


def _readable(raw: bytes, key: str, modifier: int) -> bytes:
    """The function key in a form that Textual's parser reads as what it is."""
    if raw.endswith(b"R") and modifier:  # CSI 1;5R is the cursor's position to it
        return f"\x1b[13;{modifier}~".encode()
    number = int(key[1:]) if key[0] == "f" and key[1:].isdigit() else 0
    if number > 12:  # CSI 25~ is a control character to it
        return f"\x1b[{57376 + number - 13};{modifier or 1}u".encode()
    return _simple(raw)


def _is_f3(raw: bytes, fields: list[list[int]]) -> bool:
    """`CSI 1;5R` is ctrl+F3, and a cursor in the first row, fifth column.

    The console never asks for the cursor's position, so the reading as a key wins; rows and
    columns that no modifier number can be are late answers to somebody else's question.
    """
    if raw == b"\x1b[R":
        return True
    return len(fields) == 2 and fields[0][0] == 1 and 2 <= fields[1][0] <= 16


def _kitty(raw: bytes, fields: list[list[int]]) -> Token:
    """`CSI code:shifted:base ; modifiers:event ; text u`."""
    code, bits = fields[0][0], modifiers_of(fields[1][0]) if len(fields) > 1 else 0
    stop = _stop(raw, fields[0], bits)
    if stop is not None:
        return stop
    codes = fields[2] if len(fields) > 2 and fields[2] != [0] else []
    if not all(map(_character, codes)):
        return TerminalReply("unknown", (), raw)
    if len(codes) > 1:  # put together by an input method: text, not keys
        return Paste("".join(map(_character, codes)), raw)
    if codes and _character(codes[0]).isprintable() and not bits & (_CTRL | _ALT):
        text = _character(codes[0])
        key = NAMED.get(codes[0])
        return _key(key, bits, raw, _simple(raw)) if key else _key(text, 0, raw, _simple(raw))
    return _code_point(raw, code, bits, _simple(raw))


def _xterm(raw: bytes, code: int, bits: int) -> Token:
    """`CSI 27 ; modifiers ; code ~`, which Textual's parser does not know."""
    stop = _stop(raw, [code], bits)
    if stop is not None:
        return stop
    text = _character(code)
    if code > 32 and text.isprintable() and text and not bits & ~_SHIFT:
        return _key(text, 0, raw, text.encode())
    return _code_point(raw, code, bits, f"\x1b[{code};{bits + 1}u".encode())


def _stop(raw: bytes, codes: list[int], bits: int) -> StopToken | None:
    if codes[0] == 27:
        return StopToken("escape", raw)
    return StopToken("ctrl+c", raw) if bits & _CTRL and not _C_KEYS.isdisjoint(codes) else None


def _code_point(raw: bytes, code: int, bits: int, screen: bytes) -> Token:
    """A key given by its code point, without the text it would write."""
    key = NAMED.get(code) or _KITTY.get(code)
    if key is not None:
        return _key(key, bits if len(key) > 1 else bits & ~_SHIFT, raw, screen)
    character = _character(code)
    if 0xE000 <= code <= 0xF8FF:
        return Raw(screen)  # a modifier by itself, a media key
    if not character or not character.isprintable():
        return TerminalReply("unknown", (), raw)
    if character.isupper() and bits & ~_SHIFT:  # some terminals give the shifted letter's code
        return _key(character.lower(), bits | _SHIFT, raw, screen)
    if bits == _SHIFT and len(character.upper()) == 1 and character.upper() != character:
        return _key(character.upper(), 0, raw, screen)
    if bits == _SHIFT and character.isupper():
        bits = 0
    return _key(character, bits, raw, screen)


def application_sequence(raw: bytes) -> Token | None:
    """The token for a complete `ESC O ...`; None if no terminal would send such a thing."""
    body, final = raw[2:-1], chr(raw[-1])
    if not body and final in "abcd":  # rxvt
        return _key(_LETTERS[final.upper()], _CTRL, raw)
    key = _LETTERS.get(final) or (_KEYPAD.get(final) if not body else None)
    if key is None:
        return None
    fields = _numbers(body)
    bits = modifiers_of(fields[-1][0])
    screen = f"\x1b[1;{bits + 1}{final}".encode() if body else raw
    return _key(key, bits, raw, screen)


def _key(key: str, bits: int, raw: bytes, screen: bytes = b"") -> Key:
    return Key(chord(key, bits), raw, screen or raw)


def _numbers(body: bytes) -> list[list[int]]:
    """`1;2:3` as [[1], [2, 3]]; what is left out counts as 0."""
    return [
        [int(part) if part else 0 for part in field.split(b":")]
        for field in body.split(b";")
        if all(not part or part.isdigit() for part in field.split(b":"))
    ] or [[0]]


def _released(fields: list[list[int]]) -> bool:
    return len(fields) > 1 and len(fields[1]) > 1 and fields[1][1] == _RELEASED


def _simple(raw: bytes) -> bytes:
    """The sequence without event type and alternate keys, at which Textual's parser raises."""
    fields = raw[2:-1].split(b";")
    plain = [field.split(b":")[0] if at < 2 else field for at, field in enumerate(fields)]
    return raw[:2] + b";".join(plain) + raw[-1:]


def _character(code: int) -> str:
    return chr(code) if 0 < code < 0x110000 and not 0xD800 <= code < 0xE000 else ""
