"""Reads and writes the index of a file of samples: where the samples of each time are.

`X.samples.index` lies beside `X.samples.jsonl`: a line with the size and the time of the file that
it describes, then of each block of some 64 KiB where it lies, which numbers and times it spans and
where the last sample of each sensor stands. The recorder leaves it when it closes; whoever opens a
long log that has none leaves it, too.

The log is always right. An index counts only if size and time of the file are the same, or else if
the checksums of all its blocks fit; and every block that is read is compared with what the index
says of it.
"""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from contextlib import suppress
from itertools import accumulate, pairwise
from os import fstat, pread
from pathlib import Path
from typing import BinaryIO

import msgspec

from woz_tui.log.line_order import count_falls, is_rising, seq_of, t_of
from woz_tui.log.line_reader import LineChunk
from woz_tui.log.sample_blocks import entries_in
from woz_tui.system.files import open_regular, replace

VERSION = 1
#: Bytes of samples in a block: a second and more of four sensors at 100 Hz.
BLOCK = 1 << 16
#: A file of samples that is shorter is read in no time: it gets no index. Bytes.
SMALLEST = 1 << 23
#: An index is smaller than its log by far; a file of garbage cannot make a reader hoard memory.
_LONGEST, _LONGEST_HEAD = 1 << 28, 1 << 12


class StaleIndexError(Exception):
    """The index says of a block what is not in the log."""


class Hole(msgspec.Struct, frozen=True, array_like=True, gc=False):
    """Numbers that no sample has, as actions have them, and the times of the samples around."""

    first: int
    last: int
    before_us: int
    after_us: int


class IndexEntry(msgspec.Struct, frozen=True, array_like=True, gc=False):
    """What is to be known of a block of whole lines, all of them samples.

    `lasts`: offset in the block and length of the last sample of each sensor; that of the
    engagement model stands under the name that `QuickEngagement` gives it.
    """

    offset: int
    size: int
    crc: int
    first: int
    last: int
    first_us: int
    last_us: int
    holes: list[Hole]
    lasts: dict[str, tuple[int, int]]


class _Head(msgspec.Struct, frozen=True):
    """The index's first line; the second one is the list of its entries, `crc` their checksum."""

    version: int
    size: int
    mtime_ns: int
    crc: int


def is_long(fd: int) -> bool:
    """Whether an open file of samples is long enough to have an index."""
    return fstat(fd).st_size >= SMALLEST


def path_of(samples: Path) -> Path:
    """Where the index of a file of samples lies."""
    return samples.with_suffix(".index")


def entry_of(offset: int, data: bytes) -> IndexEntry | None:
    """The entry for whole lines at `offset`; None if they are anything but samples in order."""
    found = entries_in(LineChunk(Path(), offset, data))
    numbers, times = list(map(seq_of, found)), list(map(t_of, found))
    if not numbers or not is_rising(numbers) or count_falls(times):
        return None
    lines = data.split(b"\n")
    if len(lines) != len(found) + 1 or lines[-1]:
        return None
    places = {sample.sensor: place for place, sample in enumerate(found)}
    starts = list(accumulate((len(line) + 1 for line in lines), initial=0))
    holes = [
        Hole(before + 1, after - 1, times[place], times[place + 1])
        for place, (before, after) in enumerate(pairwise(numbers))
        if after - before > 1
    ]
    lasts = {sensor: (starts[place], len(lines[place])) for sensor, place in places.items()}
    return IndexEntry(
        offset,
        len(data),
        zlib.crc32(data),
        numbers[0],
        numbers[-1],
        times[0],
        times[-1],
        holes,
        lasts,
    )


class IndexBuilder:
    """Collects the entries of one file of samples, from its beginning to its end."""

    def __init__(self) -> None:
        self._entries: list[IndexEntry] = []
        self._end = 0
        self._sound = True

    def add(self, offset: int, data: bytes) -> None:
        """The next whole lines. The line with which a further segment begins may stand alone."""
        entry = entry_of(offset, data)
        if entry is not None and offset == self._end:
            self._entries.append(entry)
        elif offset or data.count(b"\n") != 1:
            self._sound = False
        self._end = offset + len(data)

    def extend(self, fd: int, size: int, *, whole: bool) -> None:
        """Take in what the file has up to `size` bytes; unless `whole`, full blocks alone."""
        least = 1 if whole else BLOCK
        while self._sound and size - self._end >= least:
            try:
                data = pread(fd, min(BLOCK, size - self._end), self._end)
            except OSError:
                data = b""
            if not self._end and b'"kind":"segment"' in data.partition(b"\n")[0]:
                data = data[: data.index(b"\n") + 1]
            end = data.rfind(b"\n") + 1
            if not end:
                self._sound = False
            else:
                self.add(self._end, data[:end])

    def document(self, fd: int) -> bytes:
        """The index as it is written; empty if the file is short or not as it should be."""
        status = fstat(fd)
        if not self._sound or status.st_size != self._end or not is_long(fd):
            return b""
        entries = msgspec.json.encode(self._entries)
        head = _Head(VERSION, status.st_size, status.st_mtime_ns, zlib.crc32(entries))
        return msgspec.json.encode(head) + b"\n" + entries

    def leave(self, samples: Path, fd: int) -> None:
        """Put the index beside its file, if that is possible there."""
        with suppress(OSError):
            if document := self.document(fd):
                replace(path_of(samples), document.decode(), mode=0o600)


def read_index(samples: Path, source: BinaryIO) -> list[IndexEntry] | None:
    """The entries for a file of samples that is open as `source`; None if no index fits it."""
    try:
        with open_regular(path_of(samples)) as file:
            head = msgspec.json.decode(file.readline(_LONGEST_HEAD), type=_Head)
            lines = file.read(_LONGEST)
        if head.version != VERSION or head.crc != zlib.crc32(lines):
            return None
        entries = msgspec.json.decode(lines, type=list[IndexEntry])
        return entries if _fits(head, entries, source) else None
    except (OSError, msgspec.MsgspecError):
        return None


def _fits(head: _Head, entries: Sequence[IndexEntry], source: BinaryIO) -> bool:
    """Whether the blocks lie one behind the other to the end of the file, which is the same."""
    status = fstat(source.fileno())
    if not entries or head.size != status.st_size or entries[0].offset < 0:
        return False
    ends = [entry.offset + entry.size for entry in entries]
    if ends != [*(entry.offset for entry in entries[1:]), head.size]:
        return False
    if min(entry.size for entry in entries) <= 0:
        return False
    return head.mtime_ns == status.st_mtime_ns or all(
        zlib.crc32(pread(source.fileno(), entry.size, entry.offset)) == entry.crc
        for entry in entries
    )
