"""Completion of long names of which people know a part."""

from __future__ import annotations

from collections.abc import Iterable


def names_beginning(typed: str, names: Iterable[str]) -> list[str]:
    """Names that begin with exactly what was typed, and go on."""
    return [name for name in names if name.startswith(typed) and name != typed]


def names_containing(typed: str, names: Iterable[str]) -> list[str]:
    """Names that hold what was typed, in whatever case: those first that have it where the name or
    its last part begins; all names if nothing was typed.
    """
    folded = typed.casefold()
    found = [name for name in names if folded in name.casefold()]
    return sorted(found, key=lambda name: _rank(name.casefold(), folded))


def best_match(typed: str, names: Iterable[str]) -> str:
    """What is played for `typed`: a path and a name's whole last part as they are, which the robot
    completes; of anything else the first name that holds it, or itself.
    """
    names = list(names)
    if "/" in typed or any(name.rpartition("/")[2] == typed for name in names):
        return typed
    return next(iter(names_containing(typed, names)), typed)


def _rank(name: str, typed: str) -> int:
    if name.startswith(typed) or name.rpartition("/")[2] == typed:
        return 0
    return 1 if name.rpartition("/")[2].startswith(typed) else 2
