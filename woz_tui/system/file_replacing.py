"""Writing a file anew so that at every moment the old one is there or the new one, whole."""

from __future__ import annotations

import contextlib
import glob
import os
import secrets
from collections.abc import Iterator
from pathlib import Path


@contextlib.contextmanager
def replacing(path: Path, text: str, *, mode: int | None = None) -> Iterator[Path]:
    """Put `text` into a file beside `path`, on the disk; it takes that place when the block ends.

    The block gets the fresh file, to look at it; if it raises, all stays as it was. A file that is
    replaced hands its permissions on, unless `mode` says otherwise: then there is no moment in
    which others may read more. Raises `OSError`.
    """
    fresh = path.with_name(f".{path.name}.{secrets.token_hex(4)}.tmp")
    try:
        fresh.touch(0o666 if mode is None else mode, exist_ok=False)
        with fresh.open("w", encoding="utf-8") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        if mode is not None:
            fresh.chmod(mode)
        elif path.exists():
            fresh.chmod(path.stat().st_mode & 0o777)
        yield fresh
        fresh.replace(path)
    finally:
        with contextlib.suppress(OSError):
            fresh.unlink(missing_ok=True)


def replace(path: Path, text: str, *, mode: int | None = None) -> None:
    """`replacing` for who has nothing to look at."""
    with replacing(path, text, mode=mode):
        pass


def sweep(path: Path) -> None:
    """Remove what writers of `path` left behind who were killed. Only for who knows that nobody
    is writing it now. Raises `OSError`.
    """
    for left in path.parent.glob(f".{glob.escape(path.name)}.*.tmp"):
        left.unlink(missing_ok=True)
