"""Meta objects: methods, signals and properties of an object with their numbers and signatures."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Final

from qimessaging.decoding import ValueDecoder
from qimessaging.encoding import as_number, encode, members_of
from qimessaging.errors import ProtocolError, RefusedError
from qimessaging.signature import SignatureType, parse_members

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


SIGNATURE: Final = (
    "({I(Issss[(ss)<MetaMethodParameter,name,description>]s)"
    "<MetaMethod,uid,returnSignature,name,parametersSignature,description,parameters,"
    "returnDescription>}"
    "{I(Iss)<MetaSignal,uid,name,signature>}"
    "{I(Iss)<MetaProperty,uid,name,signature>}s)"
    "<MetaObject,methods,signals,properties,description>"
)


@dataclass(frozen=True, slots=True)
class MetaMethod:
    """One method (overloads are methods of their own)."""

    uid: int
    name: str
    parameters: str
    returns: str

    def __str__(self) -> str:
        return f"{self.name}{self.parameters}"


@dataclass(frozen=True, slots=True)
class MetaSignal:
    """One signal, or one property: a property is announced as a signal, too."""

    uid: int
    name: str
    signature: str


@dataclass(slots=True)
class MetaObject:
    """An object's methods, signals and properties by number."""

    methods: dict[int, MetaMethod] = field(default_factory=dict)
    signals: dict[int, MetaSignal] = field(default_factory=dict)
    properties: dict[int, MetaSignal] = field(default_factory=dict)
    description: str = ""
    _by_name: dict[str, list[MetaMethod]] = field(default_factory=dict, repr=False, compare=False)

    def overloads(self, name: str) -> list[MetaMethod]:
        """Return the methods of that name, or the one named with its signature, `say::(s)`."""
        if not self._by_name:
            for method in self.methods.values():
                self._by_name.setdefault(method.name, []).append(method)
        plain, _, parameters = name.partition("::")
        found = self._by_name.get(plain, [])
        return [each for each in found if not parameters or each.parameters == parameters]

    def choose(self, name: str, arguments: tuple[Any, ...]) -> MetaMethod:
        """Return the overload which these arguments fit best.

        Raises:
            RefusedError: None fits; the text names what there is.
        """
        candidates = self.overloads(name)
        if len(candidates) == 1 and _takes(candidates[0], len(arguments)):
            return candidates[0]  # whether the values fit shows when they are written
        rated = [(_misfit(method, arguments), method) for method in candidates]
        fitting = [(cost, method) for cost, method in rated if cost is not None]
        if fitting:
            return min(fitting, key=lambda each: each[0])[1]
        raise RefusedError(_no_method(name, candidates, arguments))

    def signal(self, name: str) -> MetaSignal:
        """Return the signal (or property) of that name. Raises `RefusedError`."""
        for signal in (*self.signals.values(), *self.properties.values()):
            if signal.name == name:
                return signal
        raise RefusedError(f"there is no signal {name}")

    def property(self, name: str) -> MetaSignal:
        """Return the property of that name. Raises `RefusedError`."""
        for found in self.properties.values():
            if found.name == name:
                return found
        raise RefusedError(f"there is no property {name}")

    def encoded(self) -> bytes:
        """Return the meta object as it is sent."""
        methods: dict[int, tuple[Any, ...]] = {
            each.uid: (each.uid, each.returns, each.name, each.parameters, "", [], "")
            for each in self.methods.values()
        }
        return encode(
            SIGNATURE,
            (methods, _plain(self.signals), _plain(self.properties), self.description),
        )


def _plain(members: Mapping[int, MetaSignal]) -> dict[int, tuple[int, str, str]]:
    return {each.uid: (each.uid, each.name, each.signature) for each in members.values()}


def read(decoder: ValueDecoder) -> MetaObject:
    """Read a meta object. Raises `ProtocolError`."""
    methods, signals, properties, description = decoder.value(SIGNATURE)
    return MetaObject(
        {
            uid: MetaMethod(uid, text(name), text(parameters), text(returns))
            for uid, (_uid, returns, name, parameters, *_described) in methods.items()
        },
        _signals(signals),
        _signals(properties),
        text(description),
    )


def _signals(found: Mapping[int, tuple[int, Any, Any]]) -> dict[int, MetaSignal]:
    return {
        uid: MetaSignal(uid, text(name), text(signature))
        for uid, (_uid, name, signature) in found.items()
    }


def text(value: Any) -> str:
    """Return a name that came over the wire; binary data is none. Raises `ProtocolError`."""
    if not isinstance(value, str):
        raise ProtocolError("a name is not text")
    return value


def _takes(method: MetaMethod, count: int) -> bool:
    return method.parameters == "m" or len(parse_members(method.parameters)) == count


def _misfit(method: MetaMethod, arguments: tuple[Any, ...]) -> int | None:
    """Return how badly the arguments fit, 0 being exactly; None where they do not."""
    if method.parameters == "m":
        return 100
    try:
        kinds = parse_members(method.parameters)
    except ProtocolError:
        return None  # a method with types of a later time is none of ours
    if len(kinds) != len(arguments):
        return None
    costs = [misfit(kind, each) for kind, each in zip(kinds, arguments, strict=True)]
    known = [cost for cost in costs if cost is not None]
    return sum(known) if len(known) == len(costs) else None


def _no_method(name: str, candidates: Iterable[MetaMethod], arguments: tuple[Any, ...]) -> str:
    there = ", ".join(map(str, candidates))
    if not there:
        return f"there is no method {name}"
    given = ", ".join(type(each).__name__ for each in arguments)
    return f"{name} does not take ({given}); there is {there}"
