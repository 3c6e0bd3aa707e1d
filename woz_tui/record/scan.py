"""Goes through a session's files once, so that `woz_tui.record.index` knows what is where."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass, field
from typing import BinaryIO

import msgspec

from woz_tui.core import wire
from woz_tui.core.messages import EngagementShown, Reading
from woz_tui.record.blocks import Block, Lasts, Slim
from woz_tui.record.damage import Damage
from woz_tui.record.files import LogFiles
from woz_tui.record.lines import KINDS, Chunk, Line, chunks_of
from woz_tui.record.order import Course, merged, rising, seq_of, t_of
from woz_tui.record.stream import Item, batches, items_in

Entry = Item | Slim

_decoder: msgspec.json.Decoder[Slim | EngagementShown] = msgspec.json.Decoder(
    Slim | EngagementShown
)


@dataclass
class Scan:
    """What was found: the actions themselves, the samples by block."""

    actions: list[Item] = field(default_factory=list)
    blocks: list[Block] = field(default_factory=list)
    damage: Damage = field(default_factory=Damage)


class _OutOfOrderError(Exception):
    """The files do not hold the samples in order, each once."""


def scan(files: LogFiles, opened: ExitStack) -> Scan:
    """Go through all files; those that blocks point to are opened and put into `opened`."""
    try:
        return _in_place(files, opened)
    except _OutOfOrderError:
        return _copied(files, opened)


def is_sample(item: Entry) -> bool:
    """Whether something belongs to the samples: what is one, or is unknown and came without `ts`,
    as samples do.
    """
    if isinstance(item, Line):
        return item.sample or (item.kind not in KINDS and not item.ts)
    return isinstance(item, Slim | Reading | EngagementShown)


# -- files as they should be ----------------------------------------------------------------------


def _in_place(files: LogFiles, opened: ExitStack) -> Scan:
    """Blocks are pieces of the files of samples themselves."""
    found = Scan()
    damage = found.damage
    for batch in batches(files.actions, damage, gaps=False):
        if any(map(is_sample, batch)):
            raise _OutOfOrderError
        found.actions += batch
    damage.backwards = 0  # counted below, among the samples
    lost = damage.repeated + damage.conflicting
    course = Course[Entry](damage, lambda *_: False, gaps=True)
    actions = list[Entry](found.actions)
    streams: list[Iterator[list[Entry]]] = [iter([actions]), _pieces(files, found, opened)]
    for part in merged(streams):
        course.take(part)
    course.end()
    if damage.repeated + damage.conflicting > lost:
        raise _OutOfOrderError
    return found


def _pieces(files: LogFiles, found: Scan, opened: ExitStack) -> Iterator[list[Entry]]:
    """What is in the files of samples, piece by piece, while it rises."""
    last = -1
    for path in files.samples:
        try:
            source = opened.enter_context(path.open("rb", buffering=0))
        except OSError:
            source = None  # chunks_of says so
        for chunk in chunks_of(path, found.damage):
            items = _sound(chunk) or _looked_at(chunk, found.damage)
            if not items or source is None:
                continue
            numbers = list(map(seq_of, items))
            if numbers[0] <= last or not rising(numbers):
                raise _OutOfOrderError
            last = numbers[-1]
            found.blocks.append(_block(source, chunk, items))
            yield items


def _sound(chunk: Chunk) -> list[Entry]:
    """The samples of a chunk that holds nothing else; none if it does."""
    if chunk.data is None or not chunk.whole:
        return []
    try:
        found = wire.decode_lines(_decoder, chunk.data)
    except wire.WireError:
        return []
    sound = min(map(seq_of, found)) >= 0 and min(map(t_of, found)) >= 0
    return list[Entry](found) if sound else []


def _looked_at(chunk: Chunk, damage: Damage) -> list[Entry]:
    """What is left of the samples of any other chunk."""
    found = list[Entry](items_in(chunk, damage))
    if not all(map(is_sample, found)):
        raise _OutOfOrderError
    return found


def _block(source: BinaryIO, chunk: Chunk, items: list[Entry]) -> Block:
    size = len(chunk.data or b"")
    times = list(map(t_of, items))
    shown = [item for item in items if isinstance(item, EngagementShown)]
    sensors = {item.sensor: item for item in items if isinstance(item, Slim | Reading)}
    lasts = Lasts(sensors, shown[-1] if shown else None)
    return Block(source, chunk.path, chunk.offset, size, min(times), max(times), lasts)


# -- files as they should not be ------------------------------------------------------------------


def _copied(files: LogFiles, opened: ExitStack) -> Scan:
    """Blocks are pieces of a temporary file into which all samples go, each once and in order."""
    found = Scan()
    copy = opened.enter_context(tempfile.TemporaryFile(buffering=0))  # noqa: SIM115
    path = files.paths[0]
    offset = 0
    for batch in batches(files.paths, found.damage, gaps=True):
        found.actions += [item for item in batch if not is_sample(item)]
        samples = list[Entry](filter(is_sample, batch))
        data = b"".join(map(_line, samples))
        if data:
            copy.write(data)
            chunk = Chunk(path, offset, data)
            found.blocks.append(_block(copy, chunk, samples))
            offset += len(data)
    return found


def _line(item: Entry) -> bytes:
    if isinstance(item, Line):
        return item.raw + b"\n"
    return wire.encode(item)
