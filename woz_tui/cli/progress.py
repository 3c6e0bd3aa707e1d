"""A line on the terminal while something takes its time; nothing in a pipe."""

from __future__ import annotations

import contextlib
import sys
import time
from collections.abc import Callable, Iterator

from woz_tui.cli.safe_streams import raw_stream
from woz_tui.system.text_cleaning import clean

#: What takes no longer than this is not worth a line, in seconds; and so long a line stays.
WORTH_S, EVERY_S = 1.0, 0.2
_CLEAR = "\r\x1b[K"


@contextlib.contextmanager
def progress(
    now: Callable[[], float] = time.monotonic, patience_s: float = WORTH_S
) -> Iterator[Callable[[str], None]]:
    """A function that shows how far one is, after `patience_s`; the line is gone at the end."""
    if sys.stderr is None or not sys.stderr.isatty():
        yield lambda text: None
        return
    stream = raw_stream(sys.stderr)
    due = now() + patience_s
    shown = False

    def show(text: str) -> None:
        nonlocal due, shown
        if now() >= due:
            due, shown = now() + EVERY_S, True
            stream.write(f"{_CLEAR}{clean(text)}")
            stream.flush()

    try:
        yield show
    finally:
        if shown:
            stream.write(_CLEAR)
            stream.flush()
