"""Finds the files that belong to one session, and their order."""

from __future__ import annotations

import os
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from woz_tui.log.file_names import FileName, fallback_folders, unique_paths, why_no_log
from woz_tui.log.log_opening import open_log
from woz_tui.log.old_logs import refuse_old
from woz_tui.protocol import codec

#: The last line of a file is looked for in so many bytes.
_TAIL = 1 << 14
#: How often files that grow are looked at until they have stood still for one look.
_LOOKS = 100
#: So many folders are believed of one line.
_PLACES = 16
#: What stands in a log that was cut off, or whose session still runs.
NO_END = "the session has no end: it is still running, or it was interrupted"


@dataclass(frozen=True)
class LogFiles:
    """All files of one session, in the order of their segments.

    Attributes:
        stem: What their names begin with.
        paths: Those that were found.
        missing: Files of actions that those name as the one before or after them, found nowhere.
        spill: The folder in which the log goes on if its own fails, as its first line has it.
    """

    stem: str
    paths: tuple[Path, ...]
    missing: tuple[Path, ...] = ()
    spill: str = ""

    @property
    def actions(self) -> tuple[Path, ...]:
        """Those that hold actions."""
        return tuple(path for path in self.paths if not holds_samples(path))

    @property
    def samples(self) -> tuple[Path, ...]:
        """Those that hold samples."""
        return tuple(path for path in self.paths if holds_samples(path))

    def no_end(self) -> str:
        """What it may mean that no end of the session is in these files."""
        if not self.spill or self.missing or len(self.actions) > 1:
            return NO_END
        return f"{NO_END}, or it went on in {self.spill}, but no file was found there"


def holds_samples(path: Path) -> bool:
    """Whether a log file of this name is for samples."""
    name = FileName.parse(path.name)
    return name is not None and name.samples


def sizes_of(paths: Iterable[Path]) -> dict[Path, int]:
    """How many bytes each of a session's files has at one moment; a file that cannot be asked is
    left out.

    Lines are written to the files in order of `seq`: of a session that still runs, these bytes have
    every line up to the last of them.
    """
    paths = list(paths)
    found = _sizes(paths)
    for _ in range(_LOOKS):
        before, found = found, _sizes(paths)
        if found == before:  # so nothing was written between the first look and the second
            break
    return found


def _sizes(paths: Iterable[Path]) -> dict[Path, int]:
    found = {}
    for path in paths:
        with suppress(OSError):
            found[path] = path.stat().st_size
    return found


def files_of(path: Path, places: Iterable[Path] | None = None, *, samples: bool = True) -> LogFiles:
    """Find every file of the session to which `path` belongs.

    They are looked for beside `path`, in `places` (default: the folders into which a recorder
    moves by itself), and where the files themselves say that the log was before, went on, or would
    go on. Without `samples` no file of samples is opened or named.

    Raises:
        FileNotFoundError: There is no such file.
        ValueError: It is not called like a log.
        OldLogError: It is of a schema that this version reads no more.
    """
    if not path.is_file():
        raise FileNotFoundError(f"{path}: there is no such log")
    name = FileName.parse(path.name)
    if name is None:
        raise ValueError(f"{path}: {why_no_log(path.name)}")
    folders = unique_paths([path.parent, *(fallback_folders() if places is None else places)])
    real = set(map(os.path.realpath, folders))
    found: dict[Path, FileName] = {}
    known: set[tuple[str, int | None]] = set()
    links = _Links(name.stem)
    for folder in folders:  # grows while we walk it
        for each, parsed in _of_stem(folder, name.stem):
            if parsed.samples and not samples:
                continue
            try:
                first = first_line(each)
            except OSError:
                first = {}
            refuse_old(each, first)
            if folder != folders[0] and parsed.number > 1 and first.get("log") != name.stem:
                continue
            if (same := (each.name, _sizes([each]).get(each))) in known:
                continue  # copied from where it was; the one that lies nearer is read
            known.add(same)
            found[each] = parsed
            for further in links.of(each, first):
                if os.path.realpath(further) not in real:
                    real.add(os.path.realpath(further))
                    folders.append(further)
    order = sorted(found, key=lambda each: (found[each].number, found[each].samples, str(each)))
    return LogFiles(name.stem, tuple(order), links.missing(order), links.spill)


@dataclass
class _Links:
    """What the files of a log say of each other, in their first lines and in their last ones."""

    stem: str
    spill: str = ""
    #: By name: files that others name, and those of which a copy is there.
    _named: dict[str, Path] = field(default_factory=dict)
    _copied: set[str] = field(default_factory=set)

    def of(self, path: Path, first: dict[str, Any]) -> list[Path]:
        """Take in a file whose first line is `first`; the folders that it names."""
        before = _elsewhere(path, first.get("previous"))
        after = _elsewhere(path, _last_line(path).get("next_file"))
        if before is not None and first.get("copied") is True:
            self._copied.add(before.name)
        others = [other for other in (before, after) if other is not None]
        self._named.update({other.name: other for other in others})
        spill = first.get("spill")
        names = spill[:_PLACES] if isinstance(spill, list) else []
        if names and isinstance(names[0], str):
            self.spill = names[0]
        folders = (_elsewhere(path, name) for name in names)
        return [
            *(other.parent for other in others),
            *(folder for folder in folders if folder is not None),
        ]

    def missing(self, found: Iterable[Path]) -> tuple[Path, ...]:
        """Files of actions that are named but not among those found, wherever those lie."""
        there = {path.name for path in found} | self._copied
        named = ((FileName.parse(name), path) for name, path in self._named.items())
        return tuple(
            path
            for name, path in named
            if path.name not in there and name and name.stem == self.stem and not name.samples
        )


def _of_stem(folder: Path, stem: str) -> list[tuple[Path, FileName]]:
    try:
        # Names alone: a folder has the files of all sessions, and is looked through for each.
        names = sorted(name for name in os.listdir(folder) if name.startswith(stem))  # noqa: PTH208
    except OSError:
        return []
    named = ((folder / name, FileName.parse(name)) for name in names)
    return [(path, name) for path, name in named if name is not None and name.stem == stem]


def first_line(path: Path) -> dict[str, Any]:
    """The first line of a file; empty if that is no message. Raises `OSError`."""
    with open_log(path) as file:
        try:
            return codec.decode_unknown(file.readline(codec.MAX_LINE))
        except codec.WireError:
            return {}


def _last_line(path: Path) -> dict[str, Any]:
    """The last line of a file; empty if that is no message or cannot be read."""
    try:
        with open_log(path) as file:
            file.seek(max(0, file.seek(0, os.SEEK_END) - _TAIL))
            line = file.read(_TAIL).rstrip(b"\0 \t\r\n").rpartition(b"\n")[2]
        return codec.decode_unknown(line)
    except (OSError, codec.WireError):
        return {}


def _elsewhere(path: Path, said: object) -> Path | None:
    """The file or folder that the log file `path` names, if it does."""
    if not isinstance(said, str) or not said or "\0" in said:
        return None
    try:
        return Path(os.path.abspath(path.parent / Path(said).expanduser()))  # noqa: PTH100
    except RuntimeError:
        return None
