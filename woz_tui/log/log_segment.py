"""Writes the log into one pair of files; a thread syncs them to the disk."""

from __future__ import annotations

import errno
import sys
import threading
import time
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from itertools import islice
from pathlib import Path
from typing import NamedTuple

from woz_tui.log.disk import LogDisk, disk_problem
from woz_tui.log.file_names import FileName
from woz_tui.log.samples_index import IndexBuilder


class UnsyncedLine(NamedTuple):
    """One line; `at_us` is when it was handed in, on the session's clock."""

    at_us: int
    line: bytes


class UnsyncedLines:
    """Lines in the order they came, numbered from 1, until the disk has confirmed them.

    At most `limit` bytes are held; beyond that the oldest line goes. While a file takes the lines
    that only means that it cannot be written a second time; while no file does, it is lost.
    """

    def __init__(self, limit: int) -> None:
        self._limit = limit
        self._entries: deque[UnsyncedLine] = deque()
        self._size = 0
        #: The last line that a file has taken, or will take.
        self._taken = sys.maxsize
        self._forgotten = 0
        self._worst_us = 0
        self.last = 0
        self.synced = 0
        self.lost = 0

    def push(self, line: bytes, at_us: int) -> None:
        self._entries.append(UnsyncedLine(at_us, line))
        self._size += len(line)
        self.last += 1
        while self._size > self._limit:
            oldest = self.last - len(self._entries) + 1
            self._size -= len(self._entries.popleft().line)
            if oldest > self._taken:
                self.lost += 1
            else:
                self._forgotten += 1

    def confirm(self, number: int, now_us: int) -> None:
        """Lines up to `number` are on the disk, as of now."""
        if number <= self.synced:
            return
        self._worst_us = max(self._worst_us, self.age_us(now_us))
        self.synced = number
        waiting = self.last - number
        while len(self._entries) > waiting:
            self._size -= len(self._entries.popleft().line)
        self._forgotten = min(self._forgotten, waiting - len(self._entries))

    def excuse(self, pause_us: int, now_us: int) -> None:
        """In a pause that has just ended nothing could reach the disk: it does not count."""
        self._worst_us = max(0, self._worst_us - pause_us)
        self._entries = deque(
            UnsyncedLine(min(entry.at_us + pause_us, now_us), entry.line) for entry in self._entries
        )

    def file_failed(self) -> None:
        """The file that took the lines failed: what memory has let go may be lost."""
        self.lost += self._forgotten
        self._forgotten = 0
        self._taken = 0

    def file_took(self, number: int) -> None:
        """Lines up to `number` are in a new file, which may yet fail."""
        self._taken = max(number, self._taken)

    def file_opened(self) -> None:
        """A new file has taken everything that is held."""
        self._taken = sys.maxsize

    def lines(self, after: int = 0) -> list[bytes]:
        """Everything held, or what of it has come after the line of this number, oldest first."""
        newer = min(len(self._entries), self.last - after)
        return [entry.line for entry in islice(self._entries, len(self._entries) - newer, None)]

    @property
    def waiting(self) -> int:
        """How many lines are held."""
        return len(self._entries)

    def age_us(self, now_us: int) -> int:
        """Age of the oldest unconfirmed line, 0 if there is none."""
        return now_us - self._entries[0].at_us if self._entries else 0

    def take_worst_us(self, now_us: int) -> int:
        """The longest that a line had to wait since the last call, waiting ones included."""
        worst, self._worst_us = max(self._worst_us, self.age_us(now_us)), 0
        return worst


ACTIONS = 0
SAMPLES = 1

#: Samples are seen onto the disk five times a second: each time costs a flash card an erase.
SAMPLES_EVERY_S = 0.2
_COPY_BLOCK = 1 << 20
_DELETED = "the log was deleted"

#: Does what it is given, from the caller's thread: at once, or when the caller has time for it.
Defer = Callable[[Callable[[], None]], object]


def at_once(work: Callable[[], None]) -> None:
    """The `Defer` of a caller without an event loop."""
    work()


#: Called with the segment and the reason in words; its files may well go on taking lines.
Trouble = Callable[["OpenSegment", str], None]


class LogFile:
    """A new file that only grows, line by whole line."""

    def __init__(self, disk: LogDisk, path: Path) -> None:
        self._disk = disk
        self.path = path
        self.fd = disk.create(path)
        self.size = 0
        self.sync_failed = False

    def append(self, data: bytes) -> None:
        """Whole lines into the kernel with one write. A part that got in is cut off again.

        Raises `OSError`, also if the file has no name any more: nobody would find the lines.
        """
        taken = self._disk.write(self.fd, data)
        if taken != len(data):
            with suppress(OSError):
                self._disk.truncate(self.fd, self.size)
            raise OSError(errno.ENOSPC, f"only {taken} of {len(data)} bytes were written")
        self.size += taken
        if self.deleted:
            raise OSError(_DELETED)

    def sync(self) -> None:
        """Onto the disk. After one failure never again: the kernel has dropped the pages and
        would report success for lines that are gone.
        """
        self._sync_with(self._disk.fdatasync)

    def settle(self) -> None:
        """Onto the disk with its inode; once, when the file is new."""
        self._sync_with(self._disk.fsync)

    def _sync_with(self, call: Callable[[int], None]) -> None:
        if self.sync_failed:
            raise OSError(errno.EIO, "an earlier sync of this file failed")
        try:
            call(self.fd)
        except OSError:
            self.sync_failed = True
            raise

    def trouble(self) -> str:
        """What became of the file's name; empty while it is in its place."""
        if self.deleted:
            return _DELETED
        if not self._disk.is_at(self.fd, self.path):
            return "the log was moved or replaced"
        known = self.size
        return "another program cut the log short" if self._disk.size(self.fd) < known else ""

    @property
    def deleted(self) -> bool:
        """Whether the file has lost its last name; its content stays until it is closed."""
        return self._disk.links(self.fd) == 0

    def copied(self, folder: Path, name: str, header: bytes) -> None:
        """A settled copy of everything in this file, whether it still has a name or not.

        Raises `OSError`, leaving nothing.
        """
        self._disk.make_folder(folder)
        copy = LogFile(self._disk, folder / name)
        try:
            copy.append(header)
            offset = 0
            while block := self._disk.read(self.fd, min(_COPY_BLOCK, self.size - offset), offset):
                copy.append(block)
                offset += len(block)
            copy.settle()
        except OSError:
            copy.discard()
            raise
        copy.close()

    def close(self) -> None:
        """Give the descriptor back."""
        with suppress(OSError):
            self._disk.close(self.fd)

    def discard(self) -> None:
        """Close and delete; for a file that holds nothing of value."""
        self.close()
        with suppress(OSError):
            self._disk.remove(self.path)


class OpenSegment:
    """Segment `number`: the file of actions and, unless there is no room for it, that of samples.

    `append` is called with `lock` held. The thread takes the lock only to read and set marks,
    never while it waits for the disk.
    """

    def __init__(
        self,
        folder: Path,
        name: FileName,
        *,
        disk: LogDisk,
        backlogs: tuple[UnsyncedLines, UnsyncedLines],
        lock: threading.Condition,
        now_us: Callable[[], int],
        trouble: Trouble,
    ) -> None:
        self._disk = disk
        self._now_us = now_us
        self._backlogs = backlogs
        self._lock = lock
        self._trouble = trouble
        self._wake = threading.Event()
        self._waking = False
        self._released = threading.Event()
        self._after: Callable[[OpenSegment], None] | None = None
        self._last_line = b""
        self.folder = folder
        self.number = name.number
        self.current = True
        disk.make_folder(folder)
        self._actions = LogFile(disk, folder / str(name))
        self._samples: LogFile | None = None
        #: The file of samples, there or not.
        self.samples_path = folder / str(FileName(name.stem, name.number, True))
        self._index = IndexBuilder()
        self._thread = threading.Thread(
            target=self._run, name=f"log-disk-{name.number}", daemon=True
        )

    @property
    def path(self) -> Path:
        """The file of actions."""
        return self._actions.path

    @property
    def takes_samples(self) -> bool:
        """Whether there is a file of samples."""
        return self._samples is not None

    @property
    def files(self) -> list[tuple[int, LogFile]]:
        """The files there are, actions first."""
        samples = [(SAMPLES, self._samples)] if self._samples else []
        return [(ACTIONS, self._actions), *samples]

    def open_samples(self, header: bytes) -> None:
        """Begin the file of samples with what waits for it. Raises `OSError`, leaving nothing."""
        file = LogFile(self._disk, self.samples_path)
        try:
            file.append(header + b"".join(self._backlogs[SAMPLES].lines()))
        except OSError:
            file.discard()
            raise
        self._samples = file

    def append(self, which: int, data: bytes) -> None:
        """Lines into the kernel; samples without a file are passed over. Raises `OSError`."""
        if which == ACTIONS:
            self._actions.append(data)
        elif self._samples is not None:
            self._samples.append(data)

    def wake(self, defer: Defer) -> None:
        """Let the thread see the actions onto the disk, when `defer` comes to it."""
        if not self._waking:
            self._waking = True
            defer(self._wake.set)

    def start(self) -> None:
        """Begin to see lines onto the disk."""
        self._wake.set()
        self._thread.start()

    def discard(self) -> None:
        """Delete the files of a segment that was never started."""
        for _, file in self.files:
            file.discard()

    def release(
        self, after: Callable[[OpenSegment], None] | None = None, last_line: bytes = b""
    ) -> None:
        """No more lines will come but `last_line`, if the disk takes it: one last sync, then
        `after(self)`, then the files are closed.
        """
        self._after = after
        self._last_line = self._last_line or last_line
        self._released.set()
        self._wake.set()

    def join(self, timeout_s: float) -> None:
        """Wait for the thread's end, no longer than `timeout_s`."""
        self._thread.join(max(0.0, timeout_s))

    # -- the thread ---------------------------------------------------------------------------

    def _run(self) -> None:
        try:
            self._serve()
        except OSError as error:
            self._trouble(self, disk_problem(error))
        self._released.wait()
        self._finish()

    def _serve(self) -> None:
        settled = self._settle()
        samples_due = time.monotonic()
        while not self._released.is_set():
            self._wake.wait(SAMPLES_EVERY_S)
            self._wake.clear()
            self._waking = False  # before the look at what there is: nothing slips through
            self._sync(ACTIONS, self._actions)
            now = time.monotonic()
            if self._samples is not None and now >= samples_due:
                settled = settled or self._settle()
                self._sync(SAMPLES, self._samples)
                self._index.extend(self._samples.fd, self._samples.size, whole=False)
                samples_due = now + SAMPLES_EVERY_S
            trouble = next(filter(None, (file.trouble() for _, file in self.files)), "")
            if trouble:
                self._trouble(self, trouble)
                return

    def _settle(self) -> bool:
        """New files, and the folders' mention of them, onto the disk; True if both were there."""
        files = self.files
        for _, file in files:
            file.settle()
        self._disk.fsync_folder(self.folder)
        with suppress(OSError):
            self._disk.fsync_folder(self.folder.parent)
        return len(files) == 2

    def _sync(self, which: int, file: LogFile) -> None:
        backlog = self._backlogs[which]
        with self._lock:
            target, done = backlog.last, backlog.synced
            if target == done or not self.current:
                return
        file.sync()
        with self._lock:
            if self.current:
                backlog.confirm(target, self._now_us())
                self._lock.notify_all()

    def _finish(self) -> None:
        if self._last_line and not self._actions.deleted:
            with suppress(OSError):
                self._actions.append(self._last_line)
        for which, file in self.files:
            try:
                if self.current:
                    self._sync(which, file)
                elif not file.deleted:
                    file.sync()
            except OSError as error:
                if self.current:  # nobody has its lines elsewhere yet
                    self._trouble(self, disk_problem(error))
        if self._after is not None:
            self._after(self)
        if self._samples is not None and not self._samples.deleted:
            self._index.extend(self._samples.fd, self._samples.size, whole=True)
            self._index.leave(self._samples.path, self._samples.fd)
        for _, file in self.files:
            file.close()
