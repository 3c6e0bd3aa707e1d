"""Cuts a file of a log into lines, decodes them and counts the damaged ones."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import msgspec

from woz_tui.log.damage import Damage
from woz_tui.log.log_opening import encoding_of, open_log
from woz_tui.protocol import codec
from woz_tui.protocol.kinds import message_kinds
from woz_tui.protocol.messages import SCHEMA, Message, ParticipantWithdrawn, Segment

#: Bytes that are read at once: small enough to stay in the processor's cache with what they hold,
#: and for Python's collector not to go through them before they are given on.
BLOCK = 1 << 15
#: The first bytes of a file come by themselves: its first lines are looked at one by one.
_BEGINNING = 1 << 12
#: No line of a log is longer; a file of garbage cannot make a reader hoard memory.
LONGEST = 1 << 24

#: Every kind of message that this version knows.
KINDS = frozenset(each.__struct_config__.tag for each in message_kinds())


@dataclass(frozen=True)
class LogLine:
    """One message as it stands in the log. `seq` rises from line to line; gaps can occur.

    Attributes:
        seq: Its number in the session.
        t: Microseconds since the session began.
        ts: Wall clock, RFC 3339; empty for samples.
        kind: Its kind, maybe one that this version does not know.
        fields: The whole object, unknown fields included.
        raw: The line's bytes, without the newline.
        message: The line as a message; None if this version does not know its kind or cannot
            take its fields.
    """

    seq: int
    t: int
    ts: str
    kind: str
    fields: dict[str, Any]
    raw: bytes
    message: Message | None = field(default=None, compare=False, repr=False)

    @property
    def sample(self) -> bool:
        """Whether it is a raw sample of a sensor, or another value that is soon replaced."""
        return self.kind in codec.SAMPLE_KINDS


@dataclass(frozen=True)
class LineChunk:
    """Whole lines of a file, or its last one if no newline follows it (then not `whole`).

    `data` None: one line that is longer than any message.
    """

    path: Path
    offset: int
    data: bytes | None
    whole: bool = True


def lines_in(chunk: LineChunk, damage: Damage) -> list[LogLine]:
    """The messages of a chunk, without the lines that open a segment."""
    if chunk.data is None:
        _note_damaged(chunk, 0, damage)
        return []
    found = []
    offset = 0
    for piece in chunk.data.split(b"\n"):
        text = piece
        if b"\0" in piece:
            damage.nul_bytes += piece.count(b"\0")
            text = piece.replace(b"\0", b"")
        if raw := text.strip(b" \t\r\n"):
            line = decode(raw)
            if line is None:
                _note_damaged(chunk, offset + len(piece) - len(piece.lstrip(b"\0 \t\r")), damage)
            elif line.seq < 0:
                _note_dropped(line, damage)
            else:
                _note_unknown(line, damage)
                found.append(line)
        offset += len(piece) + 1
    return found


def _note_damaged(chunk: LineChunk, offset: int, damage: Damage) -> None:
    if chunk.whole:
        damage.damaged += 1
    else:
        damage.torn += 1
    damage.at(chunk.path, chunk.offset + offset)


def _note_dropped(line: LogLine, damage: Damage) -> None:
    """What the recorder says of lines that it could not keep: so far, of the whole session."""
    if isinstance(head := line.message, Segment):
        damage.dropped = max(damage.dropped, head.dropped)
        damage.dropped_samples = max(damage.dropped_samples, head.dropped_samples)
        span = head.unwritten_since, head.t, head.waived_at
        if head.unwritten_since >= 0 and span not in damage.unwritten:  # a copy says it again
            damage.unwritten.append(span)


def _note_unknown(line: LogLine, damage: Damage) -> None:
    """Note what this version does not know about the line."""
    if line.kind == "session.start":
        schema = line.fields.get("schema", SCHEMA)
        if type(schema) is int and schema > SCHEMA:
            damage.newer = max(damage.newer, schema)
    if isinstance(line.message, ParticipantWithdrawn):
        damage.withdrawn.append((line.seq, line.message.last_removed))
    if line.message is None:
        if line.kind in KINDS:
            damage.misshapen += 1
        else:
            damage.stranger(line.kind)


def decode(raw: bytes) -> LogLine | None:
    """A line, with `seq` -1 if it opens a segment; None if it is no message."""
    message: Message | None = None
    with suppress(codec.WireError):
        message = codec.decode_message(raw)
    try:
        raw.decode()
        fields = codec.decode_unknown(raw)
    except UnicodeDecodeError:
        return None
    except codec.WireError:
        if message is None:
            return None
        fields = msgspec.to_builtins(message)  # an unknown field holds what no program can
    kind, seq, t = fields.get("kind"), fields.get("seq", -1), fields.get("t", -1)
    ts = fields.get("ts", "")
    if not isinstance(kind, str) or not isinstance(ts, str):
        return None
    if type(seq) is not int or type(t) is not int:
        return None
    if kind == "segment":
        seq = -1
    elif seq < 0 or t < 0:
        return None
    return LogLine(seq, t, ts, kind, fields, raw, message)


def chunks_of(
    path: Path, damage: Damage, block: int = BLOCK, until: int | None = None
) -> Iterator[LineChunk]:
    """A file in pieces of whole lines, each about `block` bytes long; no further than `until`, in
    bytes from its beginning.
    """
    try:
        with open_log(path) as file:
            fd = file.fileno()
            if encoding := encoding_of(path):
                until = None  # which counts the bytes of the file itself
                damage.saved_again.append(f"{path.name} was saved again as {encoding}")

            def read(size: int, start: int) -> bytes:
                return os.pread(fd, size if until is None else min(size, until - start), start)

            yield from _chunks_read(path, read, damage, block)
    except OSError as error:
        damage.unreadable.append(f"{path}: {error.strerror}")


#: Reads at most so many bytes of a file from a place on; none at its end.
_Read = Callable[[int, int], bytes]


def _chunks_read(path: Path, read: _Read, damage: Damage, block: int) -> Iterator[LineChunk]:
    start, size = 0, min(block, _BEGINNING)
    while data := read(size, start):
        end = data.rfind(b"\n") + 1
        if end:
            yield LineChunk(path, start, data[:end])
            start, size = start + end, block
        elif not data.strip(b"\0"):  # a hole full of NULs takes no memory
            damage.nul_bytes += len(data)
            start += len(data)
        elif len(data) >= LONGEST:
            end, whole = _end_of_line(read, start + len(data), block)
            yield LineChunk(path, start, None, whole)
            start, size = end, block
        elif not read(1, start + len(data)):
            yield LineChunk(path, start, data, whole=False)
            return
        else:
            size *= 2


def _end_of_line(read: _Read, start: int, block: int) -> tuple[int, bool]:
    """Where the line that goes on at `start` ends, and whether with a newline."""
    while data := read(block, start):
        end = data.find(b"\n") + 1
        if end:
            return start + end, True
        start += len(data)
    return start, False
