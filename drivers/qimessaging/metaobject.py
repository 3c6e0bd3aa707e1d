"""What an object offers: its methods, signals and properties with their numbers and signatures."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Final

from qimessaging.decoding import ValueDecoder
from qimessaging.encoding import encode
from qimessaging.errors import ProtocolError, RefusedError
from qimessaging.overloads import misfit
from qimessaging.signature import parse_members

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
            Refused: None fits; the text names what there is.
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
