"""Opens files that others have written, and writes files anew so that at every moment the old one
is there or the new one, complete.
"""

from __future__ import annotations

import contextlib
import errno
import fcntl
import glob
import os
import secrets
import stat
import time
from collections.abc import Iterable, Iterator
from io import BufferedReader
from pathlib import Path


class NotRegularError(OSError):
    """A pipe, a device or a socket stands where a file should be."""


def open_regular(path: Path) -> BufferedReader:
    """`path` for reading bytes. Raises `OSError`, also for pipes, devices and folders.

    A pipe would keep the reader waiting for a writer, a device may have no end; a folder of logs
    or an experiment's file can name both.
    """
    file = open(path, "rb", opener=_unblocked)  # noqa: SIM115 - it is what is returned
    if stat.S_ISREG(os.fstat(file.fileno()).st_mode):
        return file
    file.close()
    raise NotRegularError(errno.EINVAL, "this is not a file", str(path))


def _unblocked(path: str, flags: int) -> int:
    """Opened without waiting for somebody at the other end of a pipe."""
    return os.open(path, flags | os.O_NONBLOCK)


@contextlib.contextmanager
def replacing(
    path: Path, text: str | Iterable[str], *, mode: int | None = None, durable: bool = True
) -> Iterator[Path]:
    """Put `text` (or its pieces) into a file beside `path`, on the disk (unless it need not be
    `durable`); it takes that place when the block ends.

    The block gets the fresh file, to look at it; if it raises, all stays as it was. A file that is
    replaced hands its permissions on, unless `mode` says otherwise: then there is no moment in
    which others may read more. Raises `OSError`.
    """
    fresh = path.with_name(f".{path.name}.{secrets.token_hex(4)}.tmp")
    try:
        fresh.touch(0o666 if mode is None else mode, exist_ok=False)
        with fresh.open("w", encoding="utf-8") as file:
            file.writelines((text,) if isinstance(text, str) else text)
            file.flush()
            if durable:
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


def replace(
    path: Path, text: str | Iterable[str], *, mode: int | None = None, durable: bool = True
) -> None:
    """`replacing` for who has nothing to look at."""
    with replacing(path, text, mode=mode, durable=durable):
        pass


def sweep(path: Path) -> None:
    """Remove what writers of `path` left behind who were killed. Only for who knows that nobody
    is writing it now. Raises `OSError`.
    """
    for left in path.parent.glob(f".{glob.escape(path.name)}.*.tmp"):
        left.unlink(missing_ok=True)


# -- several processes and one file ----------------------------------------------------------------

#: How often whoever waits for a lock looks at it, in seconds.
_LOOKS_AFTER = 0.01


def real(path: Path) -> Path:
    """The file behind any symbolic link; a circle of links stays what it is."""
    return Path(os.path.realpath(path))


@contextlib.contextmanager
def locked(path: Path, patience: float) -> Iterator[Path]:
    """Nobody else writes `path` within the block, which gets the file behind any symbolic link.

    The lock is a file of its own, readable for its owner only: the file itself is another one after
    each change. Its folder is made, unless `path` is a link: then it lies on a disk that is not
    mounted. Raises `OSError`; `TimeoutError` if another process keeps the lock for `patience`
    seconds.
    """
    target = real(path)
    if not path.is_symlink():
        target.parent.mkdir(parents=True, exist_ok=True)
    lock = target.with_name(f".{target.name}.lock")
    ends = time.monotonic() + patience
    while True:
        handle = os.open(lock, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW, 0o600)
        try:
            if _is_ours(handle, lock):
                yield target
                return
        finally:
            os.close(handle)
        if time.monotonic() >= ends:
            raise TimeoutError(errno.ETIMEDOUT, "another process keeps it locked")
        time.sleep(_LOOKS_AFTER)


def _is_ours(handle: int, path: Path) -> bool:
    """Whether this process has the lock now, and it is still the one that others look at."""
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        return os.fstat(handle).st_ino == path.stat().st_ino
    except (BlockingIOError, FileNotFoundError):
        return False
