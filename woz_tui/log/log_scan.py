"""Goes through a session's files once, so that `woz_tui.log.log_index` knows what is where."""

from __future__ import annotations

import os
import zlib
from bisect import bisect_left, bisect_right
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import BinaryIO

import msgspec

from woz_tui.log.damage import Damage
from woz_tui.log.line_order import SequenceChecker, count_falls, is_rising, seq_of, t_of
from woz_tui.log.line_reader import KINDS, LineChunk, LogLine, chunks_of
from woz_tui.log.log_files import LogFiles
from woz_tui.log.message_stream import LogItem, batches, items_in
from woz_tui.log.sample_blocks import (
    QuickReading,
    SampleBlock,
    SampleEntry,
    entries_in,
    last_samples,
)
from woz_tui.log.samples_index import (
    Hole,
    IndexBuilder,
    IndexEntry,
    StaleIndexError,
    entry_of,
    is_long,
    read_index,
)
from woz_tui.protocol import codec
from woz_tui.protocol.messages import EngagementShown, Reading, SessionEnd
from woz_tui.system.files import open_regular

#: The end of a session is among so many last messages.
_NEAR_END = 16


@dataclass
class LogScan:
    """What was found: the actions themselves, the samples by block."""

    actions: list[LogItem] = field(default_factory=list)
    blocks: list[SampleBlock] = field(default_factory=list)
    damage: Damage = field(default_factory=Damage)


class _OutOfOrderError(Exception):
    """The files do not hold the samples in order, each once."""


def scan(files: LogFiles, opened: ExitStack, block: int, *, indexed: bool = True) -> LogScan:
    """Go through all files, `block` bytes at a time; those that are needed later are opened and put
    into `opened`. Samples that an index describes are left where they are, unless not `indexed`.
    """
    try:
        return _in_place(files, opened, block, indexed)
    except _OutOfOrderError:
        return _copied(files, block)


def is_sample(item: SampleEntry) -> bool:
    """Whether something belongs to the samples: what is one, or is unknown and came without `ts`,
    as samples do.
    """
    if isinstance(item, LogLine):
        return item.sample or (item.kind not in KINDS and not item.ts)
    return isinstance(item, (QuickReading, Reading, EngagementShown))


# -- files as they should be ----------------------------------------------------------------------


def _in_place(files: LogFiles, opened: ExitStack, block: int, indexed: bool) -> LogScan:
    """Blocks are pieces of the files of samples themselves."""
    found = LogScan()
    for batch in batches(files.actions, found.damage, gaps=False, block=block):
        if any(map(is_sample, batch)):
            raise _OutOfOrderError
        found.actions += batch
    found.damage.backwards = 0  # counted anew, among the samples
    weave = _Interleaving(found.actions, found.damage)
    ended = any(isinstance(action, SessionEnd) for action in found.actions[-_NEAR_END:])
    for path in files.samples:
        source = _open(path, opened)
        index = read_index(path, source) if indexed and source is not None else None
        if source is not None and index and weave.passes(index):
            _headed(path, source, index[0].offset, found.damage)
            found.blocks += map(partial(_indexed, source), index)
            continue
        builder = IndexBuilder() if ended and source and is_long(source.fileno()) else None
        for chunk in chunks_of(path, found.damage, block):
            quick = entries_in(chunk)
            entries = list[SampleEntry](quick) or _looked_at(chunk, found.damage)
            if entries and source is not None:
                low, high = weave.take(entries)
                read = partial(_piece, source, len(chunk.data or b""), chunk.offset)
                found.blocks.append(SampleBlock(read, low, high, last_samples(quick or entries)))
            if builder is not None and source is not None:
                builder.take(source.fileno(), chunk, quick)
        if builder is not None and source is not None:
            builder.leave(path, source.fileno())
    weave.end()
    return found


def _headed(path: Path, source: BinaryIO, size: int, damage: Damage) -> None:
    """Account for the line with which a further segment begins."""
    items_in(LineChunk(path, 0, _piece(source, size, 0)), damage)


def _indexed(source: BinaryIO, entry: IndexEntry) -> SampleBlock:
    """A block of which the index says what is in it."""
    return SampleBlock(_Checked(source, entry), entry.first_us, entry.last_us, entry.lasts)


class _Checked:
    """Reads a block; the first time also whether the index is right about it."""

    def __init__(self, source: BinaryIO, entry: IndexEntry) -> None:
        self._source = source
        self._entry = entry
        self._checked = False

    def __call__(self) -> bytes:
        """The bytes, none if the file can be read no longer. Raises `StaleIndexError`."""
        entry = self._entry
        data = _piece(self._source, entry.size, entry.offset)
        if data and not self._checked:
            if entry_of(entry.offset, data) != entry:
                raise StaleIndexError
            self._checked = True
        return data


def _open(path: Path, opened: ExitStack) -> BinaryIO | None:
    try:
        return opened.enter_context(open_regular(path))
    except OSError:
        return None  # `chunks_of` says so


def _piece(source: BinaryIO, size: int, offset: int) -> bytes:
    """Bytes of a file that may have been closed, cut short or lost meanwhile; then none."""
    try:
        return os.pread(source.fileno(), size, offset)
    except (OSError, ValueError):
        return b""


def _looked_at(chunk: LineChunk, damage: Damage) -> list[SampleEntry]:
    """What is left of the samples of a chunk with which something is wrong."""
    found = list[SampleEntry](items_in(chunk, damage))
    if not all(map(is_sample, found)):
        raise _OutOfOrderError
    return found


class _Interleaving:
    """Counts the session's numbers and times over its samples and the actions among them.

    It says what `SequenceChecker` says, mostly without putting the actions in their places, which
    for some actions among a million samples would take longer than all the rest.
    """

    def __init__(self, actions: list[LogItem], damage: Damage) -> None:
        self._actions = actions
        self._numbers = list(map(seq_of, actions))
        self._damage = damage
        self._lost = damage.repeated + damage.conflicting
        self._course = SequenceChecker[SampleEntry](damage, lambda *_: False, gaps=True)
        self._given = 0
        self._last = self._last_us = -1

    def take(self, entries: list[SampleEntry]) -> tuple[int, int]:
        """More samples; the smallest and the greatest `t` of them."""
        numbers, times = list(map(seq_of, entries)), list(map(t_of, entries))
        if numbers[0] <= self._last or not is_rising(numbers):
            raise _OutOfOrderError
        end = bisect_right(self._numbers, numbers[-1], self._given)
        actions = list[SampleEntry](self._actions[self._given : end])
        backwards = count_falls(times)
        if not backwards and self._smooth(actions, numbers, times):
            self._course.pass_over(entries[-1])
        else:
            self._course.take(sorted([*actions, *entries], key=seq_of))
        self._given, self._last, self._last_us = end, numbers[-1], times[-1]
        return (min(times), max(times)) if backwards else (times[0], times[-1])

    def _smooth(self, actions: list[SampleEntry], numbers: list[int], times: list[int]) -> bool:
        """Whether no number is missing or there twice, and no time lies before another."""
        last_us = self._last_us
        if numbers[-1] - self._last != len(numbers) + len(actions) or times[0] < last_us:
            return False
        for action in actions:
            place = bisect_left(numbers, action.seq)
            before = max(last_us, times[place - 1] if place else -1)
            if numbers[place] == action.seq or not before <= action.t <= times[place]:
                return False
            last_us = action.t
        return True

    def passes(self, index: list[IndexEntry]) -> bool:
        """Take in the samples of an index if nothing is wrong with them: no number is missing or
        there twice, no time lies before another.
        """
        given, last, last_us = self._given, self._last, self._last_us
        for entry in index:
            if entry.first <= last or entry.first_us < last_us:
                return False
            gap = Hole(last + 1, entry.first - 1, last_us, entry.first_us)
            for hole in (gap, *entry.holes):
                end = given + hole.last - hole.first + 1
                actions = self._actions[given:end]
                numbers = self._numbers[given:end]
                times = [hole.before_us, *map(t_of, actions), hole.after_us]
                if numbers != list(range(hole.first, hole.last + 1)) or count_falls(times):
                    return False
                given = end
            last, last_us = entry.last, entry.last_us
        self._given, self._last, self._last_us = given, last, last_us
        self._course.pass_over(QuickReading(seq=last, t=last_us, sensor="", value=None))
        return True

    def end(self) -> None:
        """There are no more samples."""
        self._course.take(list[SampleEntry](self._actions[self._given :]))
        self._course.end()
        if self._damage.repeated + self._damage.conflicting > self._lost:
            raise _OutOfOrderError


# -- files as they should not be ------------------------------------------------------------------


def _copied(files: LogFiles, block: int) -> LogScan:
    """Blocks are copies, compressed and in memory: all samples, each once and in order."""
    found = LogScan()
    for batch in batches(files.paths, found.damage, gaps=True, block=block):
        samples = [item for item in batch if type(item) is Reading or is_sample(item)]
        if len(samples) < len(batch):
            found.actions += [item for item in batch if not is_sample(item)]
        if samples:
            times = list(map(t_of, samples))
            packed = zlib.compress(codec.encode_lines(map(_written, samples)), 1)
            read = partial(zlib.decompress, packed)
            found.blocks.append(SampleBlock(read, min(times), max(times), last_samples(samples)))
    return found


def _written(item: LogItem) -> msgspec.Struct | msgspec.Raw:
    return msgspec.Raw(item.raw) if isinstance(item, LogLine) else item
