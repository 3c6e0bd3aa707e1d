"""A WAV file of live sound: written by a thread of its own, so that nobody waits for a disk."""

from __future__ import annotations

import asyncio
import errno
import os
import queue
import threading
import wave
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

#: Bytes of a sample.
_WIDTH = 2
#: So much may wait for a disk that does not answer, in seconds of sound.
_WAITING_S = 30.0
#: A WAV file's header has 32 bits for its length.
_LONGEST = 2**32 - 2**16
#: How long the end of a file is waited for, in seconds.
_FINISHED_WITHIN_S = 2.0
_NEW = os.O_CREAT | os.O_EXCL | os.O_RDWR | os.O_CLOEXEC


@dataclass(slots=True)
class SoundFile:
    """A WAV file that is written by a thread of its own, and valid after each buffer.

    `write_block` and `finish` belong to the event loop; `failed(why)` is called there, once, when
    the file can take no more: the disk is full, hangs, or the file is as long as a WAV file can be.
    """

    path: Path
    rate: int
    channels: int
    failed: Callable[[str], None]
    #: Frames on the disk, and what went wrong.
    frames: int = 0
    trouble: str = ""
    _given: int = 0
    _blocks: queue.SimpleQueue[bytes | None] = field(default_factory=queue.SimpleQueue)
    _done: asyncio.Future[None] = field(
        default_factory=lambda: asyncio.get_running_loop().create_future()
    )

    def begin(self) -> None:
        """Start the thread."""
        loop = asyncio.get_running_loop()
        name = "robot sound"
        threading.Thread(target=self._run, args=(loop,), name=name, daemon=True).start()

    def write_block(self, data: bytes) -> None:
        """Have it written; what comes after a trouble is left out."""
        if self.trouble:
            return
        if self._given - self.frames >= _WAITING_S * self.rate:
            self._fail("the disk does not answer")
        else:
            self._given += len(data) // (_WIDTH * self.channels)
            self._blocks.put(data)

    def end(self) -> None:
        """Nothing more comes; return at once."""
        self._blocks.put(None)

    async def finish(self) -> SoundFile:
        """Return when everything is written, or could not be. A disk that hangs is left alone."""
        self.end()
        await asyncio.wait([self._done], timeout=_FINISHED_WITHIN_S)
        if not self._done.done() and not self.trouble:
            self.trouble = "the disk does not answer"
        return self

    def _fail(self, why: str) -> None:
        if not self.trouble:
            self.trouble = why
            self.failed(why)

    def _run(self, loop: asyncio.AbstractEventLoop) -> None:
        why = ""
        try:
            self._write()
        except (OSError, wave.Error, OverflowError) as error:
            why = (error.strerror if isinstance(error, OSError) else "") or str(error)
        try:
            loop.call_soon_threadsafe(self._ended, why)
        except RuntimeError:
            return  # the session is over; the file is whole up to its last buffer

    def _ended(self, why: str) -> None:
        if why:
            self._fail(why)
        if not self._done.done():
            self._done.set_result(None)

    def _write(self) -> None:
        self.path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        fd = os.open(self.path, _NEW, 0o600)  # a person's voice
        with os.fdopen(fd, "w+b") as file, wave.open(file, "wb") as sound:
            sound.setparams((self.channels, _WIDTH, self.rate, 0, "NONE", "not compressed"))
            while (data := self._blocks.get()) is not None:
                if file.tell() + len(data) > _LONGEST:
                    raise OverflowError("a WAV file cannot be longer; listen again for another one")
                sound.writeframes(data)
                file.flush()
                self._check_not_removed(file.fileno())
                self.frames += len(data) // (_WIDTH * self.channels)

    def _check_not_removed(self, fd: int) -> None:
        """What is written into a file that was removed is nowhere. Raises `OSError`."""
        try:
            same = os.path.samestat(self.path.stat(), os.fstat(fd))
        except FileNotFoundError:
            same = False
        if not same:
            raise OSError(errno.ENOENT, "the file was removed or moved")
