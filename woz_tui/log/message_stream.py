"""A session's messages, for those who want them all and fast."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from woz_tui.log.damage import Damage
from woz_tui.log.line_order import SequenceChecker, in_order, merged, seq_of, t_of
from woz_tui.log.line_reader import BLOCK, LineChunk, LogLine, chunks_of, lines_in
from woz_tui.log.log_files import files_of
from woz_tui.protocol import codec
from woz_tui.protocol.messages import AnyMessage, Segment, SessionStart

#: A message, or the line of one that this version does not know or cannot take.
LogItem = AnyMessage | LogLine

#: Lines of which more is to be known than that they are sound.
_SINGULAR = {Segment, SessionStart}


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
    return (item for batch in every for item in batch)


def batches(
    paths: Sequence[Path], damage: Damage, *, gaps: bool, block: int = BLOCK
) -> Iterator[list[LogItem]]:
    """The messages of these files as one stream, many at a time; see `messages`.

    `gaps`: count the numbers that no message has.
    """
    course = SequenceChecker[LogItem](damage, same, gaps=gaps)
    for batch in merged([in_order(_decoded(path, damage, block), damage) for path in paths]):
        yield course.take(batch)
    course.end()


def _decoded(path: Path, damage: Damage, block: int) -> Iterator[list[LogItem]]:
    return (items_in(chunk, damage) for chunk in chunks_of(path, damage, block))


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


def same(one: LogItem, other: LogItem) -> bool:
    """Whether two say the same."""
    if isinstance(one, LogLine) and isinstance(other, LogLine):
        return one.raw == other.raw
    return one == other
