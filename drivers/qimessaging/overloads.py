"""How well a value fits a type: by this a method's overload is chosen."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any, Final

from qimessaging.encoding import as_number, members_of
from qimessaging.errors import ProtocolError
from qimessaging.signature import SignatureType

#: Whole numbers in the order in which they are preferred: the one a dynamic value has, and the
#: one most of NAOqi's methods have, before others.
_WHOLE: Final = {"l": 0, "i": 0, "I": 1, "L": 1, "w": 2, "W": 2, "c": 3, "C": 3}
_REAL: Final = {"d": 0, "f": 0}
#: A dynamic value takes anything, but a type that says what it takes is preferred.
_DYNAMIC: Final = 12
_OTHER_CONTAINER: Final = 2


def misfit(kind: SignatureType, value: Any) -> int | None:
    """Return how badly a value fits: 0 exactly, more for each conversion, None not at all."""
    if kind.kind == "m":
        return _DYNAMIC
    if kind.kind == "+":
        return 1 if value is None else _more(misfit(kind.inner[0], value), 1)
    for kinds, rate in _RATED:
        if isinstance(value, kinds):
            return rate(kind, value)
    return 0 if kind.kind == "o" and hasattr(value, "passed") else None


def _nothing(kind: SignatureType, _value: None) -> int | None:
    return 0 if kind.kind in "v_" else None


def _string(kind: SignatureType, _value: str) -> int | None:
    return 0 if kind.kind == "s" else None


def _raw(kind: SignatureType, _value: bytes) -> int | None:
    return {"r": 0, "s": 4}.get(kind.kind)


def _number(kind: SignatureType, value: float) -> int | None:
    letter = kind.kind
    if letter == "b":
        return 0 if isinstance(value, bool) else 8
    if letter not in _WHOLE and letter not in _REAL:
        return None
    try:
        as_number(letter, value)
    except ProtocolError:
        return None
    if isinstance(value, bool):
        return 6 + _WHOLE.get(letter, 3)
    if isinstance(value, int):
        return _WHOLE.get(letter, 4)
    return _REAL.get(letter, 7)


def _list(kind: SignatureType, value: Any) -> int | None:
    if kind.kind == "[":
        cost = _worst([misfit(kind.inner[0], each) for each in value])
        return _more(cost, 0 if isinstance(value, list) else _OTHER_CONTAINER)
    return _tuple(kind, value) if kind.kind == "(" else None


def _map(kind: SignatureType, value: Mapping[Any, Any]) -> int | None:
    if kind.kind == "{":
        names = [misfit(kind.inner[0], each) for each in value]
        return _worst(names + [misfit(kind.inner[1], each) for each in value.values()])
    return _tuple(kind, value) if kind.kind == "(" else None


def _tuple(kind: SignatureType, value: Any) -> int | None:
    try:
        members = members_of(kind, value)
    except ProtocolError:
        return None
    pairs = zip(kind.inner, members, strict=True)
    cost = _worst([misfit(member, each) for member, each in pairs])
    return _more(cost, 0 if isinstance(value, tuple) else _OTHER_CONTAINER)


def _worst(costs: Iterable[int | None]) -> int | None:
    worst = 0
    for cost in costs:
        if cost is None:
            return None
        worst = max(worst, cost)
    return worst


def _more(cost: int | None, by: int) -> int | None:
    return None if cost is None else cost + by


_RATED: Final[tuple[tuple[Any, Callable[[SignatureType, Any], int | None]], ...]] = (
    (type(None), _nothing),
    ((bool, int, float), _number),
    (str, _string),
    ((bytes, bytearray, memoryview), _raw),
    (Mapping, _map),
    ((list, tuple), _list),
)
