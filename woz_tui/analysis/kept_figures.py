"""Figures of logs that were read before, so that only what is new or changed is read again.

They lie in `figures_folder()`, one file for each log and way of counting, readable for their owner
only. A log is believed, never what was kept of it: all bytes of its files are summed up each time,
and so is the program that counts. What is damaged, from another version, or of a log that is not
there any more is removed without a word.
"""

from __future__ import annotations

import hashlib
import io
import pickle
import sys
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, is_dataclass
from enum import Enum
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

import msgspec

from woz_tui import __version__
from woz_tui.analysis.durations import Durations
from woz_tui.analysis.feature_figures import FeatureFigures
from woz_tui.analysis.figure_counting import DEFAULTS, FigureOptions
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.session_reading import SessionReport, read_report
from woz_tui.feature import left_out, pieces
from woz_tui.log.log_files import LogFiles, files_of
from woz_tui.system.files import open_regular, replace
from woz_tui.system.user_folders import cache_folder

T = TypeVar("T")
_SUFFIX = ".figures"
#: Bytes of a log that are summed up at once.
_PIECE = 1 << 20
#: Beside the program's own classes, what figures are made of.
_PLAIN = frozenset(
    {
        *(("collections", name) for name in ("Counter", "defaultdict", "OrderedDict")),
        ("array", "_array_reconstructor"),
        ("array", "array"),
    }
)


def figures_folder() -> Path:
    """Where they lie. Raises `RuntimeError` if there is no home."""
    return cache_folder() / "woz-tui" / "figures"


class _Kept(msgspec.Struct):
    """A file: of which log it is, the sum of what was read, the figures and their own sum."""

    log: str
    read: str
    figures: bytes
    sum: str


@dataclass(frozen=True, slots=True)
class KeptPlace:
    """Where something is kept that was made of a log, and the sum of all that it was made of."""

    file: Path
    log: str
    read: str

    def load(self, kind: type[T]) -> T | None:
        """What is kept; None: nothing is, or it is not of what was summed up."""
        try:
            with open_regular(self.file) as file:
                found = msgspec.json.decode(file.read(), type=_Kept)
            if found.read != self.read or hashlib.sha256(found.figures).hexdigest() != found.sum:
                return None
            figures = _FiguresUnpickler(io.BytesIO(found.figures)).load()
        except Exception:  # noqa: BLE001 - whatever is wrong with it, the log is read
            return None
        return figures if isinstance(figures, kind) else None

    def keep(self, value: object) -> None:
        """Write the file; what cannot be written is made again the next time."""
        if left_out():  # it lacks what a feature counts
            return
        with suppress(OSError, pickle.PicklingError, AttributeError, TypeError):
            data = pickle.dumps(value, pickle.HIGHEST_PROTOCOL)
            found = _Kept(self.log, self.read, data, hashlib.sha256(data).hexdigest())
            self.file.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
            replace(self.file, msgspec.json.encode(found).decode(), mode=0o600, durable=False)


def kept_place(
    path: Path, options: FigureOptions, *, samples: bool = False, what: str = ""
) -> KeptPlace | None:
    """Where that is kept which was made of a log (with its `samples`) in one way; None: nowhere.
    `what` tells it from other things that are made of it.

    Raises:
        FileNotFoundError: There is no such log.
        ValueError: It is not called like one.
    """
    files = files_of(path, samples=samples)
    log = str(path.absolute())
    way = hashlib.sha256(repr((log, options, what)).encode()).hexdigest()[:32]
    try:
        return KeptPlace(figures_folder() / f"{way}{_SUFFIX}", log, _sum(files, (way, str(path))))
    except (OSError, RuntimeError):
        return None


def _sum(files: LogFiles, about: Sequence[str]) -> str:
    """Of everything that figures come from. Raises `OSError`."""
    found = hashlib.sha256(_program())
    names = [*about, files.spill, *map(str, (*files.paths, *files.missing))]
    found.update(repr(names).encode())
    for each in files.paths:
        with open_regular(each) as file:
            size = 0
            while piece := file.read(_PIECE):
                size += len(piece)
                found.update(piece)
        found.update(f"\n{size}\n".encode())
    return found.hexdigest()


def kept_report(path: Path, options: FigureOptions = DEFAULTS) -> SessionReport:
    """As `read_report` without extras, and raises the same; from what was kept where it can."""
    place = kept_place(path, options)
    figures = place.load(SessionFigures) if place is not None else None
    if figures is None:
        figures = read_report(path, options).figures
        if place is not None:
            place.keep(figures)
    return SessionReport(figures)


class _FiguresUnpickler(pickle.Unpickler):
    """Makes nothing but rows and numbers: no function is called, whoever wrote the file."""

    def find_class(self, module: str, name: str) -> Any:
        if (module, name) in _PLAIN:
            return super().find_class(module, name)
        found = None
        if module.partition(".")[0] in _packages() and module in sys.modules:
            found = super().find_class(module, name)
        if isinstance(found, type) and (
            is_dataclass(found) or issubclass(found, Durations | Enum | msgspec.Struct | tuple)
        ):
            return found
        raise pickle.UnpicklingError(f"{module}.{name} is no figure")


@cache
def _packages() -> tuple[str, ...]:
    """Of the program, and of features of others."""
    modules = (type(each).__module__ for each in pieces("figures", FeatureFigures).values())
    return tuple(dict.fromkeys(("woz_tui", *(module.partition(".")[0] for module in modules))))


@cache
def _program() -> bytes:
    """What tells one state of the program that counts from another."""
    found = [__version__, sys.version]
    for package in _packages():
        for file in sorted(_sources(package)):
            about = file.stat()
            found.append(f"{file} {about.st_size} {about.st_mtime_ns}")
    return "\n".join(found).encode()


def _sources(package: str) -> Iterator[Path]:
    module = sys.modules[package]
    for folder in getattr(module, "__path__", ()):
        yield from Path(folder).rglob("*.py")
    if not hasattr(module, "__path__") and module.__file__:
        yield Path(module.__file__)


def forget_lost() -> None:
    """Remove what was kept of logs that are not there any more."""
    for kept in _all_kept():
        with suppress(OSError):
            if not _is_of_a_log(kept):
                kept.unlink()


def forget_all() -> None:
    """Remove all that was kept; with the next report it is there again, of logs that are there."""
    for kept in _all_kept():
        with suppress(OSError):
            kept.unlink()


def _all_kept() -> Iterator[Path]:
    with suppress(OSError, RuntimeError):
        yield from figures_folder().glob(f"*{_SUFFIX}*")


def _is_of_a_log(kept: Path) -> bool:
    with open_regular(kept) as file:
        try:
            return Path(msgspec.json.decode(file.read(), type=_Kept).log).is_file()
        except msgspec.MsgspecError:
            return False
