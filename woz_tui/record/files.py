"""Which files belong to one session, and in what order."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from woz_tui.core import wire
from woz_tui.record.names import FileName, second_places, unique


@dataclass(frozen=True)
class LogFiles:
    """All files of one session, in the order of their segments."""

    stem: str
    paths: tuple[Path, ...]

    @property
    def actions(self) -> tuple[Path, ...]:
        """Those that hold actions."""
        return tuple(path for path in self.paths if not holds_samples(path))

    @property
    def samples(self) -> tuple[Path, ...]:
        """Those that hold samples."""
        return tuple(path for path in self.paths if holds_samples(path))


def holds_samples(path: Path) -> bool:
    """Whether a log file of this name is for samples."""
    name = FileName.parse(path.name)
    return name is not None and name.samples


def files_of(path: Path, places: Iterable[Path] | None = None, *, samples: bool = True) -> LogFiles:
    """Find every file of the session to which `path` belongs.

    They are looked for beside `path`, in `places` (default: the folders into which a recorder
    moves by itself) and where each segment says the one before it lies. Without `samples` no file
    of samples is opened or named.

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
        for each, parsed in _of_stem(folder, name.stem):
            if each in found or (parsed.samples and not samples):
                continue
            if folder != folders[0] and parsed.number > 1 and not _belongs(each, name.stem):
                continue
            found[each] = parsed
            before = _previous(each)
            if before is not None and before not in folders:
                folders.append(before)
    order = sorted(found, key=lambda each: (found[each].number, found[each].samples, str(each)))
    return LogFiles(name.stem, tuple(order))


def _of_stem(folder: Path, stem: str) -> list[tuple[Path, FileName]]:
    try:
        paths = sorted(path for path in folder.iterdir() if path.name.startswith(stem))
    except OSError:
        return []
    named = ((path, FileName.parse(path.name)) for path in paths)
    return [(path, name) for path, name in named if name is not None and name.stem == stem]


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
