"""Reads a session's log back, whatever has happened to its files.

A log is one or more segments, each a file of actions and one of samples. They are merged into one
stream by `seq`, with a small piece of each file in memory. Nothing damaged raises: it is left out,
counted and reported. `woz_tui.log.message_stream` gives messages instead of lines, several times as
fast; `woz_tui.log.log_index` finds what was at a moment.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from woz_tui.log.damage import Damage
from woz_tui.log.line_order import SequenceChecker, in_order, merged
from woz_tui.log.line_reader import LogLine, chunks_of, lines_in, lines_of
from woz_tui.log.log_files import LogFiles, files_of

__all__ = ["Damage", "LogFiles", "LogLine", "files_of", "lines_of", "merge", "read", "same_line"]


def read(
    path: Path,
    damage: Damage | None = None,
    *,
    places: Iterable[Path] | None = None,
    samples: bool = True,
) -> Iterator[LogLine]:
    """Every line of the session to which `path` belongs, in order, each once.

    `path` is any file of the session; `damage` is filled in on the way. Without `samples` no file
    of samples is opened, and missing numbers are not counted. Memory stays flat however long the
    log is. Raises at once what `files_of` raises; nothing damaged raises.
    """
    files = files_of(path, places, samples=samples)
    found = Damage() if damage is None else damage
    found.lacks(files.missing)
    return merge(files.paths, found, gaps=samples)


def merge(paths: Sequence[Path], damage: Damage, *, gaps: bool = True) -> Iterator[LogLine]:
    """The lines of these files as one stream by `seq`; see `read`.

    `gaps`: count the numbers that no line has.
    """
    course = SequenceChecker[LogLine](damage, same_line, gaps=gaps)
    for batch in merged([in_order(_batches(path, damage), damage) for path in paths]):
        yield from course.take(batch)
    course.end()


def _batches(path: Path, damage: Damage) -> Iterator[list[LogLine]]:
    return (lines_in(chunk, damage) for chunk in chunks_of(path, damage))


def same_line(one: LogLine, other: LogLine) -> bool:
    """Whether two lines say the same."""
    if one.message is not None and other.message is not None:
        return one.message == other.message
    return one.raw == other.raw
