"""A tree of nodes as YAML text that reads as the same tree, for people to go on with.

Sections and panels are written as blocks, actions as one line each as long as they fit.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

from woz_tui.config.yaml_nodes import ListNode, MappingNode, Node, ScalarNode

_WIDTH = 100
#: Sections, panels and what stands in a robot are never put on one line.
_BLOCKS = 3

#: What needs no quotes: a word or several that YAML takes for text.
_PLAIN = re.compile(r"[A-Za-z_/][A-Za-z0-9_./+-]*( [A-Za-z0-9_./+-]+)*")
#: What stands as typed if it stood without quotes: numbers, with or without a unit.
_NUMBER = re.compile(r"[-+]?[0-9][0-9.]*([eE][-+]?[0-9]+)?( ?[a-z]{1,3})?")
#: Words that YAML 1.1 or 1.2 takes for something else.
_RESERVED = frozenset({"true", "false", "yes", "no", "on", "off", "y", "n", "null", "~"})
_ESCAPES = {"\\": "\\\\", '"': '\\"', "\n": "\\n", "\t": "\\t", "\r": "\\r"}


def yaml_text(table: MappingNode, remarks: Mapping[int, str], head: str = "") -> str:
    """The text of a file. `remarks` are comments by the identity of nodes: above a section, behind
    an entry of a list. `head` are the comments at the top.
    """
    lines = [f"# {line}".rstrip() for line in head.splitlines()]
    writer = _YamlWriter(remarks)
    for name, _, node in table.items():
        if isinstance(node, MappingNode | ListNode) and lines:
            lines.append("")
        if id(node) in remarks:
            lines.append(f"# {remarks[id(node)]}")
        lines += writer.entry(name, node, 0)
    return "\n".join(lines) + "\n"


class _YamlWriter:
    def __init__(self, remarks: Mapping[int, str]) -> None:
        self._remarks = remarks

    def entry(self, name: str, node: Node, depth: int) -> Iterator[str]:
        """`name: value`, indented by two blanks for each level."""
        start = f"{'  ' * depth}{_text(name, plain=False)}:"
        line = self._line(start, node, depth)
        if line:
            yield line
            return
        yield start
        if isinstance(node, MappingNode):
            for inner, _, value in node.items():
                yield from self.entry(inner, value, depth + 1)
        elif isinstance(node, ListNode):
            for index, value in enumerate(node.nodes):
                if index and isinstance(value, MappingNode) and "actions" in value.entries:
                    yield ""
                yield from self._item(value, depth + 1)

    def _item(self, node: Node, depth: int) -> Iterator[str]:
        """`- value`; a mapping too long for one line begins behind the dash."""
        remark = self._remarks.get(id(node), "")
        line = self._line(f"{'  ' * depth}-", node, depth)
        beside = f"{line}  # {remark}"
        if line and remark and len(beside) <= _WIDTH:
            yield beside
            return
        if remark:
            yield f"{'  ' * depth}# {remark}"
        if line:
            yield line
            return
        inner = self._block(node, depth + 1)
        first = next(inner)
        yield f"{'  ' * depth}- {first.lstrip()}"
        yield from inner

    def _block(self, node: Node, depth: int) -> Iterator[str]:
        if isinstance(node, MappingNode):
            for name, _, value in node.items():
                yield from self.entry(name, value, depth)
        elif isinstance(node, ListNode):
            for value in node.nodes:
                yield from self._item(value, depth)

    def _line(self, start: str, node: Node, depth: int) -> str:
        """All of it on one line; empty if it does not fit or should not stand on one."""
        flow = _flow(node)
        if isinstance(node, ScalarNode) or flow in ("{}", "[]"):
            return f"{start} {flow}".rstrip()
        nested = isinstance(node, MappingNode) and depth < _BLOCKS
        holds = isinstance(node, ListNode) and any(
            not isinstance(n, ScalarNode) for n in node.nodes
        )
        fits = len(start) + 1 + len(flow) <= _WIDTH
        return f"{start} {flow}" if fits and not nested and not holds else ""


def _flow(node: Node) -> str:
    match node:
        case MappingNode():
            pairs = (
                f"{_text(name, plain=False)}: {_flow(value)}" for name, _, value in node.items()
            )
            return "{" + ", ".join(pairs) + "}"
        case ListNode():
            return "[" + ", ".join(map(_flow, node.nodes)) + "]"
        case _:
            return _text(node.text, plain=node.plain)


def _text(text: str, *, plain: bool) -> str:
    """One scalar. Plain ones stay plain where that reads the same; others look plain only where
    nobody can take them for anything but text.
    """
    if plain and (not text or text.lower() in _RESERVED or _NUMBER.fullmatch(text)):
        return text
    if _PLAIN.fullmatch(text) and text.lower() not in _RESERVED:
        return text
    if text.isprintable() and ("\\" in text or '"' in text):
        return "'" + text.replace("'", "''") + "'"
    return '"' + "".join(map(_escaped, text)) + '"'


def _escaped(sign: str) -> str:
    if sign.isprintable():
        return _ESCAPES.get(sign, sign)
    return _ESCAPES.get(sign) or f"\\U{ord(sign):08X}"
