"""Signatures: the types of values as text, such as `(s[m]{sf})`.

The letters are those of `qi/signature.hpp` of libqi. A signature may come from the other end, so
its length and depth are limited.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

from qimessaging.errors import ProtocolError

#: The longest signature that is read. That of a meta object, the longest in use, has 287.
LONGEST = 8192
#: Longer ones are not kept in memory: a robot could send new ones for ever.
_REMEMBERED = 512
#: How deeply lists, maps, tuples and optionals may nest in one signature.
DEEPEST = 32

#: `_` is the element of an empty list whose type nobody knows; it has no bytes, like `v`.
_LETTERS = frozenset("bcCwWiIlLfdsrvmoX_*")
_ONE_ELEMENT = {"#": "[", "+": "+"}

#: Numbers by their letter, and lengths, as bytes.
NUMBERS: Final = {
    letter: struct.Struct("<" + code)
    for letter, code in zip("cCwWiIlLfd", "bBhHiIqQfd", strict=True)
}
LENGTH: Final = struct.Struct("<I")
#: How deeply values may nest: a dynamic value may hold another, so a signature does not limit it,
#: and a list may hold itself.
DEEPEST_VALUE: Final = 64


@dataclass(frozen=True, slots=True)
class SignatureType:
    """The type of one value.

    Attributes:
        kind: One letter: `[` a list, `{` a map, `(` a tuple, `+` an optional, or a plain type.
        inner: A list's element, a map's key and value, a tuple's members, an optional's value.
        names: A struct's members by name; empty where the signature does not tell them.
        text: The signature of this type.
    """

    kind: str
    inner: tuple[SignatureType, ...] = ()
    names: tuple[str, ...] = ()
    text: str = ""


_PLAIN = {letter: SignatureType(letter, text=letter) for letter in _LETTERS}


def parse(text: str) -> SignatureType:
    """Read the signature of exactly one value. Raises `ProtocolError`."""
    if len(text) > LONGEST:
        raise ProtocolError(f"a signature of {len(text)} characters; at most {LONGEST} are read")
    return _parse_cached(text) if len(text) <= _REMEMBERED else _parse_all(text)


def _parse_all(text: str) -> SignatureType:
    parsed, end = _parse_type(text, 0, 0)
    if end != len(text):
        raise ProtocolError(f"{_short(text)} is more than one signature")
    return parsed


_parse_cached = lru_cache(maxsize=512)(_parse_all)


def parse_members(text: str) -> tuple[SignatureType, ...]:
    """Read a method's or signal's parameters, `(..)`. Raises `ProtocolError`."""
    parsed = parse(text)
    if parsed.kind != "(":
        raise ProtocolError(f"{_short(text)} are no parameters: a tuple is needed")
    return parsed.inner


def _parse_type(text: str, at: int, depth: int) -> tuple[SignatureType, int]:
    if depth > DEEPEST:
        raise ProtocolError(f"a signature nests more deeply than {DEEPEST}")
    if at >= len(text):
        raise ProtocolError(f"the signature {_short(text)} ends too early")
    letter = text[at]
    if letter in _LETTERS:
        end = _skip_annotation(text, at + 1)
        return _PLAIN[letter] if end == at + 1 else SignatureType(letter, text=text[at:end]), end
    if letter == "[":
        element, end = _parse_type(text, at + 1, depth + 1)
        end = _skip_annotation(text, _expect(text, end, "]"))
        return SignatureType("[", (element,), text=text[at:end]), end
    if letter == "{":
        key, end = _parse_type(text, at + 1, depth + 1)
        value, end = _parse_type(text, end, depth + 1)
        end = _skip_annotation(text, _expect(text, end, "}"))
        return SignatureType("{", (key, value), text=text[at:end]), end
    if letter == "(":
        return _tuple(text, at, depth)
    if letter in _ONE_ELEMENT:
        element, end = _parse_type(text, at + 1, depth + 1)
        return SignatureType(_ONE_ELEMENT[letter], (element,), text=text[at:end]), end
    raise ProtocolError(f"{letter!r} in the signature {_short(text)} is no type")


def _tuple(text: str, at: int, depth: int) -> tuple[SignatureType, int]:
    members: list[SignatureType] = []
    end = at + 1
    while end < len(text) and text[end] != ")":
        member, end = _parse_type(text, end, depth + 1)
        members.append(member)
    end = _expect(text, end, ")")
    after = _skip_annotation(text, end)
    names = tuple(text[end + 1 : after - 1].split(",")[1:]) if after > end else ()
    if len(names) != len(members):
        names = ()
    return SignatureType("(", tuple(members), names, text[at:after]), after


def _skip_annotation(text: str, at: int) -> int:
    """Return where `<Name,member,..>` ends, which may stand behind any type."""
    if not text.startswith("<", at):
        return at
    depth = 0
    for end in range(at, len(text)):
        depth += {"<": 1, ">": -1}.get(text[end], 0)
        if depth == 0:
            return end + 1
    raise ProtocolError(f"the signature {_short(text)} ends within its names")


def _expect(text: str, at: int, letter: str) -> int:
    if not text.startswith(letter, at):
        raise ProtocolError(f"the signature {_short(text)} lacks a {letter!r}")
    return at + 1


def _short(text: str) -> str:
    return repr(text if len(text) <= 60 else text[:60] + "...")
