"""A folder that is there as a whole or not at all."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO, TextIO

from woz_tui.export.log_sources import ExportError

README = "README.md"
#: The first words of every export's README: only a folder that has them is ever replaced.
SIGN = "# Sessions exported by woz-tui"
#: Above the list of the files in a README: only those in it are the export's.
FILES = "## Files"
_FLAGS = os.O_CREAT | os.O_EXCL | os.O_WRONLY | os.O_CLOEXEC


class OutputFolder:
    """A folder being written at `path`, which will be `final`; files are for their owner only, as
    logs are.
    """

    def __init__(self, path: Path, final: Path) -> None:
        self.path = path
        self.final = final

    def text(self, name: str) -> TextIO:
        """A new file of UTF-8 text, line ends as they are given; `name` may hold folders."""
        return os.fdopen(self._open(name), "w", encoding="utf-8", newline="")

    def binary(self, name: str) -> BinaryIO:
        """A new file of bytes."""
        return os.fdopen(self._open(name), "wb")

    def write(self, name: str, content: str) -> None:
        """A whole text file."""
        with self.text(name) as file:
            file.write(content)

    def names(self) -> list[str]:
        """The files that it has by now."""
        files = (path for path in self.path.rglob("*") if path.is_file())
        return [path.relative_to(self.path).as_posix() for path in files]

    def _open(self, name: str) -> int:
        path = self.path / name
        missing = [each for each in path.parents if not each.exists()]
        for parent in reversed(missing):
            parent.mkdir(mode=0o700)
        return os.open(path, _FLAGS, 0o600)


def files_section(names: Iterable[str]) -> str:
    """What a README says of the files of an export, for `files_listed`."""
    return "\n".join([FILES, "", *(f"- {name}" for name in sorted(names))]) + "\n"


def files_listed(readme: str) -> list[str]:
    """The files that the README of an export lists; older versions listed none."""
    _, _, listed = readme.rpartition(f"\n{FILES}\n")
    return [line.removeprefix("- ") for line in listed.splitlines() if line.startswith("- ")]


@contextmanager
def new_folder(path: Path, *, force: bool = False) -> Iterator[OutputFolder]:
    """Write into a folder that becomes `path` at the end, if nothing failed.

    Raises:
        ExportError: `path` exists; with `force`, it is no earlier export.
        OSError: It cannot be written; then `path` is as it was.
    """
    path = path.absolute()
    _refuse(path, force)
    path.parent.mkdir(parents=True, exist_ok=True)
    draft = Path(tempfile.mkdtemp(prefix=f".{path.name}.", suffix=".part", dir=path.parent))
    try:
        yield OutputFolder(draft, path)
        _replace(draft, path)
    except OSError as error:
        error.add_note(f"nothing was exported; {path} is unchanged")
        raise
    finally:
        shutil.rmtree(draft, ignore_errors=True)


def _refuse(path: Path, force: bool) -> None:
    if not os.path.lexists(path):
        return
    if not path.is_dir() or path.is_symlink():
        raise ExportError(f"{path} exists and is not a folder", "name another one with --out")
    if not any(path.iterdir()):
        return
    if not force:
        raise ExportError(
            f"{path} is not empty", "name another folder with --out, or replace it with --force"
        )
    if not _is_export(path):
        raise ExportError(
            f"{path} is not an earlier export: --force would delete what is in it",
            "name another folder with --out",
        )


def _is_export(path: Path) -> bool:
    try:
        with (path / README).open(encoding="utf-8") as file:
            return file.readline().startswith(SIGN)
    except (OSError, UnicodeDecodeError):
        return False


def _replace(draft: Path, path: Path) -> None:
    """Gives `draft` the name `path`; an older folder of that name is deleted after that."""
    if not path.exists():
        draft.rename(path)
        return
    with tempfile.TemporaryDirectory(
        prefix=f".{path.name}.", suffix=".old", dir=path.parent, ignore_cleanup_errors=True
    ) as aside:
        old = Path(aside) / "old"
        path.rename(old)
        try:
            draft.rename(path)
        except OSError:
            old.rename(path)
            raise
