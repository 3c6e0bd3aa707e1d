"""WAV files of what was said, written beside everything else: nobody waits for a disk.

Each file is written by a thread of its own under another name and gets its own when it is whole.
The same thread sees to it that a file which stays outlives a power cut, after it was told that it
is there: a card in a robot may take a second for that, and the robot is to answer. A disk that
hangs costs one thread and the files until it wakes up, nothing else.
"""

from __future__ import annotations

import asyncio
import contextlib
import errno
import os
import tempfile
import threading
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from woz_drivers.sound.wav import Wav
from woz_tui.drivers.background import forget_outcome

#: So many files may be on their way to a disk that does not answer.
_MOST_AT_ONCE = 4

_FLAGS = os.O_CREAT | os.O_WRONLY | os.O_TRUNC | os.O_CLOEXEC

T = TypeVar("T")


def write(path: Path, pcm: bytes, rate: int) -> Path:
    """Write one channel of 16-bit samples to `path`, all of it or nothing; for threads.

    Raises `OSError`: disk full, the folder is none, the file is there already.
    """
    part = path.with_name(f".{path.name}.part")
    try:
        with os.fdopen(os.open(part, _FLAGS, 0o600), "wb") as file:  # a person's voice
            file.write(Wav("S16_LE", rate, 1, pcm).to_bytes())
        if path.exists():
            raise FileExistsError(errno.EEXIST, "a file with this name exists already", str(path))
        part.rename(path)
    finally:
        part.unlink(missing_ok=True)
    return path


def secure(path: Path) -> None:
    """Have a file on the disk itself, with its name; for threads. Raises `OSError`: the file may
    be empty, or lack a part, after a power cut.
    """
    _sync(path)
    with contextlib.suppress(OSError):  # some file systems cannot do that for a folder
        _sync(path.parent)


def _sync(path: Path) -> None:
    fd = os.open(path, os.O_RDONLY | os.O_CLOEXEC)
    try:
        os.fsync(fd)
    finally:
        os.close(fd)


class SegmentFiles:
    """Writes, and forgets what was written for a moment only. `on_unsafe` hears of a file that was
    written and may not be there after a power cut.
    """

    def __init__(self, rate: int, on_unsafe: Callable[[OSError], None]) -> None:
        self._rate = rate
        self._on_unsafe = on_unsafe
        self._busy = 0
        self._scratch: tempfile.TemporaryDirectory[str] | None = None
        self._scratch_lock = threading.Lock()
        self._closed = False

    def keep(self, path: Path, pcm: bytes) -> asyncio.Future[Path]:
        """Write a file that stays; makes its folder, for its owner only."""

        def work() -> Path:
            path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
            return write(path, pcm, self._rate)

        return self._start(work, secure)

    def lend(self, name: str, pcm: bytes) -> asyncio.Future[Path]:
        """Write a file for a program to read, out of everybody's way; give it back afterwards."""
        return self._start(lambda: write(self._scratch_folder() / name, pcm, self._rate))

    def give_back(self, path: Path) -> asyncio.Future[None]:
        """Delete a file that was lent."""
        return self._start(lambda: path.unlink(missing_ok=True), most=None)

    def close(self) -> None:
        """Delete whatever was lent."""
        with self._scratch_lock:
            self._closed = True
            scratch, self._scratch = self._scratch, None
        if scratch is not None:
            scratch.cleanup()

    def _scratch_folder(self) -> Path:
        with self._scratch_lock:
            if self._closed:
                raise OSError(errno.ESHUTDOWN, "the session has ended")
            if self._scratch is None:
                self._scratch = tempfile.TemporaryDirectory(
                    prefix="woz-speech-", ignore_cleanup_errors=True
                )
            return Path(self._scratch.name)

    def _start(
        self,
        work: Callable[[], T],
        afterwards: Callable[[T], None] | None = None,
        *,
        most: int | None = _MOST_AT_ONCE,
    ) -> asyncio.Future[T]:
        """Have a thread do it; the future fails with EBUSY if `most` are under way (None: never,
        for there are no more files to delete than were written). `afterwards` the thread goes on
        with the result, and nobody waits for that.
        """
        loop = asyncio.get_running_loop()
        done: asyncio.Future[T] = loop.create_future()
        done.add_done_callback(forget_outcome)
        if most is not None and self._busy >= most:
            done.set_exception(OSError(errno.EBUSY, "the disk has not finished earlier files"))
            return done
        self._busy += 1

        def run() -> None:
            try:
                result = work()
            except Exception as trouble:  # noqa: BLE001 - whoever waits for the file is to know
                _call_in_loop(loop, self._over, _fail, done, trouble)
                return
            if afterwards is None:
                _call_in_loop(loop, self._over, _succeed, done, result)
                return
            _call_in_loop(loop, _succeed, done, result)
            try:
                afterwards(result)
            except OSError as trouble:
                _call_in_loop(loop, self._on_unsafe, trouble)
            finally:
                _call_in_loop(loop, self._free)

        try:
            threading.Thread(target=run, name="speech file", daemon=True).start()
        except RuntimeError as trouble:  # the system gives no more threads
            self._free()
            done.set_exception(OSError(errno.EAGAIN, str(trouble)))
        return done

    def _over(
        self, settle: Callable[[asyncio.Future[T], T], None], done: asyncio.Future[T], value: T
    ) -> None:
        """Its place is free before whoever waits for it hears so: they may ask for the next one."""
        self._free()
        settle(done, value)

    def _free(self) -> None:
        self._busy -= 1


def _succeed(done: asyncio.Future[T], result: T) -> None:
    if not done.done():
        done.set_result(result)


def _fail(done: asyncio.Future[T], error: Exception) -> None:
    if not done.done():
        done.set_exception(error)


def _call_in_loop(
    loop: asyncio.AbstractEventLoop, call: Callable[..., None], *args: object
) -> None:
    """From a thread to the loop, unless that has closed: then the session is over."""
    with contextlib.suppress(RuntimeError):
        loop.call_soon_threadsafe(call, *args)
