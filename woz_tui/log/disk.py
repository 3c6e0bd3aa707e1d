"""The calls with which the recorder reaches the disk; tests make each of them fail."""

from __future__ import annotations

import errno
import os
import stat
from contextlib import suppress
from pathlib import Path

from woz_tui.protocol.sentence import Sentence

#: Some file systems cannot fsync a folder; their files need no such call.
_NO_FOLDER_SYNC = (errno.EINVAL, errno.ENOTSUP, errno.EBADF)

_CREATE = os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_APPEND | os.O_CLOEXEC


class LogDisk:
    """The operating system; every call may raise `OSError`."""

    def make_folder(self, folder: Path) -> None:
        """Make `folder` (0700) and what is missing above it.

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
        """A descriptor of a new file (0600) that only appends.

        O_EXCL: nothing is overwritten, no symbolic link followed.
        """
        return os.open(path, _CREATE, 0o600)

    def write(self, fd: int, data: bytes) -> int:
        """Hand `data` to the kernel; how many bytes it took."""
        return os.write(fd, data)

    def truncate(self, fd: int, size: int) -> None:
        """Cut the file to `size` bytes."""
        os.ftruncate(fd, size)

    def read(self, fd: int, size: int, offset: int) -> bytes:
        """At most `size` bytes from `offset`."""
        return os.pread(fd, size, offset)

    def fdatasync(self, fd: int) -> None:
        """Wait until the file's content is on the disk."""
        os.fdatasync(fd)

    def fsync(self, fd: int) -> None:
        """Wait until the file's content and its inode are on the disk."""
        os.fsync(fd)

    def fsync_folder(self, folder: Path) -> None:
        """Wait until the folder's names are on the disk, where its file system can do that."""
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
        """How many names the open file has; 0 once it was deleted."""
        return os.fstat(fd).st_nlink

    def size(self, fd: int) -> int:
        """How many bytes the open file has."""
        return os.fstat(fd).st_size

    def is_at(self, fd: int, path: Path) -> bool:
        """Whether `path` still names this open file."""
        try:
            there = path.stat()
        except (FileNotFoundError, NotADirectoryError):
            return False
        return os.path.samestat(os.fstat(fd), there)

    def remove(self, path: Path) -> None:
        """Delete a file; one that is already gone is no error."""
        with suppress(FileNotFoundError):
            path.unlink()

    def close(self, fd: int) -> None:
        """Give the descriptor back."""
        os.close(fd)


_WORDS = {
    errno.ENOSPC: Sentence("log.full", "the disk is full"),
    errno.EDQUOT: Sentence("log.quota", "the disk quota is used up"),
    errno.EROFS: Sentence("log.read_only", "the disk has become read-only"),
    errno.EIO: Sentence("log.io_error", "the disk reports an input/output error"),
    errno.EFBIG: Sentence("log.largest", "the file has reached the largest size allowed"),
    errno.ENOENT: Sentence("log.no_folder", "the folder does not exist any more"),
    errno.ENODEV: Sentence("log.no_disk", "the disk does not exist any more"),
    errno.ENXIO: Sentence("log.no_disk", "the disk does not exist any more"),
    errno.ESTALE: Sentence("log.no_network", "the network folder does not exist any more"),
    errno.EACCES: Sentence("log.not_permitted", "writing is not permitted"),
    errno.EPERM: Sentence("log.not_permitted", "writing is not permitted"),
    errno.ENOTDIR: Sentence("log.not_a_folder", "a part of the path is not a folder"),
    errno.EMFILE: Sentence("log.files_open", "too many files are open"),
}


def disk_problem(error: OSError) -> str:
    """What happened, as a wizard would say it; falls back on the system's own text."""
    words = _WORDS.get(error.errno or 0)
    return words or error.strerror or str(error) or type(error).__name__
