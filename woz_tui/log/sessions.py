"""Which sessions somebody means by the files, folders and patterns they name.

Every command that takes logs asks here, so that a session counts once in all of them, however many
copies of it lie about.
"""

from __future__ import annotations

import glob
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from woz_tui.log.file_names import CODINGS, FileName, session_code, why_no_log
from woz_tui.log.log_files import files_of, first_line
from woz_tui.log.log_opening import encoding_of, open_log
from woz_tui.log.old_logs import OldLogError, why_too_old
from woz_tui.protocol import codec

#: Bytes at the beginning of a log in which a redacted copy is compared with it.
_COMPARED = 1 << 16


def sessions_in(named: Sequence[str]) -> tuple[list[Path], list[str]]:
    """One file for each session, in the order of their names; and a sentence for whatever was
    named but leads to none, or to one that is read from another file already.

    A folder stands for all sessions in it and below; files in it that are no logs are passed over.
    Segments and samples belong to their session and are not named twice. Of several copies the
    longest one is read, and of a log and its redacted copy the log.
    """
    paths, problems = all_logs_in(named)
    logs = [_Log.of(path) for path in paths]
    problems += [f"{log.path}: {why}" for log in logs if (why := why_too_old(log.first))]
    sessions = _each_once([log for log in logs if not why_too_old(log.first)], problems)
    return sorted(sessions, key=lambda path: (path.name, str(path))), problems


def all_logs_in(named: Sequence[str]) -> tuple[list[Path], list[str]]:
    """As `sessions_in`, but with all copies and logs too old to be read: each log's first file."""
    found: dict[tuple[Path, str], Path] = {}
    sample_files: dict[tuple[Path, str], Path] = {}
    problems: list[str] = []
    no_logs: list[Path] = []
    for name in named:
        try:
            paths = list(_paths(name, problems))
        except OSError as error:
            problems.append(f"{name}: {error.strerror or error}")
            continue
        if not paths:
            folder = Path(name).is_dir()
            thing = "log in this folder" if folder else "such file, folder, or log of this pattern"
            problems.append(f"{name}: there is no {thing}")
        for path in paths:
            parsed = FileName.parse(path.name)
            if parsed is None:
                no_logs.append(path)
                continue
            key = (path.parent.resolve(), parsed.stem)
            if parsed.samples and path.is_file():
                sample_files.setdefault(key, path)
            elif key not in found or _number(path) < _number(found[key]):
                found[key] = path
    for key, path in sample_files.items():
        if key not in found:
            try:
                actions = files_of(path).actions
            except OldLogError as error:
                problems.append(f"{path}: {error.strerror}")
                continue
            if actions:
                found[actions[0].parent.resolve(), key[1]] = actions[0]
            else:
                problems.append(f"{path}: these are samples without the log they belong to")
    # Of a pattern, what coders set lies beside its log.
    odd = [path for path in no_logs if not (found and path.name.endswith(CODINGS))]
    problems += [f"{path}: {why_no_log(path.name)}" for path in odd]
    # Later segments in another folder belong to a session that is named already.
    begun = {stem for (_, stem), path in found.items() if _number(path) == 1}
    logs = [path for (_, stem), path in found.items() if _number(path) == 1 or stem not in begun]
    return logs, problems


def _paths(name: str, problems: list[str]) -> Iterator[Path]:
    def passed(error: OSError) -> None:
        problems.append(f"{error.filename}: {error.strerror}: sessions in it are left out")

    path = Path(name)
    if path.is_dir():
        next(path.iterdir(), None)  # a folder that cannot be read is no empty one
        below = [
            Path(folder) / each
            for folder, _, files in os.walk(path, onerror=passed)
            for each in files
            if each.endswith(".jsonl")
        ]
        yield from filter(_is_log, sorted(below))
    elif path.exists():
        yield path
    else:
        for each in sorted(glob.glob(name, recursive=True)):  # noqa: PTH207 - absolute ones too
            yield from _paths(each, problems) if Path(each).is_dir() else iter([Path(each)])


def _is_log(path: Path) -> bool:
    """Whether a file of a folder is one of a log, also a damaged, empty or unreadable one."""
    parsed = FileName.parse(path.name)
    if parsed is None or not path.is_file():
        return False
    if session_code(parsed.stem):
        return True
    try:
        first = first_line(path)
    except OSError:
        return True  # whoever reads it says why it cannot be read
    kind = first.get("kind")
    return kind in (codec.SAMPLE_KINDS if parsed.samples else ("session.start", "segment"))


def _number(path: Path) -> int:
    name = FileName.parse(path.name)
    return 0 if name is None else name.number


# -- copies ---------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Log:
    """A log that may be a copy of another one."""

    path: Path
    first: dict[str, Any]

    @classmethod
    def of(cls, path: Path) -> _Log:
        """The log that begins with the file `path`."""
        try:
            return cls(path, first_line(path))
        except OSError:
            return cls(path, {})

    @property
    def redacted(self) -> bool:
        """Whether its texts and dates were taken out."""
        return self.first.get("redacted") is True

    @property
    def session(self) -> tuple[Any, ...]:
        """What all copies of a session have in common; empty if its first line is lost."""
        if self.first.get("kind") != "session.start":
            return ()
        names = ("session", "participant", "wizard", "experiment_sha256")
        return tuple(str(self.first.get(name)) for name in names)

    @property
    def began(self) -> str:
        """When its session began, RFC 3339; empty if that was taken out."""
        clock = self.first.get("clock")
        wall = clock.get("wall_at_t0") if isinstance(clock, dict) else None
        return str(self.first.get("ts") or wall or "")

    @property
    def parent(self) -> str:
        """The log of which this is a later segment under another name; empty if it is none."""
        parsed, log = FileName.parse(self.path.name), self.first.get("log")
        if self.first.get("kind") != "segment" or parsed is None or log == parsed.stem:
            return ""
        return str(log)

    def same_as(self, other: _Log) -> bool:
        """Whether both are logs of one session."""
        if self.session != other.session:
            return False
        if not (self.redacted or other.redacted):
            return bool(self.began) and self.began == other.began
        mine, others = self._stamps(), other._stamps()
        shorter = min(len(mine), len(others))
        return bool(shorter) and mine[:shorter] == others[:shorter]

    def _stamps(self) -> list[tuple[Any, ...]]:
        """Number, time and kind of its first lines, which a redacted copy keeps."""
        with open_log(self.path) as file:
            lines = file.read(_COMPARED).split(b"\n")[:-1]
        found = []
        for line in lines:
            try:
                fields = codec.decode_unknown(line)
            except codec.WireError:
                continue
            found.append((fields.get("seq"), fields.get("t"), fields.get("kind")))
        return found

    def length(self) -> tuple[int, bool]:
        """Lines of its actions, in whatever encoding; of two copies with as many, the one that is
        as it was recorded is worth more.
        """
        lines, recorded = 0, True
        try:
            for path in files_of(self.path, samples=False).actions:
                recorded = recorded and not encoding_of(path)
                with open_log(path) as file:
                    lines += sum(1 for _ in file)
        except OSError:
            return 0, False
        return lines, recorded


def _each_once(logs: list[_Log], problems: list[str]) -> Iterator[Path]:
    """The file of each session that is to be read; why the others are not goes to `problems`."""
    sessions: dict[tuple[Any, ...], list[list[_Log]]] = {}
    stems = {log.path.stem: log.path for log in logs if not log.parent}
    for log in sorted(logs, key=lambda log: (log.redacted, log.path.name, str(log.path))):
        if log.parent in stems:
            problems.append(f"{log.path}: is a copy of a part of {stems[log.parent]}")
        elif not log.session:
            yield log.path
        else:
            known = sessions.setdefault(log.session, [])
            copies = next((each for each in known if log.same_as(each[0])), None)
            if copies is None:
                known.append([log])
            else:
                copies.append(log)
    for copies in (each for known in sessions.values() for each in known):
        lengths = {log.path: log.length() for log in copies} if len(copies) > 1 else {}
        # A copy has the longer name: "... (1)", "... - Copy", "Copy of ...".
        read = max(
            copies,
            key=lambda log: (
                not log.redacted,
                lengths.get(log.path, (0, False)),
                -len(log.path.name),
            ),
        )
        yield read.path
        for log in copies:
            if log is not read:
                what = "a redacted copy of" if log.redacted else "the same session as"
                shorter = not log.redacted and lengths[log.path][0] < lengths[read.path][0]
                why = "is longer and counted already" if shorter else "is counted already"
                problems.append(f"{log.path}: is {what} {read.path}, which {why}")
