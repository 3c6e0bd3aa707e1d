"""The sound of the robot's microphones, as its ALAudioDevice sends it to a service of ours.

doc.aldebaran.com, "naoqi/audio/alaudiodevice": `processRemote(channels, samples of each, [s, us],
16-bit samples)` is called for every buffer, about six times a second.
"""

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
from typing import Any

from woz_drivers.pepper.link import Said, binary
from woz_drivers.pepper.memory import stamped, within

#: Bytes of a sample.
_WIDTH = 2
#: Of one buffer: four microphones, and a second of 48 kHz. They bound what waits for a disk.
_MOST_CHANNELS, _MOST_SAMPLES = 4, 48_000
#: Buffers that may wait for a disk that does not answer: half a minute of sound.
_WAITING = 200
#: A WAV file's header has 32 bits for its length.
_LONGEST = 2**32 - 2**16
#: How long the end of a file is waited for, in seconds.
_PATIENCE_S = 2.0
_NEW = os.O_CREAT | os.O_EXCL | os.O_RDWR | os.O_CLOEXEC


@dataclass(frozen=True, slots=True)
class Block:
    """One buffer: `data` holds `samples` frames of `channels` samples. `robot_s`: its time stamp by
    the robot's clock, in seconds since 1970.
    """

    channels: int
    samples: int
    data: bytes
    robot_s: float | None


def block(channels: Any, samples: Any, stamp: Any, buffer: Any) -> Block | str:
    """What the robot sent, or why it is no sound. Never raises."""
    some, many = within(channels, 1, _MOST_CHANNELS), within(samples, 1, _MOST_SAMPLES)
    if some is None or many is None or some != int(some) or many != int(many):
        return f"{channels!r} channels of {samples!r} samples are no sound"
    try:
        data = binary(buffer)
    except (Said, UnicodeEncodeError) as trouble:
        return f"the robot's sound: {trouble}"
    if len(data) != int(some) * int(many) * _WIDTH:
        return f"{len(data)} bytes for {int(some)} channels of {int(many)} samples are no sound"
    at = stamped(stamp)
    return Block(int(some), int(many), data, None if at is None else at[0] + at[1] / 1_000_000)


@dataclass(slots=True)
class Written:
    """How much of it is on the disk: frames, and what went wrong."""

    frames: int = 0
    trouble: str = ""


@dataclass(slots=True)
class SoundFile:
    """A WAV file that is written by a thread of its own, and valid after each buffer.

    `put` and `finish` belong to the event loop; `failed(why)` is called there, once, when the file
    can take no more: the disk is full, hangs, or the file is as long as a WAV file can be.
    """

    path: Path
    rate: int
    channels: int
    failed: Callable[[str], None]
    _written: Written = field(default_factory=Written)
    _blocks: queue.SimpleQueue[bytes | None] = field(default_factory=queue.SimpleQueue)
    _done: asyncio.Future[None] = field(
        default_factory=lambda: asyncio.get_running_loop().create_future()
    )

    def begin(self) -> None:
        """Start the thread."""
        loop = asyncio.get_running_loop()
        name = "pepper sound"
        threading.Thread(target=self._run, args=(loop,), name=name, daemon=True).start()

    def put(self, data: bytes) -> None:
        """Have it written; what comes after a trouble is left out."""
        if self._written.trouble:
            return
        if self._blocks.qsize() >= _WAITING:
            self._fail("the disk does not answer")
        else:
            self._blocks.put(data)

    def end(self) -> None:
        """Nothing more comes; return at once."""
        self._blocks.put(None)

    async def finish(self) -> Written:
        """Return when everything is written, or could not be. A disk that hangs is left alone."""
        self.end()
        await asyncio.wait([self._done], timeout=_PATIENCE_S)
        if not self._done.done() and not self._written.trouble:
            self._written.trouble = "the disk does not answer"
        return self._written

    def _fail(self, why: str) -> None:
        if not self._written.trouble:
            self._written.trouble = why
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
                self._still_there(file.fileno())
                self._written.frames += len(data) // (_WIDTH * self.channels)

    def _still_there(self, fd: int) -> None:
        """What is written into a file that was removed is nowhere. Raises `OSError`."""
        try:
            same = os.path.samestat(self.path.stat(), os.fstat(fd))
        except FileNotFoundError:
            same = False
        if not same:
            raise OSError(errno.ENOENT, "the file was removed or moved")
