"""Reads a session's log back, whatever has happened to its files.

A log is one or more segments, each a file of actions and one of samples. They are merged into one
stream by `seq`, with one line of each file in memory. Nothing damaged raises: it is left out,
counted and reported.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from woz_tui.core import wire
from woz_tui.core.messages import AnyMessage
from woz_tui.record.names import FileName, second_places, unique

_BLOCK = 1 << 18
#: Lines that stand out of order within a file are put right over this distance.
_WINDOW = 256


@dataclass(frozen=True)
class Line:
    """One message as it stands in the log. `seq` rises from line to line; gaps can occur.

    Attributes:
        seq: Its number in the session.
        t: Microseconds since the session began.
        ts: Wall clock, RFC 3339; empty for samples.
        kind: Its kind, maybe one that this version does not know.
        fields: The whole object, unknown fields included.
        raw: The line's bytes, without the newline.
    """

    seq: int
    t: int
    ts: str
    kind: str
    fields: dict[str, Any]
    raw: bytes

    @cached_property
    def message(self) -> AnyMessage | None:
        """The line as a message; None if this version does not know its kind or its fields."""
        try:
            return wire.decode_message(self.raw)
        except wire.WireError:
            return None

    @property
    def sample(self) -> bool:
        """Whether it is a raw sample of a sensor, or another value that is soon replaced."""
        return self.kind in wire.SAMPLE_KINDS


@dataclass
class Damage:
    """What a reader had to leave out or put right. All zero and empty: the log was whole.

    Attributes:
        torn: Last lines of a file that were cut off in the middle.
        damaged: Other lines that are no messages.
        nul_bytes: NUL bytes that were dropped; a power cut leaves them.
        repeated: Lines that stood in two segments; normal after a move to a second folder.
        conflicting: Lines whose number another, different line has already had.
        misplaced: Lines too far out of order to be put right; left out.
        backwards: Lines whose time lies before that of the line before; kept.
        unreadable: Files that could not be read to their end, with the reason.
        places: The first damaged lines, as `file:byte`, at most 20.
    """

    torn: int = 0
    damaged: int = 0
    nul_bytes: int = 0
    repeated: int = 0
    conflicting: int = 0
    misplaced: int = 0
    backwards: int = 0
    unreadable: list[str] = field(default_factory=list)
    places: list[str] = field(default_factory=list)

    @property
    def skipped(self) -> int:
        """How many lines were left out for good."""
        return self.torn + self.damaged + self.conflicting + self.misplaced

    def sentences(self) -> list[str]:
        """Everything that was wrong, in words; empty if nothing was."""
        counts = [
            (self.torn, "torn last line(s) cut"),
            (self.damaged, "damaged line(s) left out"),
            (self.nul_bytes, "NUL byte(s) dropped"),
            (self.conflicting, "line(s) with a number that was taken left out"),
            (self.misplaced, "line(s) far out of order left out"),
            (self.backwards, "line(s) with a time before the last one's"),
        ]
        found = [f"{count} {what}" for count, what in counts if count]
        if self.places:
            found.append("first at " + ", ".join(self.places[:3]))
        return found + self.unreadable

    def _at(self, path: Path, offset: int) -> None:
        if len(self.places) < 20:
            self.places.append(f"{path.name}:{offset}")


@dataclass(frozen=True)
class LogFiles:
    """All files of one session, in the order of their segments."""

    stem: str
    paths: tuple[Path, ...]


def files_of(path: Path, places: Iterable[Path] | None = None) -> LogFiles:
    """Find every file of the session to which `path` belongs.

    They are looked for beside `path`, in `places` (default: the folders into which a recorder
    moves by itself) and where each segment says the one before it lies.

    Raises:
        FileNotFoundError: There is no such file.
        ValueError: It is not called like a log.
    """
    if not path.is_file():
        raise FileNotFoundError(f"{path}: there is no such log")
    name = FileName.parse(path.name)
    if name is None:
        raise ValueError(f"{path}: the name of a log ends in .jsonl")
    folders = unique([path.parent, *(second_places() if places is None else places)])
    found: dict[Path, FileName] = {}
    for folder in folders:  # grows while we walk it
        for each in _of_stem(folder, name.stem):
            parsed = FileName.parse(each.name)
            if parsed is None or each in found:
                continue
            if folder != folders[0] and parsed.number > 1 and not _belongs(each, name.stem):
                continue
            found[each] = parsed
            before = _previous(each)
            if before is not None and before not in folders:
                folders.append(before)
    order = sorted(found, key=lambda each: (found[each].number, found[each].samples, str(each)))
    return LogFiles(name.stem, tuple(order))


def _of_stem(folder: Path, stem: str) -> list[Path]:
    try:
        return sorted(
            path
            for path in folder.iterdir()
            if (name := FileName.parse(path.name)) is not None and name.stem == stem
        )
    except OSError:
        return []


def _first_fields(path: Path) -> dict[str, Any]:
    try:
        with path.open("rb") as file:
            return wire.decode_unknown(file.readline(wire.MAX_LINE))
    except (OSError, wire.WireError):
        return {}


def _belongs(path: Path, stem: str) -> bool:
    return _first_fields(path).get("log") == stem


def _previous(path: Path) -> Path | None:
    """The folder in which the segment before `path` lies, if it says so."""
    previous = _first_fields(path).get("previous")
    if not isinstance(previous, str) or not previous or "\0" in previous:
        return None
    try:
        folder = (path.parent / Path(previous).expanduser()).parent.resolve()
    except (OSError, RuntimeError):
        return None
    return folder if folder.is_dir() else None


def read(
    path: Path, damage: Damage | None = None, *, places: Iterable[Path] | None = None
) -> Iterator[Line]:
    """Every line of the session to which `path` belongs, in order, each once.

    `path` is any file of the session; `damage` is filled in on the way. Memory stays flat however
    long the log is. Raises at once what `files_of` raises; nothing damaged raises.
    """
    return merge(files_of(path, places).paths, Damage() if damage is None else damage)


def merge(paths: Sequence[Path], damage: Damage) -> Iterator[Line]:
    """The lines of these files as one stream by `seq`; see `read`."""
    streams = [_in_order(lines_of(path, damage), damage) for path in paths]
    last: Line | None = None
    t = -1
    for line in heapq.merge(*streams, key=lambda line: line.seq):
        if last is not None and line.seq == last.seq:
            if line.raw == last.raw:
                damage.repeated += 1
            else:
                damage.conflicting += 1
            continue
        if line.t < t:
            damage.backwards += 1
        last, t = line, line.t
        yield line


def _in_order(lines: Iterator[Line], damage: Damage) -> Iterator[Line]:
    """Put right what stands a little out of order; leave out what cannot be."""
    window: list[tuple[int, int, Line]] = []
    given = -1
    for count, line in enumerate(lines):
        if line.seq < given:
            damage.misplaced += 1
            continue
        entry = (line.seq, count, line)
        if len(window) < _WINDOW:
            heapq.heappush(window, entry)
            continue
        given, _, first = heapq.heappushpop(window, entry)
        yield first
    while window:
        yield heapq.heappop(window)[2]


def lines_of(path: Path, damage: Damage) -> Iterator[Line]:
    """The messages in one file as they stand there, without the lines that open a segment."""
    for offset, raw, whole in _raw_lines(path, damage):
        line = _decode(raw)
        if line is not None:
            if line.seq >= 0:
                yield line
        elif whole:
            damage.damaged += 1
            damage._at(path, offset)
        else:
            damage.torn += 1
            damage._at(path, offset)


def _decode(raw: bytes) -> Line | None:
    """A line, with `seq` -1 if it opens a segment; None if it is no message."""
    try:
        fields = wire.decode_unknown(raw)
        raw.decode()
    except (wire.WireError, UnicodeDecodeError):
        return None
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
    return Line(seq, t, ts, kind, fields, raw)


def _raw_lines(path: Path, damage: Damage) -> Iterator[tuple[int, bytes, bool]]:
    """Offset, bytes and whether a newline follows, of every line that is not empty.

    A line longer than any message is cut to its beginning, which is then no message.
    """
    rest, start, offset = b"", 0, 0
    for block in _blocks(path, damage):
        pieces = block.split(b"\n")
        for piece in pieces[:-1]:
            text = rest + piece
            offset += len(piece) + 1
            if clean := _clean(text, damage):
                yield start, clean, True
            rest, start = b"", offset
        rest = (rest + pieces[-1])[: wire.MAX_LINE + 1]
        if not rest.strip(b"\0"):
            damage.nul_bytes += len(rest)
            rest = b""
        offset += len(pieces[-1])
    if clean := _clean(rest, damage):
        yield start, clean, False


def _clean(text: bytes, damage: Damage) -> bytes:
    if b"\0" in text:
        damage.nul_bytes += text.count(b"\0")
        text = text.replace(b"\0", b"")
    return text.strip(b" \t\r\n")


def _blocks(path: Path, damage: Damage) -> Iterator[bytes]:
    try:
        with path.open("rb") as file:
            while block := file.read(_BLOCK):
                yield block
    except OSError as error:
        damage.unreadable.append(f"{path}: {error.strerror}")
