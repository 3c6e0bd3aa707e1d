"""Declares what a service offers: methods and signals with the signatures of the qi wire.

A service is a class with methods marked by `offers`; whoever hosts it (`host_qi`, `host_own`) reads
`methods_of` and `Service.signals` and knows nothing else of it. Overloads are several Python
functions under one wire name.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, TypeVar

_F = TypeVar("_F", bound=Callable[..., Any])
_MARK = "_offered_on_the_wire"


class CallRefusedError(Exception):
    """The robot says no; the text goes to the caller as NAOqi would word it."""


@dataclass(frozen=True, slots=True)
class ServiceMethod:
    """One method on the wire: `takes` is a tuple signature such as `(sf)`, `gives` one of a value.

    `gives_typed` is the same value more narrowly, for a host that cannot put raw bytes into `m`.
    `cancellable` says whether a client's cancelling ends it; most of NAOqi's methods go on.
    """

    name: str
    takes: str
    gives: str
    run: Callable[..., Any]
    gives_typed: str
    cancellable: bool


def split_signature(wire: str) -> tuple[str, str, str]:
    """`"say(s)v"` as `("say", "(s)", "v")`. Raises ValueError for anything else."""
    start = wire.find("(")
    depth = 0
    for position in range(max(start, 0), len(wire)):
        depth += {"(": 1, ")": -1}.get(wire[position], 0)
        if depth == 0 and start > 0:
            takes, gives = wire[start : position + 1], wire[position + 1 :]
            if gives:
                return wire[:start], takes, gives
            break
    raise ValueError(f"{wire!r} is not written as name(arguments)result")


def offers(wire: str, *, typed: str = "", cancellable: bool = False) -> Callable[[_F], _F]:
    """Mark a function or coroutine as what the wire calls, for example, `setVolume(f)v`."""
    name, takes, gives = split_signature(wire)

    def mark(function: _F) -> _F:
        setattr(
            function,
            _MARK,
            ServiceMethod(name, takes, gives, function, typed or gives, cancellable),
        )
        return function

    return mark


class Service:
    """One service. `emit` reaches whoever listens on the wire, in the order of the calls."""

    name: str
    signals: ClassVar[Mapping[str, str]] = {}

    def __init__(self) -> None:
        #: Called with a signal's name and its values.
        self.sinks: list[Callable[..., object]] = []

    def emit(self, signal: str, *values: Any) -> None:
        """Send a signal; KeyError for one that is not declared."""
        self.signals[signal]
        for sink in list(self.sinks):
            sink(signal, *values)


def methods_of(service: Service) -> tuple[ServiceMethod, ...]:
    """What the service offers, by name and arguments."""
    marked = [
        getattr(function, _MARK)
        for _, function in inspect.getmembers(type(service), inspect.isfunction)
        if hasattr(function, _MARK)
    ]
    return tuple(sorted(marked, key=lambda one: (one.name, one.takes)))
