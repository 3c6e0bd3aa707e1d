"""Lines of a file of inputs, of standard input, or of a session's log, each with its place."""

from __future__ import annotations

import codecs
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from woz_tui.log.log_files import files_of
from woz_tui.protocol import codec
from woz_tui.system.files import open_regular

# -- render inputs ---------------------------------------------------------------------------------
_BEGINS_LOG = re.compile(rb'\s*\{\s*"kind"\s*:\s*"(?:session\.start|segment)"')


def input_lines(name: str) -> Iterator[tuple[str, bytes]]:
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
