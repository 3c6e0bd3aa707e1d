"""Bytes from values, by signature.

What may stand for what: a whole number or a boolean for any number it fits into, bytes for a
string, a tuple for a list and the other way round, anything for a dynamic value. `None` is a
dynamic value, too, and nothing.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final, Protocol

from qimessaging.errors import ProtocolError
from qimessaging.signature import DEEPEST_VALUE, LENGTH, NUMBERS, SignatureType, parse

_WHOLE: Final = frozenset("cCwWiIlL")


class PassedObject(Protocol):
    """What can be sent as an object (`o`)."""

    def passed(self) -> bytes:
        """Return the object as it is written into a message."""
        ...


def encode(signature: SignatureType | str, value: Any) -> bytes:
    """Write one value as that type. Raises `ProtocolError` where it does not fit."""
    out = bytearray()
    _write(parse(signature) if isinstance(signature, str) else signature, value, out, 0)
    return bytes(out)


def infer(value: Any) -> str:
    """Return the signature which a value takes where any may stand. Raises `ProtocolError`.

    The choice is that of the qi package: `l` for whole numbers, `[m]` for lists, `(mm)` for
    tuples, `{mm}` for maps. Only bytes differ: they are raw data (`r`) here.
    """
    if value is None:
        return "v"
    if isinstance(value, bool):
        return "b"
    if isinstance(value, int):
        return "l" if value < 1 << 63 else "L"
    for kinds, signature in _INFERRED:
        if isinstance(value, kinds):
            return signature
    if isinstance(value, tuple):
        return "(" + "m" * len(value) + ")"
    if hasattr(value, "passed"):
        return "o"
    raise _misfit("m", value)


_INFERRED: Final[tuple[tuple[Any, str], ...]] = (
    (float, "d"),
    (str, "s"),
    ((bytes, bytearray, memoryview), "r"),
    (list, "[m]"),
    (Mapping, "{mm}"),
)


def _misfit(kind: str, value: Any) -> ProtocolError:
    return ProtocolError(f"{_short(value)} is not of type {kind}")


def _short(value: Any) -> str:
    if isinstance(value, str | bytes | int | float | bool | None):
        text = repr(value) if not isinstance(value, int) or abs(value) < 1 << 64 else "this number"
        return text if len(text) <= 40 else text[:40] + "..."
    return f"a value of type {type(value).__name__}"


def _write(kind: SignatureType, value: Any, out: bytearray, depth: int) -> None:
    if depth > DEEPEST_VALUE:
        raise ProtocolError(f"a value nests more deeply than {DEEPEST_VALUE}")
    write = _WRITERS.get(kind.kind)
    if write is None:
        raise ProtocolError(f"values of type {kind.kind!r} cannot be sent")
    write(kind, value, out, depth)


def _number(kind: SignatureType, value: Any, out: bytearray, _depth: int) -> None:
    out += NUMBERS[kind.kind].pack(as_number(kind.kind, value))


def as_number(letter: str, value: Any) -> int | float:
    """Return the value as a number of that type. Raises `ProtocolError` where it is none."""
    if not isinstance(value, int | float):
        raise _misfit(letter, value)
    try:
        if letter not in _WHOLE:
            number: int | float = float(value)
        elif value == (number := int(value)):
            pass
        else:
            raise _misfit(letter, value)
        NUMBERS[letter].pack(number)
    except (struct.error, OverflowError, ValueError) as error:
        raise _misfit(letter, value) from error
    return number


def _bool(kind: SignatureType, value: Any, out: bytearray, _depth: int) -> None:
    if not isinstance(value, int | float):
        raise _misfit(kind.kind, value)
    out.append(1 if value else 0)


def _string(kind: SignatureType, value: Any, out: bytearray, _depth: int) -> None:
    if isinstance(value, str):
        try:
            value = value.encode()
        except UnicodeEncodeError as error:
            raise _misfit(kind.kind, value) from error
    _raw(kind, value, out, 0)


def _raw(kind: SignatureType, value: Any, out: bytearray, _depth: int) -> None:
    if not isinstance(value, bytes | bytearray | memoryview):
        raise _misfit(kind.kind, value)
    data = bytes(value)
    _length(len(data), out)
    out += data


def _length(length: int, out: bytearray) -> None:
    out += LENGTH.pack(length)


def _nothing(_kind: SignatureType, _value: Any, _out: bytearray, _depth: int) -> None:
    """Write what has no bytes; a function that returns nothing may return anything."""


def _list(kind: SignatureType, value: Any, out: bytearray, depth: int) -> None:
    if not isinstance(value, list | tuple):
        raise _misfit(kind.text, value)
    _length(len(value), out)
    for element in value:
        _write(kind.inner[0], element, out, depth + 1)


def _map(kind: SignatureType, value: Any, out: bytearray, depth: int) -> None:
    if not isinstance(value, Mapping):
        raise _misfit(kind.text, value)
    _length(len(value), out)
    for name, element in value.items():
        _write(kind.inner[0], name, out, depth + 1)
        _write(kind.inner[1], element, out, depth + 1)


def _tuple(kind: SignatureType, value: Any, out: bytearray, depth: int) -> None:
    for member, element in zip(kind.inner, members_of(kind, value), strict=True):
        _write(member, element, out, depth + 1)


def members_of(kind: SignatureType, value: Any) -> Sequence[Any]:
    """Return a tuple's members, also of a struct given by its names. Raises `ProtocolError`."""
    if isinstance(value, Mapping) and kind.names and set(value) == set(kind.names):
        return [value[name] for name in kind.names]
    if not isinstance(value, list | tuple) or len(value) != len(kind.inner):
        raise _misfit(kind.text, value)
    return value


def _dynamic(_kind: SignatureType, value: Any, out: bytearray, depth: int) -> None:
    signature = infer(value)
    _string(_STRING, signature, out, depth)
    _write(parse(signature), value, out, depth + 1)


def _optional(kind: SignatureType, value: Any, out: bytearray, depth: int) -> None:
    out.append(0 if value is None else 1)
    if value is not None:
        _write(kind.inner[0], value, out, depth + 1)


def _object(kind: SignatureType, value: Any, out: bytearray, _depth: int) -> None:
    if not hasattr(value, "passed"):
        raise _misfit(kind.kind, value)
    out += value.passed()


_STRING: Final = parse("s")
_WRITERS: Final[dict[str, Callable[[SignatureType, Any, bytearray, int], None]]] = {
    **dict.fromkeys("cCwWiIlLfd", _number),
    "b": _bool,
    "s": _string,
    "r": _raw,
    "v": _nothing,
    "_": _nothing,
    "[": _list,
    "{": _map,
    "(": _tuple,
    "m": _dynamic,
    "+": _optional,
    "o": _object,
}
