"""Disks that fail as real ones do: the calls are real, the faults are put in between."""

from __future__ import annotations

import errno
import os
import threading
from pathlib import Path

from woz_tui.log.disk import LogDisk

#: What may be wrong with a folder's disk.
FAULTS = ("full", "readonly", "io", "short", "sync")


class FaultyDisk(LogDisk):
    """The operating system with faults that can be switched on for each folder.

    full: a real ENOSPC, from /dev/full; readonly: EROFS for everything; io: EIO on writing;
    short: half of a line gets in; sync: fdatasync and fsync report EIO; no samples: no file of
    samples can be made. While `gate` is cleared, syncing hangs; while `looks` is, looking whether a
    file is still there does.
    """

    def __init__(self) -> None:
        self.faults: dict[Path, str] = {}
        self.gate = threading.Event()
        self.gate.set()
        self.looks = threading.Event()
        self.looks.set()
        self.looked = threading.Event()
        self.syncs_after_failure = 0
        self._folders: dict[int, Path] = {}
        self._failed: set[int] = set()

    def _fault(self, fd: int) -> str:
        return self.faults.get(self._folders[fd], "")

    def create(self, path: Path) -> int:
        if self.faults.get(path.parent) == "readonly":
            raise OSError(errno.EROFS, "Read-only file system")
        if self.faults.get(path.parent) == "no samples" and ".samples." in path.name:
            raise OSError(errno.ENOSPC, "No space left on device")
        fd = super().create(path)
        self._folders[fd] = path.parent
        self._failed.discard(fd)
        return fd

    def write(self, fd: int, data: bytes) -> int:
        match self._fault(fd):
            case "full":
                full = os.open("/dev/full", os.O_WRONLY)
                try:
                    return os.write(full, data)
                finally:
                    os.close(full)
            case "readonly":
                raise OSError(errno.EROFS, "Read-only file system")
            case "io":
                raise OSError(errno.EIO, "Input/output error")
            case "short":
                return super().write(fd, data[: len(data) // 2])
        return super().write(fd, data)

    def is_at(self, fd: int, path: Path) -> bool:
        self.looked.set()
        self.looks.wait(60)
        return super().is_at(fd, path)

    def fdatasync(self, fd: int) -> None:
        self._sync(fd)
        super().fdatasync(fd)

    def fsync(self, fd: int) -> None:
        self._sync(fd)
        super().fsync(fd)

    def _sync(self, fd: int) -> None:
        self.gate.wait(60)
        if fd in self._failed:
            self.syncs_after_failure += 1
        if self._fault(fd) == "sync":
            self._failed.add(fd)
            raise OSError(errno.EIO, "Input/output error")
