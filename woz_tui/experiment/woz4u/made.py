"""Nodes of our own format, made instead of read; each has the place of what it comes from."""

from __future__ import annotations

from collections.abc import Iterable

from woz_tui.experiment.nodes import Items, Node, Scalar, Table
from woz_tui.experiment.shape import Place

#: The entry of a mapping: its name, the place of its name, its value.
Entry = tuple[str, Place, Node]


def said(text: str, place: Place) -> Scalar:
    """Text that is text, whatever it looks like."""
    return Scalar(place, text, plain=False)


def figure(value: float, place: Place) -> Scalar:
    """A number, with six digits."""
    return Scalar(place, f"{value:.6g}", plain=True)


def flag(value: bool, place: Place) -> Scalar:
    """True or false."""
    return Scalar(place, "true" if value else "false", plain=True)


def listed(nodes: Iterable[Node], place: Place) -> Items:
    """A list."""
    return Items(place, [*nodes])


def table(entries: Iterable[Entry], place: Place) -> Table:
    """A mapping."""
    made = Table(place)
    for name, where, node in entries:
        made.entries[name] = node
        made.keys[name] = Scalar(where, name, plain=True)
    return made
