"""The few calls that reach the disk, gathered so that a test can make each of them fail."""

from __future__ import annotations

import errno
import os
import stat
from contextlib import suppress
from pathlib import Path
from typing import Protocol

#: Some file systems cannot fsync a folder; their files need no such call.
_NO_FOLDER_SYNC = (errno.EINVAL, errno.ENOTSUP, errno.EBADF)

_CREATE = os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_APPEND | os.O_CLOEXEC


class Disk(Protocol):
    """What a recorder asks of the operating system. Every call may raise `OSError`."""

    def make_folder(self, folder: Path) -> None:
        """Make sure that `folder` is there; a new one is for its owner only (0700)."""
        ...

    def create(self, path: Path) -> int:
        """A descriptor of a new file (0600) that only appends; never opens one that exists."""
        ...

    def write(self, fd: int, data: bytes) -> int:
        """Hand `data` to the kernel; how many bytes it took."""
        ...

    def truncate(self, fd: int, size: int) -> None:
        """Cut the file to `size` bytes."""
        ...

    def read(self, fd: int, size: int, offset: int) -> bytes:
        """At most `size` bytes from `offset`."""
        ...

    def fdatasync(self, fd: int) -> None:
        """Wait until the file's content is on the disk."""
        ...

    def fsync(self, fd: int) -> None:
        """Wait until the file's content and its inode are on the disk."""
        ...

    def fsync_folder(self, folder: Path) -> None:
        """Wait until the folder's list of names is on the disk."""
        ...

    def links(self, fd: int) -> int:
        """How many names the open file has; 0 once it was deleted."""
        ...

    def size(self, fd: int) -> int:
        """How many bytes the open file has."""
        ...

    def is_at(self, fd: int, path: Path) -> bool:
        """Whether `path` still names this open file."""
        ...

    def remove(self, path: Path) -> None:
        """Delete a file."""
        ...

    def close(self, fd: int) -> None:
        """Give the descriptor back."""
        ...


class RealDisk:
    """The operating system."""

    def make_folder(self, folder: Path) -> None:
        """Make `folder` and what is missing above it.

        The last folder must be one that nobody else could have laid out for us: in a place that
        everybody may write to, such as /tmp, a folder of another user is refused.
        """
        try:
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        except FileExistsError as error:
            raise NotADirectoryError(errno.ENOTDIR, "is not a folder", str(folder)) from error
        found = folder.stat()
        above = folder.parent.stat()
        if above.st_mode & stat.S_ISVTX and (folder.is_symlink() or found.st_uid != os.getuid()):
            raise PermissionError(errno.EPERM, "belongs to another user", str(folder))

    def create(self, path: Path) -> int:
        """Open with O_EXCL (nothing is overwritten, no symbolic link followed) and O_APPEND."""
        return os.open(path, _CREATE, 0o600)

    def write(self, fd: int, data: bytes) -> int:
        """The system call write."""
        return os.write(fd, data)

    def truncate(self, fd: int, size: int) -> None:
        """The system call ftruncate."""
        os.ftruncate(fd, size)

    def read(self, fd: int, size: int, offset: int) -> bytes:
        """The system call pread."""
        return os.pread(fd, size, offset)

    def fdatasync(self, fd: int) -> None:
        """The system call fdatasync."""
        os.fdatasync(fd)

    def fsync(self, fd: int) -> None:
        """The system call fsync."""
        os.fsync(fd)

    def fsync_folder(self, folder: Path) -> None:
        """fsync(2) of the folder, where we may and its file system knows what that means."""
        try:
            fd = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
        except PermissionError:
            return
        try:
            os.fsync(fd)
        except OSError as error:
            if error.errno not in _NO_FOLDER_SYNC:
                raise
        finally:
            os.close(fd)

    def links(self, fd: int) -> int:
        """st_nlink of fstat(2)."""
        return os.fstat(fd).st_nlink

    def size(self, fd: int) -> int:
        """st_size of fstat(2)."""
        return os.fstat(fd).st_size

    def is_at(self, fd: int, path: Path) -> bool:
        """Compare device and inode."""
        try:
            there = path.stat()
        except (FileNotFoundError, NotADirectoryError):
            return False
        return os.path.samestat(os.fstat(fd), there)

    def remove(self, path: Path) -> None:
        """Unlink; a file that is already gone is no error."""
        with suppress(FileNotFoundError):
            path.unlink()

    def close(self, fd: int) -> None:
        """The system call close."""
        os.close(fd)


_WORDS = {
    errno.ENOSPC: "the disk is full",
    errno.EDQUOT: "the disk quota is used up",
    errno.EROFS: "the disk has become read-only",
    errno.EIO: "the disk reports an input/output error",
    errno.EFBIG: "the file has reached the largest size allowed",
    errno.ENOENT: "the folder does not exist any more",
    errno.ENODEV: "the disk does not exist any more",
    errno.ENXIO: "the disk does not exist any more",
    errno.ESTALE: "the network folder does not exist any more",
    errno.EACCES: "writing is not permitted",
    errno.EPERM: "writing is not permitted",
    errno.ENOTDIR: "a part of the path is not a folder",
    errno.EMFILE: "too many files are open",
}


def disk_problem(error: OSError) -> str:
    """What happened, as a wizard would say it; falls back on the system's own text."""
    words = _WORDS.get(error.errno or 0)
    return words or error.strerror or str(error) or type(error).__name__
