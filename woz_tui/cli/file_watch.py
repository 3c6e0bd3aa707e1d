"""Does something again each time that files are saved, in whatever editor."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterable
from pathlib import Path

#: How often is looked, in seconds: an editor's save is seen at once, and costs nothing meanwhile.
LOOK_S = 0.2
#: What of a file tells that it was saved: its time, its size, and that another one took its place.
_Stamp = tuple[int, int, int]


def pause() -> None:
    """Until it is looked again."""
    time.sleep(LOOK_S)


def watch(
    draw: Callable[[], object],
    files: Callable[[], Iterable[Path]],
    wait: Callable[[], object] = pause,
) -> None:
    """`draw` now and whenever one of the `files` is another one than before, until ctrl+c. Which
    files these are is asked each time.
    """
    seen: dict[Path, _Stamp] | None = None
    with contextlib.suppress(KeyboardInterrupt):
        while True:
            now = _stamps(files())
            if now != seen:
                draw()
                seen = {
                    **_stamps(files()),
                    **now,
                }  # more files may be known, and one saved meanwhile
            wait()


def _stamps(files: Iterable[Path]) -> dict[Path, _Stamp]:
    """Those that are there: many editors take a file away for a moment while they save it."""
    stamps = {}
    for file in files:
        with contextlib.suppress(OSError):
            found = file.stat()
            stamps[file] = (found.st_mtime_ns, found.st_size, found.st_ino)
    return stamps
