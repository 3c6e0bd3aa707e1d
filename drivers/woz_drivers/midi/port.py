"""Keeps a MIDI device open for as long as it is there; never blocks, runs in the event loop."""

from __future__ import annotations

import asyncio
import contextlib
import os
import stat
from collections.abc import Callable
from pathlib import Path

from woz_drivers.midi.devices import open_one
from woz_tui.drivers.contract import DeviceLostError

#: A missing device is looked for this often, in seconds.
POLL_S = 0.5
#: How often a plain file is looked at for more, in seconds: no event tells that it has grown.
_FILE_S = 0.02
_READ_SIZE = 4096
#: A device that has taken nothing for this many bytes will not take any more.
_MAX_UNSENT = 4096


class MidiPort:
    """One device; all callbacks run in the event loop.

    Args:
        wanted: Path or card's name, as `devices.paths_of` takes it.
        folder: Where relative paths start.
        on_open: Called with the path before the first bytes of each connection.
        on_bytes: Called with every piece that arrives.
        on_trouble: Called with sentence and remedy when there is no device, or it is lost.
    """

    def __init__(
        self,
        wanted: str,
        folder: Path,
        *,
        on_open: Callable[[str], None],
        on_bytes: Callable[[bytes], None],
        on_trouble: Callable[[str, str], None],
    ) -> None:
        self._wanted = wanted
        self._folder = folder
        self._on_open = on_open
        self._on_bytes = on_bytes
        self._on_trouble = on_trouble
        self._fd = -1
        self._writable = False
        self._unsent = bytearray()
        self._trouble = ("", "")
        self._gone = asyncio.Event()
        self._task: asyncio.Task[None] | None = None
        self.path = ""

    @property
    def connected(self) -> bool:
        """Whether the device is open."""
        return self._fd >= 0

    @property
    def ready(self) -> bool:
        """Whether it takes bytes now: it can be written to and has taken all before."""
        return self.connected and self._writable and not self._unsent

    def start(self) -> None:
        """Begin to look for the device; returns at once."""
        self._task = asyncio.create_task(self._keep_open())

    async def close(self, farewell: bytes = b"") -> None:
        """Stop looking, send `farewell` if there is somebody to hear it, let go."""
        if self._task is not None:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)
            self._task = None
        if farewell and self.ready:
            self.write(farewell)
        self._detach()

    def write(self, data: bytes) -> None:
        """Send `data` as the device takes it; nothing if it cannot be written to."""
        if not self.connected or not self._writable:
            return
        if len(self._unsent) + len(data) <= _MAX_UNSENT:
            self._unsent += data
        self._send()

    async def _keep_open(self) -> None:
        while True:
            try:
                path, fd, writable = open_one(self._wanted, self._folder)
            except DeviceLostError as error:
                self._tell(error.what, error.remedy)
            else:
                await self._attend(path, fd, writable)
                self._gone.clear()
            await asyncio.sleep(POLL_S)

    async def _attend(self, path: str, fd: int, writable: bool) -> None:
        """Read until the device is lost."""
        plain = stat.S_ISREG(os.fstat(fd).st_mode)
        if not plain:
            try:
                asyncio.get_running_loop().add_reader(fd, self._read)
            except OSError:  # a folder, /dev/null: nothing that ever becomes readable
                os.close(fd)
                self._tell(f"{path} is no MIDI device", "name a card, or a path under /dev/snd")
                return
        self.path, self._fd, self._writable = path, fd, writable
        self._trouble = ("", "")
        self._on_open(path)
        while plain and not self._gone.is_set():
            self._read(end_is_loss=os.fstat(fd).st_nlink == 0)
            await asyncio.sleep(_FILE_S)
        await self._gone.wait()

    def _lose(self, reason: str) -> None:
        self._detach()
        self._tell(
            f"{self.path} was lost: {reason}", "plug it in again; it is connected again by itself"
        )
        self._gone.set()

    def _detach(self) -> None:
        fd, self._fd = self._fd, -1
        self._unsent.clear()
        if fd < 0:
            return
        loop = asyncio.get_running_loop()
        with contextlib.suppress(OSError):
            loop.remove_reader(fd)
            loop.remove_writer(fd)
        with contextlib.suppress(OSError):
            os.close(fd)

    def _tell(self, what: str, remedy: str) -> None:
        if (what, remedy) != self._trouble:
            self._trouble = (what, remedy)
            self._on_trouble(what, remedy)

    def _read(self, *, end_is_loss: bool = True) -> None:
        try:
            data = os.read(self._fd, _READ_SIZE)
        except (BlockingIOError, InterruptedError):
            return
        except OSError as error:
            self._lose(error.strerror or str(error))
            return
        if data:
            self._on_bytes(data)
        elif end_is_loss:
            self._lose("it delivers no more data")

    def _send(self) -> None:
        if not self._unsent or not self.connected:
            return
        loop = asyncio.get_running_loop()
        try:
            written = os.write(self._fd, self._unsent)
        except (BlockingIOError, InterruptedError):
            written = 0
        except OSError as error:
            self._lose(error.strerror or str(error))
            return
        del self._unsent[:written]
        if self._unsent:
            loop.add_writer(self._fd, self._send)
        else:
            loop.remove_writer(self._fd)
