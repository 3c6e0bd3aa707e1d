"""Opening a file that others have written: a file on a disk, and nothing else."""

from __future__ import annotations

import errno
import os
import stat
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
