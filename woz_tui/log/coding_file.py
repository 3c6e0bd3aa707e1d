"""What coders set while they watch a replay: `<log>.coding.jsonl`, beside the log, which it never
touches. A line is written at once, so that a coding goes on where it was left.

The first line says which session it is. Each further line is a code of one coder, or takes one of
them back; lines are never changed.
"""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path

import msgspec

from woz_tui.log.file_names import CODINGS, FileName, check_code
from woz_tui.protocol.messages import SessionStart
from woz_tui.system.files import open_regular

FORMAT, SCHEMA = "woz-coding", 1
#: The tier of codes that name none.
MARKERS = "markers"
#: A coder types no more in a line.
_LONGEST = 100_000


class CodingError(Exception):
    """The file cannot be used; the text says which and why."""


class CodingHeader(msgspec.Struct, frozen=True, tag_field="kind", tag="coding"):
    """Which session is coded: the code, and the clock on the wall at its beginning."""

    session: str
    started: str
    format: str = FORMAT
    schema: int = SCHEMA


class Code(msgspec.Struct, frozen=True, tag_field="kind", tag="code"):
    """A code or a note at `t`, in microseconds of the log. `number` counts the coder's lines from
    0; `at` is when it was set.

    A text `gaze: robot` is the code *robot* on the tier *gaze*: it holds until the next one of
    that tier, or to the end of the trial; `gaze:` ends it. Any other text is a moment on the tier
    *markers*.
    """

    coder: str
    number: int
    t: int
    text: str
    at: str
    note: bool = False

    @property
    def tier(self) -> str:
        """Where it stands; notes have none."""
        name, colon, _ = self.text.partition(":")
        return name.strip() if colon and name.strip() else MARKERS

    @property
    def lasts(self) -> bool:
        """Whether it holds until the next one of its tier."""
        return self.tier != MARKERS or self.text.partition(":")[0].strip() == MARKERS

    @property
    def code(self) -> str:
        """What it says; empty: the tier has none from here on."""
        return self.text.partition(":")[2].strip() if self.lasts else self.text


class CodeRemoval(msgspec.Struct, frozen=True, tag_field="kind", tag="taken back"):
    """The coder takes the code `number` back."""

    coder: str
    number: int
    at: str


_decoder = msgspec.json.Decoder(CodingHeader | Code | CodeRemoval)
_encoder = msgspec.json.Encoder()


@dataclass
class Codings:
    """All of a file: codes by coder, `used` the numbers that were given, `unread` counts lines that
    make no sense.
    """

    by_coder: dict[str, list[Code]] = field(default_factory=dict)
    used: dict[str, int] = field(default_factory=dict)
    head: CodingHeader | None = None
    unread: int = 0

    def of(self, coder: str) -> list[Code]:
        """One coder's, by time."""
        return sorted(self.by_coder.get(coder, ()), key=lambda code: (code.t, code.number))


def coding_path(log: Path) -> Path:
    """The file beside a log; `log` is any file of the session."""
    name = FileName.parse(log.name)
    return log.with_name(f"{name.stem if name else log.stem}{CODINGS}")


def read_codings(path: Path) -> Codings:
    """What stands in the file; nothing if there is none.

    Raises:
        CodingError: It cannot be read, or is something else.
    """
    found = Codings()
    try:
        with open_regular(path) as file:
            lines = file.readlines()
    except FileNotFoundError:
        return found
    except OSError as error:
        raise CodingError(f"{path}: {error.strerror or error}") from error
    for line in lines:
        try:
            read = _decoder.decode(line)
        except (msgspec.DecodeError, UnicodeDecodeError):
            found.unread += bool(line.strip())
            continue
        match read:
            case CodingHeader():
                found.head = found.head or read
            case Code(coder=coder):
                found.by_coder.setdefault(coder, []).append(read)
                found.used[coder] = max(read.number, found.used.get(coder, -1))
            case CodeRemoval(coder=coder, number=number):
                mine = found.by_coder.get(coder, [])
                mine[:] = [code for code in mine if code.number != number]
    if found.head is None and lines:
        raise CodingError(f"{path}: this is no file of codes (its first line does not say so)")
    return found


class Coding:
    """One coder's codes of one session; they go on from those that are in the file.

    Raises:
        ValueError: `coder` is no code.
        CodingError: The file is of another session, or cannot be written.
    """

    def __init__(self, path: Path, coder: str, start: SessionStart | None) -> None:
        self.coder = check_code("coder", coder)
        self.path = path
        found = read_codings(path)
        head = head_of(start)
        if found.head is not None and found.head != head:
            raise CodingError(
                f"{path}: these are codes of another session ({found.head.session}); put it away"
            )
        self.codes = found.of(coder)
        self._next = 1 + found.used.get(coder, -1)
        try:
            self._file = _opened(path)
            if found.head is None:
                self._write(head)
        except OSError as error:
            raise CodingError(f"{path}: {error.strerror or error}") from error

    def add(self, t: int, text: str, *, note: bool = False) -> Code:
        """A code, or a note, at `t`. Raises `OSError` if it cannot be written."""
        text = " ".join(text.split())[:_LONGEST]
        code = Code(self.coder, self._next, t, text, _now(), note)
        self._write(code)
        self._next += 1
        self.codes = sorted([*self.codes, code], key=lambda each: (each.t, each.number))
        return code

    def take_back(self) -> Code | None:
        """Take the code back that was set last; None if there is none."""
        last = max(self.codes, key=lambda code: code.number, default=None)
        if last is not None:
            self._write(CodeRemoval(self.coder, last.number, _now()))
            self.codes = [code for code in self.codes if code is not last]
        return last

    def between(self, after: int, until: int) -> Iterator[Code]:
        """Those with `after` < t <= `until`."""
        return (code for code in self.codes if after < code.t <= until)

    def close(self) -> None:
        os.close(self._file)

    def _write(self, line: msgspec.Struct) -> None:
        data = _encoder.encode(line) + b"\n"
        taken = os.write(self._file, data)
        if taken != len(data):  # a full disk takes a part of it, behind which no line may stand
            end = os.lseek(self._file, 0, os.SEEK_CUR)
            if end == os.fstat(self._file).st_size:  # no other coder has written meanwhile
                os.ftruncate(self._file, end - taken)
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        os.fdatasync(self._file)


def head_of(start: SessionStart | None) -> CodingHeader:
    """What tells sessions apart, of one whose first line is `start`."""
    if start is None:
        return CodingHeader("", "")
    return CodingHeader(start.session, str(start.clock.get("wall_at_t0", "")) or start.ts)


def tiers_of(codes: Iterable[Code]) -> list[str]:
    """The tiers in the order in which they came."""
    return list(dict.fromkeys(code.tier for code in codes if not code.note))


def _opened(path: Path) -> int:
    """To write at the end, for its owner only; a line that was torn is ended."""
    flags = os.O_RDWR | os.O_APPEND | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW
    file = os.open(path, flags, 0o600)
    about = os.fstat(file)
    if not stat.S_ISREG(about.st_mode):
        os.close(file)
        raise OSError(errno.EINVAL, "it is no file")
    os.fchmod(file, 0o600)
    if about.st_size and os.pread(file, 1, about.st_size - 1) != b"\n":
        os.write(file, b"\n")
    return file


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="milliseconds")
