"""Reads a session's log back, whatever has happened to its files.

A log is one or more segments, each a file of actions and one of samples. They are merged into one
stream by `seq`, with a small piece of each file in memory. Nothing damaged raises: it is left out,
counted and reported. `read` gives lines; `messages` gives messages, several times as fast;
`woz_tui.log.log_index` finds what was at a moment.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import chain
from pathlib import Path
from typing import Any

from woz_tui.log.damage import Damage
from woz_tui.log.line_order import N, SequenceChecker, in_order, merged, seq_of, t_of
from woz_tui.log.line_reader import BLOCK, LineChunk, LogLine, chunks_of, lines_in
from woz_tui.log.log_files import LogFiles, files_of, sizes_of
from woz_tui.protocol import codec
from woz_tui.protocol.messages import Message, ParticipantWithdrawn, Segment, SessionStart

#: A message, or the line of one that this version does not know or cannot take.
LogItem = Message | LogLine

#: Lines of which more is to be known than that they are sound.
_SINGULAR = {ParticipantWithdrawn, Segment, SessionStart}


def messages(
    path: Path,
    damage: Damage | None = None,
    *,
    places: Iterable[Path] | None = None,
    samples: bool = False,
    block: int = BLOCK,
) -> Iterator[LogItem]:
    """Every message of the session to which `path` belongs, in order, each once.

    What this version does not know or cannot take comes as its `LogLine`: nothing is lost. The
    result is that of `woz_tui.log.log_reader.read`, `damage` included, at a third of the cost; what
    that says of `path`, `places`, `samples`, memory and errors holds here too. `block`: bytes of
    each file that are decoded at once.
    """
    files = files_of(path, places, samples=samples)
    found = Damage() if damage is None else damage
    found.lacks(files.missing)
    every = batches(files.paths, found, gaps=samples, block=block)
    return chain.from_iterable(every)


def batches(
    paths: Sequence[Path],
    damage: Damage,
    *,
    gaps: bool,
    block: int = BLOCK,
    sizes: Mapping[Path, int] | None = None,
) -> Iterator[list[LogItem]]:
    """The messages of these files as one stream, many at a time; see `messages`.

    `gaps`: count the numbers that no message has. `sizes`: how many bytes of each are read; by
    default as many as there are now.
    """
    return _merged(paths, damage, items_in, gaps, block=block, sizes=sizes)


def _merged(
    paths: Sequence[Path],
    damage: Damage,
    decode: Callable[[LineChunk, Damage], list[N]],
    gaps: bool,
    *,
    block: int = BLOCK,
    sizes: Mapping[Path, int] | None = None,
) -> Iterator[list[N]]:
    """What `decode` finds in the pieces of these files, in order, each number once."""
    ends = sizes_of(paths) if sizes is None else sizes

    def decoded(path: Path) -> Iterator[list[N]]:
        chunks = chunks_of(path, damage, block, ends.get(path))
        return (decode(chunk, damage) for chunk in chunks)

    checker = SequenceChecker[N](damage, same, gaps=gaps)
    for batch in merged([in_order(decoded(path), damage) for path in paths]):
        yield checker.new_lines(batch)
    checker.end()


def items_in(chunk: LineChunk, damage: Damage) -> list[LogItem]:
    """The messages of a chunk: all at once if it is whole, line by line if anything is wrong."""
    return _all_at_once(chunk) or [
        line if line.message is None else line.message for line in lines_in(chunk, damage)
    ]


def _all_at_once(chunk: LineChunk) -> list[LogItem]:
    """The messages of a chunk in which nothing needs a second look; else none."""
    if chunk.data is None or not chunk.whole:
        return []
    try:
        found: list[Any] = codec.decode_messages(chunk.data)
    except codec.WireError:
        return []
    if not _SINGULAR.isdisjoint(map(type, found)):
        return []
    return found if min(map(seq_of, found)) >= 0 and min(map(t_of, found)) >= 0 else []


def same(one: object, other: object) -> bool:
    """Whether two lines or messages say the same."""
    if isinstance(one, LogLine) and isinstance(other, LogLine):
        if one.message is not None and other.message is not None:
            return one.message == other.message
        return one.raw == other.raw
    return one == other


__all__ = ["Damage", "LogFiles", "LogLine", "files_of", "merge", "messages", "read"]


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
    log is. Of a session that still runs comes what is written when the first line is asked for.
    Raises at once what `files_of` raises; nothing damaged raises.
    """
    files = files_of(path, places, samples=samples)
    found = Damage() if damage is None else damage
    found.lacks(files.missing)
    return merge(files.paths, found, gaps=samples)


def merge(paths: Sequence[Path], damage: Damage, *, gaps: bool = True) -> Iterator[LogLine]:
    """The lines of these files as one stream by `seq`; see `read`.

    `gaps`: count the numbers that no line has.
    """
    return chain.from_iterable(_merged(paths, damage, lines_in, gaps))
