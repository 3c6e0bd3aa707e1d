"""Nodes of our own format, made instead of read; each has the place of what it comes from."""

from __future__ import annotations

from collections.abc import Iterable

from woz_tui.config.file_position import FilePosition
from woz_tui.config.yaml_nodes import MappingNode, Node, ScalarNode

#: The entry of a mapping: its name, the place of its name, its value.
Entry = tuple[str, FilePosition, Node]
#: What a node is made of; a node stands for itself.
Value = str | float | bool | Node


def node(value: Value, place: FilePosition) -> Node:
    """A value as a node: text that is text whatever it looks like, a number with six digits."""
    match value:
        case bool():
            return ScalarNode(place, "true" if value else "false", plain=True)
        case float():
            return ScalarNode(place, f"{value:.6g}", plain=True)
        case str():
            return ScalarNode(place, value, plain=False)
    return value


def entry(name: str, value: Value, place: FilePosition) -> Entry:
    """An entry whose name and value have the same place."""
    return name, place, node(value, place)


def table(entries: Iterable[Entry], place: FilePosition) -> MappingNode:
    made = MappingNode(place)
    for name, where, value in entries:
        made.entries[name] = value
        made.keys[name] = ScalarNode(where, name, plain=True)
    return made
