"""Cleans standard output and standard error: nothing printed there controls the terminal.

What is printed quotes files, logs and paths, which may hold anything. So that no command has to
think of it, both streams are replaced before a command begins: by `print`, argparse, logging and
tracebacks alike. Data is not changed by it: JSON is printed with `json_text`, which escapes.
"""

from __future__ import annotations

import json
import sys
from typing import Any, TextIO, cast

from woz_tui.system.text_cleaning import clean_lines, escaped


class _CleanStream:
    """A text stream that cleans what is written; all else is the stream's own."""

    def __init__(self, stream: TextIO) -> None:
        #: The name by which Rich looks for the stream itself: its consoles write colours there.
        self.rich_proxied_file = stream

    def write(self, text: str) -> int:
        """Write `text` as a terminal may have it."""
        self.rich_proxied_file.write(clean_lines(text))
        return len(text)

    def writelines(self, lines: Any) -> None:
        for line in lines:
            self.write(line)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.rich_proxied_file, name)


def clean_streams() -> None:
    """Clean everything that is printed from now on, to the end of the process: tracebacks, too."""
    sys.stdout = _clean_stream(sys.stdout)
    sys.stderr = _clean_stream(sys.stderr)


def _clean_stream(stream: TextIO | None) -> Any:
    return stream if stream is None or isinstance(stream, _CleanStream) else _CleanStream(stream)


def raw_stream(stream: TextIO) -> TextIO:
    """The stream itself, for code that writes a terminal's sequences; texts among them need
    `clean`.
    """
    return cast(TextIO, getattr(stream, "rich_proxied_file", stream))


def json_text(value: object, **options: Any) -> str:
    """`value` as JSON that can be read and may be shown; `options` are those of `json.dumps`."""
    return escaped(json.dumps(value, ensure_ascii=False, **options))
