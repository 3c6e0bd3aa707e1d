"""The inputs of `woz render`: their lines, and a description made from the verbs themselves."""

from __future__ import annotations

import codecs
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from woz_tui.drivers.contract import Argument
from woz_tui.log.log_files import files_of
from woz_tui.motion.body_shape import BodyShape, FaceShape
from woz_tui.motion.body_verbs import body_verbs
from woz_tui.protocol import codec
from woz_tui.system.files import open_regular

_BEGINS_LOG = re.compile(rb'\s*\{\s*"kind"\s*:\s*"(?:session\.start|segment)"')

#: Inputs that are no verb of a body.
BEYOND = (
    ("seen", "`x`, `y` (-1..1, null: nothing is seen), `size` (0..1)", "what the camera sees"),
    ("stop", "", "ends all movement and returns to the mode normal"),
    ("freeze", "", "the emergency stop: stands still until `resume`"),
    ("resume", "", "the emergency stop is released"),
)


def lines_of(name: str) -> Iterator[tuple[str, bytes]]:
    """Each line of the file called `name`, without its newline, with its place; `-` is standard
    input. Of a session's log those of all its files. Raises `OSError`.
    """
    if name == "-":
        yield from _numbered("standard input", sys.stdin.buffer)
        return
    path = Path(name)
    with path.open("rb") as file:
        first = file.readline(codec.MAX_LINE)
        if not (path.is_file() and _BEGINS_LOG.match(first)):
            yield from _numbered(name, file, first)
            return
    for each in files_of(path, samples=False).actions:
        with open_regular(each) as file:
            yield from _numbered(str(each), file)


def _numbered(name: str, file: BinaryIO, first: bytes = b"") -> Iterator[tuple[str, bytes]]:
    """Of a line that is longer than any message the beginning, which is no JSON."""
    line = (first or file.readline(codec.MAX_LINE)).removeprefix(codecs.BOM_UTF8)
    number = 0
    while line:
        number += 1
        yield f"{name}:{number}", line.rstrip(b"\n")
        while line and not line.endswith(b"\n"):
            line = file.readline(codec.MAX_LINE)
        line = file.readline(codec.MAX_LINE)


def described() -> str:
    """A table of all inputs in Markdown."""
    shape = BodyShape(joints={}, face=FaceShape())
    rows = [
        (verb.name, ", ".join(map(_argument, verb.arguments)), verb.summary)
        for verb in body_verbs(shape, ())
    ]
    head = ["| input | arguments | what it does |", "|---|---|---|"]
    return "\n".join(
        [*head, *(f"| `{name}` | {what} | {why} |" for name, what, why in (*rows, *BEYOND))]
    )


def _argument(argument: Argument) -> str:
    parts = [argument.kind if argument.kind != "choice" else ""]
    if argument.kind == "choice":
        parts = [" ".join(filter(None, argument.choices))] if argument.name != "move" else ["text"]
    if argument.range is not None:
        parts.append(str(argument.range))
    if not argument.required:
        parts.append("optional")
    return f"`{argument.name}` ({', '.join(filter(None, parts))})"
