"""WAV files of what was said, written beside everything else: nobody waits for a disk.

Each file is written by a thread of its own under another name and gets its own when it is whole.
A disk that hangs costs one thread and the files until it wakes up, nothing else.
"""

from __future__ import annotations

import asyncio
import errno
import os
import tempfile
import threading
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from woz_drivers.wav import Wav

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
            raise FileExistsError(errno.EEXIST, "there is a file of this name already", str(path))
        part.rename(path)
    finally:
        part.unlink(missing_ok=True)
    return path


class SegmentFiles:
    """Writes, and forgets what was written for a moment only."""

    def __init__(self, rate: int) -> None:
        self._rate = rate
        self._busy = 0
        self._scratch: tempfile.TemporaryDirectory[str] | None = None
        self._scratch_lock = threading.Lock()
        self._closed = False

    def keep(self, path: Path, pcm: bytes) -> asyncio.Future[Path]:
        """Write a file that stays; makes its folder, for its owner only."""

        def work() -> Path:
            path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
            return write(path, pcm, self._rate)

        return self._start(work)

    def lend(self, name: str, pcm: bytes) -> asyncio.Future[Path]:
        """Write a file for a program to read, out of everybody's way; give it back afterwards."""
        return self._start(lambda: write(self._scratch_folder() / name, pcm, self._rate))

    def give_back(self, path: Path) -> asyncio.Future[None]:
        """Delete a file that was lent."""
        return self._start(lambda: path.unlink(missing_ok=True))

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

    def _start(self, work: Callable[[], T]) -> asyncio.Future[T]:
        """Have a thread do it; the future fails with EBUSY if too much is under way."""
        loop = asyncio.get_running_loop()
        done: asyncio.Future[T] = loop.create_future()
        done.add_done_callback(lambda over: over.cancelled() or over.exception())
        if self._busy >= _MOST_AT_ONCE:
            done.set_exception(OSError(errno.EBUSY, "the disk has not finished earlier files"))
            return done
        self._busy += 1

        def settle(result: T | None, error: OSError | None) -> None:
            self._busy -= 1
            if done.done():
                return
            if error is not None:
                done.set_exception(error)
            else:
                done.set_result(result)  # type: ignore[arg-type]

        def run() -> None:
            result, error = None, None
            try:
                result = work()
            except OSError as trouble:
                error = trouble
            try:
                loop.call_soon_threadsafe(settle, result, error)
            except RuntimeError:  # the loop has closed: the session is over
                return

        threading.Thread(target=run, name="speech file", daemon=True).start()
        return done
