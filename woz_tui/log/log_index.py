"""Random access to a session's log: the state at a moment, the messages between two moments.

    with LogIndex.open(path) as log:
        log.length_us                     # how long the session was
        log.actions                       # every message but samples, in order of `seq`
        log.damage.sentences()            # what was wrong with the files
        state = log.at(t_us)              # state.readings["distance"].value, state.shown
        for message in log.between(t_us, t_us + 50_000):
            ...                           # actions and samples, in order of `seq`

Actions are in memory. Samples stay on the disk (`woz_tui.log.sample_blocks`) and are read when they
are asked for.
"""

from __future__ import annotations

import heapq
import os
import zlib
from bisect import bisect_right
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import BinaryIO, Self

import msgspec

from woz_tui.log.damage import Damage
from woz_tui.log.line_order import SequenceChecker, count_falls, is_rising, seq_of, t_of
from woz_tui.log.line_reader import KINDS, LineChunk, LogLine, chunks_of
from woz_tui.log.log_files import LogFiles, files_of, sizes_of
from woz_tui.log.log_opening import open_log
from woz_tui.log.log_reader import LogItem, batches, items_in
from woz_tui.log.sample_blocks import (
    QuickReading,
    SampleBlock,
    SampleBlocks,
    SampleEntry,
    SampleState,
    entries_in,
    in_steady_series,
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

#: The end of a session is among so many last messages.
_NEAR_END = 16


@dataclass
class LogScan:
    """What was found: the actions themselves, the samples by block."""

    actions: list[LogItem] = field(default_factory=list)
    blocks: list[SampleBlock] = field(default_factory=list)
    damage: Damage = field(default_factory=Damage)


class _OutOfOrderError(Exception):
    """The files do not hold the samples in order, or some of them twice."""


def scan(files: LogFiles, opened: ExitStack, block: int, *, indexed: bool = True) -> LogScan:
    """Go through all files, `block` bytes at a time; those that are needed later are opened and put
    into `opened`. Samples that an index describes are left where they are, unless not `indexed`.
    """
    try:
        return _scan_in_place(files, opened, block, indexed)
    except _OutOfOrderError:
        return _scan_into_copies(files, block)


def is_sample(item: SampleEntry) -> bool:
    """Whether something belongs to the samples: what is one, or is unknown and came without `ts`,
    as samples do.
    """
    if isinstance(item, LogLine):
        return item.sample or (item.kind not in KINDS and not item.ts)
    return isinstance(item, (QuickReading, Reading, EngagementShown))


# -- files as they should be ----------------------------------------------------------------------


def _scan_in_place(files: LogFiles, opened: ExitStack, block: int, indexed: bool) -> LogScan:
    """Blocks are pieces of the files of samples themselves."""
    found = LogScan()
    sizes = sizes_of(files.paths)
    for batch in batches(files.actions, found.damage, gaps=False, block=block, sizes=sizes):
        if any(map(is_sample, batch)):
            raise _OutOfOrderError
        found.actions += batch
    found.damage.backwards = 0  # counted anew, among the samples
    weave = _Interleaving(found.actions, found.damage)
    ended = any(isinstance(action, SessionEnd) for action in found.actions[-_NEAR_END:])
    for path in files.samples:
        source: BinaryIO | None = None
        with suppress(OSError):  # `chunks_of` says so
            source = opened.enter_context(open_log(path))
        index = read_index(path, source) if indexed and source is not None else None
        if source is not None and index and weave.passes(index):
            # The line with which a further segment begins stands before the first block.
            head = _piece(source, index[0].offset, 0)
            items_in(LineChunk(path, 0, head), found.damage)
            found.blocks += map(partial(_block_of_index, source), index)
            continue
        for chunk in chunks_of(path, found.damage, block, sizes.get(path)):
            quick = entries_in(chunk)
            entries = list[SampleEntry](quick) or _sound_samples(chunk, found.damage)
            if entries and source is not None:
                low, high = weave.add(entries)
                read = partial(_piece, source, len(chunk.data or b""), chunk.offset)
                found.blocks.append(SampleBlock(read, low, high, last_samples(quick or entries)))
        if ended and source is not None and is_long(source.fileno()):
            builder = IndexBuilder()
            builder.extend(source.fileno(), os.fstat(source.fileno()).st_size, whole=True)
            builder.leave(path, source.fileno())
    weave.end()
    return found


def _block_of_index(source: BinaryIO, entry: IndexEntry) -> SampleBlock:
    """A block of which the index says what is in it."""
    checked = False

    def read() -> bytes:
        """The bytes, none if the file can be read no longer. Raises `StaleIndexError`."""
        nonlocal checked
        data = _piece(source, entry.size, entry.offset)
        if data and not checked:  # whether the index is right about it
            if entry_of(entry.offset, data) != entry:
                raise StaleIndexError
            checked = True
        return data

    return SampleBlock(read, entry.first_us, entry.last_us, entry.lasts)


def _piece(source: BinaryIO, size: int, offset: int) -> bytes:
    """Bytes of a file that may have been closed, cut short or lost meanwhile; then none."""
    try:
        return os.pread(source.fileno(), size, offset)
    except (OSError, ValueError):
        return b""


def _sound_samples(chunk: LineChunk, damage: Damage) -> list[SampleEntry]:
    """What is left of the samples of a chunk with which something is wrong."""
    found = list[SampleEntry](items_in(chunk, damage))
    if not all(map(is_sample, found)):
        raise _OutOfOrderError
    return found


class _Interleaving:
    """Counts the session's numbers and times over its samples and the actions among them.

    Samples that an index describes it only compares with the actions, without reading them.
    """

    def __init__(self, actions: list[LogItem], damage: Damage) -> None:
        self._actions = actions
        self._numbers = list(map(seq_of, actions))
        self._damage = damage
        self._lost = damage.repeated + damage.conflicting
        self._checker = SequenceChecker[SampleEntry](damage, lambda *_: False, gaps=True)
        self._passed = 0
        self._last = self._last_us = -1

    def add(self, entries: list[SampleEntry]) -> tuple[int, int]:
        """More samples; the smallest and the greatest `t` of them."""
        numbers, times = list(map(seq_of, entries)), list(map(t_of, entries))
        if numbers[0] <= self._last or not is_rising(numbers):
            raise _OutOfOrderError
        end = bisect_right(self._numbers, numbers[-1], self._passed)
        actions = list[SampleEntry](self._actions[self._passed : end])
        backwards = count_falls(times)
        self._checker.new_lines(sorted([*actions, *entries], key=seq_of))
        self._passed, self._last, self._last_us = end, numbers[-1], times[-1]
        return (min(times), max(times)) if backwards else (times[0], times[-1])

    def passes(self, index: list[IndexEntry]) -> bool:
        """Take in the samples of an index if nothing is wrong with them: no number is missing or
        there twice, no time lies before another.
        """
        given, last, last_us = self._passed, self._last, self._last_us
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
        self._passed, self._last, self._last_us = given, last, last_us
        self._checker.pass_over(QuickReading(seq=last, t=last_us, sensor="", value=None))
        return True

    def end(self) -> None:
        """There are no more samples."""
        self._checker.new_lines(list[SampleEntry](self._actions[self._passed :]))
        self._checker.end()
        if self._damage.repeated + self._damage.conflicting > self._lost:
            raise _OutOfOrderError


# -- files as they should not be ------------------------------------------------------------------


def _scan_into_copies(files: LogFiles, block: int) -> LogScan:
    """Blocks are copies, compressed and in memory: all samples, each once and in order."""
    found = LogScan()
    for batch in batches(files.paths, found.damage, gaps=True, block=block):
        samples = [item for item in batch if type(item) is Reading or is_sample(item)]
        if len(samples) < len(batch):
            found.actions += [item for item in batch if not is_sample(item)]
        if samples:
            times = list(map(t_of, samples))
            lines = (
                msgspec.Raw(item.raw) if isinstance(item, LogLine) else item for item in samples
            )
            packed = zlib.compress(codec.encode_lines(lines), 1)
            read = partial(zlib.decompress, packed)
            found.blocks.append(SampleBlock(read, min(times), max(times), last_samples(samples)))
    return found


__all__ = ["LogIndex", "SampleState"]

#: Bytes of samples that are decoded to find one moment: a second and more of four at 100 Hz.
_BLOCK = 1 << 16


class LogIndex:
    """The log of a session, opened. Made by `open`; used by one thread at a time.

    Attributes:
        actions: Every message that is no sample, in order of `seq`, in memory. What this version
            does not know or cannot take is there as its `LogLine`.
        damage: What was wrong with the files; the same as `woz_tui.log.log_reader.read` says.
        no_end: What it may mean if no message says that the session ended.
        length_us: The last moment of the session, in microseconds since it began; 0 if the log is
            empty.
    """

    def __init__(self, found: LogScan, files: ExitStack, log: LogFiles, block: int) -> None:
        self.actions: list[LogItem] = found.actions
        self.damage: Damage = found.damage
        self.no_end = log.no_end()
        self._files = files
        self._log, self._block = log, block
        self._samples = SampleBlocks(found.blocks)
        self._times = list(map(t_of, self.actions))
        self._straight = not count_falls(self._times)
        self.length_us = max(0, self._samples.last_us, _last(self._times))

    @classmethod
    def open(cls, path: Path, *, places: Iterable[Path] | None = None, block: int = _BLOCK) -> Self:
        """Open the session to which `path` belongs; any of its files will do.

        A log that is still being written is opened as far as it has got. `block`: bytes of samples
        that are read at once when they are needed. Raises what `woz_tui.log.log_reader.files_of`
        raises; nothing damaged raises, now or later.
        """
        with ExitStack() as files:
            log = files_of(path, places)
            found = scan(log, files, block)
            found.damage.lacks(log.missing)
            return cls(found, files.pop_all(), log, block)

    def at(self, t_us: int) -> SampleState:
        """The last reading of each sensor, and the engagement model, at `t_us` (included), however
        long ago they spoke.
        """
        try:
            return self._samples.at(t_us)
        except StaleIndexError:
            self._scan_again()
            return self._samples.at(t_us)

    def between(self, after_us: int, until_us: int) -> Iterator[LogItem]:
        """Every message with `after_us` < t <= `until_us`, in order of `seq`.

        They are read while one goes through them. `after_us` -1 includes the very first.
        """
        actions = self.actions_between(after_us, until_us)
        samples = self.samples_between(after_us, until_us)
        return heapq.merge(actions, samples, key=seq_of) if actions else samples

    def samples_between(self, after_us: int, until_us: int) -> Iterator[LogItem]:
        """Those of `between` that are samples."""
        last = -1
        while True:
            try:
                for items in self._samples.between(after_us, until_us):
                    yield from (item for item in items if item.seq > last)
                    last = items[-1].seq
            except StaleIndexError:
                self._scan_again()
            else:
                return

    def _scan_again(self) -> None:
        """The index of the samples was wrong: everything from the log itself."""
        found = scan(self._log, self._files, self._block, indexed=False)
        found.damage.lacks(self._log.missing)
        self.damage = found.damage
        self._samples = SampleBlocks(found.blocks)

    def actions_between(self, after_us: int, until_us: int) -> list[LogItem]:
        """Those of `actions` with `after_us` < t <= `until_us`."""
        if self._straight:
            first = bisect_right(self._times, after_us)
            return self.actions[first : bisect_right(self._times, until_us, first)]
        return [each for each in self.actions if after_us < each.t <= until_us]

    def close(self) -> None:
        """Close the files; `actions` stay."""
        self._files.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _last(times: list[int]) -> int:
    """The latest of these times, but for wild ones."""
    fits = in_steady_series([(t, t) for t in times])
    return max((t for t, fit in zip(times, fits, strict=True) if fit), default=-1)
