"""Drivers are found by entry point, ours exactly like a stranger's."""

from __future__ import annotations

import dataclasses
import signal
import threading
from collections.abc import Iterator, Mapping
from importlib.metadata import EntryPoint, entry_points
from inspect import getattr_static
from types import FrameType
from typing import Any

from woz_tui.drivers.contract import Driver

GROUP = "woz_tui.drivers"
#: The package whose drivers came with woz-tui.
OWN = "woz-tui"
#: An import of others' code may take so long, in seconds: a large library on a small computer.
IMPORT_S = 60.0
#: What a driver said of itself in earlier versions, each in a class method of its own.
_SAID_BEFORE = ("verbs", "sensors", "lacks", "joints", "asks", "part", "outline")
#: The package that held the contract in earlier versions, and what the author of a driver from then
#: has to do.
_BEFORE = "woz_tui.core"
_MOVED = "; import from woz_tui.drivers and woz_tui.protocol (CHANGELOG.md lists old and new names)"


class PluginError(Exception):
    """A driver is registered but cannot be loaded; the text says which package and why."""


class Catalogue(Mapping[str, type[Driver]]):
    """Driver types by name; a driver's module is imported when it is first asked for."""

    def __init__(self, points: Mapping[str, EntryPoint]) -> None:
        self._points = dict(points)
        self._loaded: dict[str, type[Driver]] = {}

    def __getitem__(self, name: str) -> type[Driver]:
        if name not in self._loaded:
            self._loaded[name] = _load(self._points[name])
        return self._loaded[name]

    def is_foreign(self, name: str) -> bool:
        """Whether its code did not come with woz-tui."""
        return _is_foreign(self._points[name])

    def __contains__(self, name: object) -> bool:
        """Whether some package offers it; whether it loads is another question."""
        return name in self._points

    def __iter__(self) -> Iterator[str]:
        return iter(sorted(self._points))

    def __len__(self) -> int:
        return len(self._points)


def installed() -> Catalogue:
    """Every driver that some installed package offers. `PluginError` if two claim one name."""
    points: dict[str, EntryPoint] = {}
    for point in entry_points(group=GROUP):
        other = points.get(point.name)
        if other is not None and other.value != point.value:
            raise PluginError(
                f"two packages offer a driver called {point.name!r}: {_origin(other)} and"
                f" {_origin(point)}; uninstall one of them"
            )
        points[point.name] = point
    return Catalogue(points)


def _origin(point: EntryPoint) -> str:
    return point.dist.name if point.dist is not None else point.value


def _is_foreign(point: EntryPoint) -> bool:
    return point.dist is not None and point.dist.name != OWN


def _imported(point: EntryPoint) -> Any:
    """What it names. Raises `TimeoutError` when an import of others' code does not end."""
    if not _is_foreign(point) or threading.current_thread() is not threading.main_thread():
        return point.load()

    def end(number: int, frame: FrameType | None) -> None:
        raise TimeoutError(f"its import takes longer than {IMPORT_S:g} s")

    before = signal.signal(signal.SIGALRM, end)
    signal.setitimer(signal.ITIMER_REAL, IMPORT_S)
    try:
        return point.load()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def _load(point: EntryPoint) -> type[Driver]:
    try:
        loaded = _imported(point)
    except Exception as error:
        moved = isinstance(error, ModuleNotFoundError) and str(error.name).startswith(_BEFORE)
        raise PluginError(
            f"the driver {point.name!r} of {_origin(point)} cannot be loaded:"
            f" {type(error).__name__}: {error}{_MOVED if moved else ''}"
        ) from error
    who = f"the driver {point.name!r} of {_origin(point)}"
    if not isinstance(loaded, type):
        raise PluginError(
            f"{who} is no class but {loaded!r}; its entry point must read module:Class"
        )
    if not issubclass(loaded, Driver):
        raise PluginError(
            f"{who} does not inherit from woz_tui.drivers.contract.Driver; write class"
            f" {loaded.__name__}(Driver), see drivers/README.md"
        )
    declared = {name for kind in loaded.__mro__ for name in vars(kind)}
    missing = sorted({"Settings", "summary"} - declared | loaded.__abstractmethods__)
    if missing:
        raise PluginError(f"{who} lacks {', '.join(missing)}; see drivers/README.md")
    before = [n for n in _SAID_BEFORE if isinstance(getattr_static(loaded, n, None), classmethod)]
    if before:
        raise PluginError(
            f"{who} was written for an earlier version: what its class method {before[0]} says is a"
            f" field of the Offer that offer(settings) returns now; see drivers/README.md"
        )
    if not dataclasses.is_dataclass(loaded.Settings):
        raise PluginError(f"{who} has Settings that are no dataclass; see drivers/README.md")
    return loaded
