"""More actions in the text of an experiment file: all that stands there stays as it is.

The text is not written anew from what was read: lines go in at one place, so that comments, order
and quotes are kept byte for byte. Whoever uses the result reads it again before it counts.
"""

from __future__ import annotations

import codecs
import json
import os
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import yaml

_Loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_BREAK = re.compile(r"\r\n|\n|\r")
#: What YAML allows between double quotes only as an escape.
_ESCAPED = re.compile("[\x7f-\x9f\u2028\u2029\ufeff\ufffe\uffff]")
#: The end that a copy's name has already.
_COPIED = re.compile(r"-typed(-\d+)?\Z")
_CREATE = os.O_CREAT | os.O_EXCL | os.O_WRONLY | os.O_CLOEXEC


class AppendError(Exception):
    """There is no place where the actions could stand; the text says why."""


@dataclass(frozen=True, slots=True)
class AppendedFile:
    """All bytes of the new file, the lines that came in, and behind which line of the old one."""

    data: bytes
    lines: tuple[str, ...]
    after: int

    def diff(self, old: str, new: str) -> list[str]:
        """What comes in, as `diff -U0` shows it; lines that were there are not quoted."""
        at = f"@@ -{self.after},0 +{self.after + 1},{len(self.lines)} @@"
        return [f"--- {old}", f"+++ {new}", at, *(f"+{line}" for line in self.lines)]


def quoted(text: str) -> str:
    """A text between double quotes, on one line, for YAML."""
    written = json.dumps(text, ensure_ascii=False)
    return _ESCAPED.sub(lambda found: f"\\u{ord(found[0]):04x}", written)


def append_actions(data: bytes, title: str, actions: Sequence[str]) -> AppendedFile:
    """The file with these actions (`{key: "1", ...}`) at the end of the panel `title`, which is
    made behind the last one if there is none. Raises `AppendError`.
    """
    mark = codecs.BOM_UTF8 if data.startswith(codecs.BOM_UTF8) else b""
    text = data.removeprefix(mark).decode("utf-8")
    panels = _list(_value(yaml.compose(text, _Loader), "panels"), "panels")
    panel = next((each for each in panels.value if _text(_value(each, "title")) == title), None)
    if panel is not None:
        target = _list(_value(panel, "actions"), f"actions of the panel {title}")
        blocks = [[action] for action in actions]
    else:
        target = panels
        blocks = [[f"title: {title}", "actions:", *(f"  - {action}" for action in actions)]]
    if target.flow_style:
        inline = ", ".join(actions)
        items = inline if panel is not None else f"{{title: {title}, actions: [{inline}]}}"
        return _append_inline(mark, text, target, items)
    return _append_lines(mark, text, target, blocks)


def _append_inline(mark: bytes, text: str, target: yaml.SequenceNode, items: str) -> AppendedFile:
    """Into a list between brackets, behind its last entry."""
    if target.value:
        at = target.value[-1].end_mark.index
        piece = f", {items}"
    else:
        at = target.end_mark.index - 1
        piece = items
    line = len(_BREAK.findall(text[:at])) + 1
    return AppendedFile(mark + (text[:at] + piece + text[at:]).encode(), (piece,), line)


def _append_lines(
    mark: bytes, text: str, target: yaml.SequenceNode, blocks: Sequence[Sequence[str]]
) -> AppendedFile:
    """Below the last entry of a list with a line for each, and below its comments."""
    column = target.start_mark.column
    indent = " " * column
    at = _next_entry_at(text, target, column)
    lines = [
        f"{indent}{'  ' if number else '- '}{line}"
        for block in blocks
        for number, line in enumerate(block)
    ]
    if len(target.value) > 1 and _has_blank_line(text, target.value[-1].start_mark.index):
        lines = ["", *lines]
    found = _BREAK.search(text)
    end = found[0] if found else "\n"
    before = text[:at] if not at or text[:at].endswith(("\n", "\r")) else text[:at] + end
    new = before + "".join(line + end for line in lines) + text[at:]
    return AppendedFile(mark + new.encode(), tuple(lines), len(_BREAK.findall(before)))


def _next_entry_at(text: str, target: yaml.SequenceNode, column: int) -> int:
    """The beginning of the line where the next entry belongs."""
    leaf = max(_leaves(target), key=lambda node: node.end_mark.index)
    at: int = leaf.end_mark.index
    block = isinstance(leaf, yaml.ScalarNode) and leaf.style in ("|", ">")
    if not block:  # such a text ends with its line
        at = _next_line(text, at)
    comment = re.compile(rf"[ ]{{{max(column, 1)},}}#")
    while comment.match(text, at):
        at = _next_line(text, at)
    return at


def _next_line(text: str, at: int) -> int:
    found = _BREAK.search(text, at)
    return found.end() if found else len(text)


def _leaves(node: yaml.Node) -> Iterator[yaml.Node]:
    """What ends where its text ends: a list with lines of its own ends where the next thing is."""
    if not isinstance(node, yaml.CollectionNode) or node.flow_style or not node.value:
        yield node
        return
    for each in node.value:
        for inner in each if isinstance(each, tuple) else (each,):
            yield from _leaves(inner)


def _has_blank_line(text: str, at: int) -> bool:
    """Whether the entry that begins here stands below an empty line, and maybe comments."""
    above = [line.strip() for line in _BREAK.split(text[:at])[:-1]]
    while above and above[-1].startswith("#"):
        above.pop()
    return bool(above) and not above[-1]


def _value(node: yaml.Node | None, name: str) -> yaml.Node | None:
    if not isinstance(node, yaml.MappingNode):
        return None
    return next((value for key, value in node.value if _text(key) == name), None)


def _text(node: yaml.Node | None) -> str | None:
    return str(node.value) if isinstance(node, yaml.ScalarNode) else None


def _list(node: yaml.Node | None, what: str) -> yaml.SequenceNode:
    if isinstance(node, yaml.SequenceNode):
        return node
    raise AppendError(f"the file has no list of {what} to which they could be added")


def copy_names(path: Path) -> Iterator[Path]:
    """What a copy beside `path` may be called: talk-typed.yaml, talk-typed-2.yaml ..."""
    stem = f"{_COPIED.sub('', path.stem)}-typed"
    yield path.with_name(f"{stem}{path.suffix}")
    for number in range(2, 1000):
        yield path.with_name(f"{stem}-{number}{path.suffix}")


def is_typed_copy(path: Path) -> bool:
    """Whether the file is called like such a copy."""
    return _COPIED.search(path.stem) is not None


def write_copy(path: Path, data: bytes) -> Path:
    """Write `data` beside `path` under a name that nothing has. Raises `OSError`; then no file of
    it is left.
    """
    for copy in copy_names(path):
        try:
            file = os.open(copy, _CREATE, 0o666)
        except FileExistsError:
            continue
        try:
            with os.fdopen(file, "wb") as out:
                out.write(data)
                out.flush()
                os.fsync(out.fileno())
        except OSError:
            copy.unlink(missing_ok=True)
            raise
        return copy
    raise FileExistsError(f"{path.name} has too many copies")
