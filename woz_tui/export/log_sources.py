"""Finds the logs to be exported, and reads them."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import msgspec

from woz_tui.analysis.figures import LogIntegrity
from woz_tui.export.event_extraction import EventExtractor
from woz_tui.export.event_model import ExportSession, letters
from woz_tui.export.feature_export import private_fields
from woz_tui.export.redaction import redacted, without_private
from woz_tui.log.coding_file import CodingError, Codings, coding_path, read_codings
from woz_tui.log.log_reader import Damage, LogFiles, LogLine, batches, files_of, merge
from woz_tui.log.sessions import sessions_in
from woz_tui.protocol import codec
from woz_tui.protocol.messages import Reading
from woz_tui.protocol.panels import TYPED_NAME

_encoder = msgspec.json.Encoder()
#: As it stands in a line.
_TYPED = f'"{TYPED_NAME}'.encode()


class ExportError(Exception):
    """The export cannot be done; `remedy` says what to do."""

    def __init__(self, reason: str, remedy: str = "") -> None:
        super().__init__(f"{reason}\n{remedy}" if remedy else reason)
        self.reason = reason
        self.remedy = remedy


@dataclass(frozen=True)
class LogSource:
    """The files of one session's log."""

    files: LogFiles

    @property
    def log(self) -> Path:
        """Its first file."""
        return self.files.paths[0]

    @property
    def folders(self) -> tuple[Path, ...]:
        """Where its files lie; several if the log went on elsewhere."""
        return tuple(dict.fromkeys(path.parent for path in self.files.paths))

    # The files are those that were found: looked for again from the first one, a segment in
    # a folder that it does not name would be missing.

    def lines(self, damage: Damage) -> Iterator[LogLine]:
        """Every line that is no sample, in order."""
        damage.lacks(self.files.missing)
        actions = merge(self.files.actions, damage, gaps=False)
        return (line for line in actions if not line.sample)

    def samples(self, damage: Damage) -> Iterator[Reading]:
        """Every sample of a sensor, in order; memory stays flat."""
        for batch in batches(self.files.paths, damage, gaps=True):
            yield from (item for item in batch if isinstance(item, Reading))

    def everything(self, damage: Damage) -> Iterator[LogLine]:
        """Every line, in order."""
        return merge(self.files.paths, damage)


def shown_line(line: LogLine, *, redact: bool, private: bool = False) -> LogLine:
    """What an export may have of a line: without anybody's words and `ts`, if it is redacted; and
    without what is private, unless that was asked for.
    """
    fields = line.fields if private else without_private(line.fields)
    if redact:
        fields = redacted(fields)
    return line if fields is line.fields else _anew(line, dict(fields), redact=redact)


def _asked_for(line: LogLine) -> LogLine:
    """The line as if nothing were private in it, since somebody asked for that."""
    if line.fields.get("private") is not True or line.kind not in private_fields():
        return line
    fields = {name: value for name, value in line.fields.items() if name != "private"}
    return _anew(line, fields, redact=False)


def has_private(line: LogLine) -> bool:
    """Whether an export loses something of it."""
    return without_private(line.fields) is not line.fields


def _anew(line: LogLine, fields: dict[str, Any], *, redact: bool) -> LogLine:
    raw = _encoder.encode(fields)
    try:
        message = codec.decode_message(raw)
    except codec.WireError:
        message = None
    # Nothing of the old line goes along: whatever it has besides is not redacted.
    ts = "" if redact else line.ts
    return LogLine(line.seq, line.t, ts, line.kind, fields, raw, message)


def find_sources(given: Iterable[Path]) -> tuple[list[LogSource], list[str]]:
    """The sessions that `given` names, each once, and why other files that it names are not read:
    see `woz_tui.log.sessions`.

    Raises `ExportError` if there is none.
    """
    logs, problems = sessions_in([*map(str, given)])
    sources = []
    for log in logs:
        try:
            sources.append(LogSource(files_of(log)))
        except (FileNotFoundError, ValueError) as error:
            problems.append(str(error))
    if not sources:
        reason = "\n".join(problems) or "there is nothing to export"
        raise ExportError(reason, "name a log, *.jsonl, or a folder of them")
    return sources, problems


def read_session(
    source: LogSource, *, redact: bool = False, private: bool = False
) -> ExportSession:
    """Reads a session without its samples. Damage never raises: it is in `damage`."""
    damage = Damage()
    session = ExportSession(name=source.files.stem, folders=source.folders, redacted=redact)
    extractor = EventExtractor(session)
    sums = _Sums()
    for line in source.lines(damage):
        sums.add(line)
        shown = shown_line(line, redact=redact, private=private)
        # Labels come from the message; those of typed sentences are what somebody wrote.
        names_typed = redact and _TYPED in line.raw
        told = _asked_for(shown) if private else shown
        extractor.add((shown if names_typed else line).message, told)
    unread: list[str] = []
    extractor.finish(_codings(source, unread))
    damage_shown = nameless(damage) if redact else damage
    session.damage = [*damage_shown.sentences(), *sums.sentences(), *unread]
    if session.lines and not session.end_reason:
        files = replace(source.files, spill="") if redact else source.files
        session.damage.append(files.no_end())
    if session.lines and session.start is None:
        session.damage.append("the first line is missing: all codes are unknown")
    if redact:  # the log's own name has its date
        codes = [*session.participants[:1], session.code]
        session.name = "_".join(letters(code, "") for code in codes if code) or "session"
    integrity = LogIntegrity(sentences=tuple(session.damage), ended=bool(session.end_reason))
    figures = replace(session.figures, wholeness=integrity)
    session.figures = replace(figures, monotonic_us=None) if redact else figures
    return session


def _codings(source: LogSource, damage: list[str]) -> Codings:
    """The codes that coders set in replays of the log."""
    try:
        codings = read_codings(coding_path(source.log))
    except CodingError:
        damage.append("the file of codes beside the log could not be read")
        return Codings()
    if codings.unread:
        damage.append(f"{codings.unread} line(s) of the file of codes could not be read")
    return codings


def nameless(damage: Damage) -> Damage:
    """The damage without names of files, which hold dates, and without names of unknown kinds."""
    unreadable = ["a file of the log could not be read to its end"] * len(damage.unreadable)
    absent = ["its name is left out"] * len(damage.absent)
    again = ["a file of the log was saved again by another program"] * len(damage.saved_again)
    return replace(
        damage, places=[], kinds=[], unreadable=unreadable, absent=absent, saved_again=again
    )


class _Sums:
    """Compares the checkpoints of a log with its lines: finds changed and lost ones."""

    def __init__(self) -> None:
        self._hash = hashlib.sha256()
        self._sound_to = -1
        self._broken = False

    def add(self, line: LogLine) -> None:
        recorded = line.fields.get("sha256")
        if line.kind in ("checkpoint", "session.end") and recorded and not self._broken:
            if recorded == self._hash.hexdigest():
                self._sound_to = line.seq
            else:
                self._broken = True
        self._hash.update(line.raw + b"\n")

    def sentences(self) -> list[str]:
        if not self._broken:
            return []
        if self._sound_to < 0:
            return ["lines before the first checkpoint were changed or lost"]
        return [f"lines after number {self._sound_to} were changed or lost"]


class UniqueNames:
    """Gives each session a name of its own; a number tells apart those that were the same."""

    def __init__(self) -> None:
        self._given: set[str] = set()

    def unique(self, preferred: str) -> str:
        """`preferred`, or with a number behind it. Upper and lower case are not told apart, as on
        disks.
        """
        name, number = preferred, 1
        while name.casefold() in self._given:
            number += 1
            name = f"{preferred}-{number}"
        self._given.add(name.casefold())
        return name
