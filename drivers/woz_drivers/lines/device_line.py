"""One device on a file descriptor: waits for it, reads it, notices the loss, opens it again.

The event loop itself watches the descriptor (`loop.add_reader`): a quarter of the round trip of a
reading thread, and no second thread to end.
"""

from __future__ import annotations

import abc
import asyncio
import contextlib
import os
from collections.abc import Callable

from woz_tui.drivers.contract import DeviceLostError
from woz_tui.system.tasks import end_tasks

#: A missing or occupied device is tried again this often, in seconds.
POLL_S = 0.5
_READ_SIZE = 4096


class DeviceLine(abc.ABC):
    """Keeps one device open for as long as it exists; all callbacks run in the event loop.

    `on_open()` comes before the first bytes of each connection, `on_bytes(data)` with every piece
    that arrives, `on_trouble(error)` when the device cannot be opened or is lost (and again
    whenever the reason changes). More than `most_unsent` bytes mean that nobody is reading at the
    other end.
    """

    def __init__(
        self,
        path: str,
        *,
        on_open: Callable[[], None],
        on_bytes: Callable[[bytes], None],
        on_trouble: Callable[[DeviceLostError], None],
        poll_s: float = POLL_S,
        most_unsent: int = 1 << 16,
    ) -> None:
        self.path = path
        self._on_open = on_open
        self._on_bytes = on_bytes
        self._on_trouble = on_trouble
        self._poll_s = poll_s
        self._most_unsent = most_unsent
        self._fd = -1
        self._trouble: DeviceLostError | None = None
        self._unsent = bytearray()
        self._gone = asyncio.Event()
        self._task: asyncio.Task[None] | None = None

    @property
    def connected(self) -> bool:
        """Whether the device is open."""
        return self._fd >= 0

    def start(self) -> None:
        """Begin to look for the device; returns at once. Needs a running event loop."""
        self._task = asyncio.create_task(self._keep_open())

    async def close(self) -> None:
        """Stop looking and let go of the device."""
        await end_tasks(self._task)
        self._task = None
        self._detach()

    def write(self, data: bytes) -> None:
        """Send `data`, in order, without waiting. Raises `DeviceLostError` if the device is not
        open or has stopped reading.
        """
        self._need_device()
        if len(self._unsent) + len(data) > self._most_unsent:
            raise DeviceLostError(
                f"{self.path} accepts no more data: {len(self._unsent)} bytes are waiting",
                "check the flow control and whether the device's firmware runs",
            )
        self._unsent += data
        self._send()
        self._need_device()

    def _need_device(self) -> None:
        if not self.connected:
            raise self._trouble or DeviceLostError(f"{self.path} is not open yet")

    # -- opening and losing --------------------------------------------------------------------

    @abc.abstractmethod
    async def _open(self) -> int:
        """Open the device: a descriptor that never blocks. Raises `DeviceLostError`."""

    def _watch(self, fd: int) -> None:
        """Have `_read` called when something has come. Raises `DeviceLostError`."""
        asyncio.get_running_loop().add_reader(fd, self._read)

    def _close(self, fd: int) -> None:
        os.close(fd)

    async def _keep_open(self) -> None:
        while True:
            try:
                fd = await self._open()
                self._watch(fd)
            except DeviceLostError as error:
                self._report(error)
            else:
                self._fd, self._trouble = fd, None
                self._gone.clear()
                self._on_open()
                await self._gone.wait()
            await asyncio.sleep(self._poll_s)

    def _lose(self, reason: str) -> None:
        self._detach()
        self._report(
            DeviceLostError(
                f"{self.path} was lost: {reason}",
                "plug it in again; it is connected again by itself",
            )
        )
        self._gone.set()

    def _detach(self) -> None:
        fd, self._fd = self._fd, -1
        self._unsent.clear()
        if fd < 0:
            return
        loop = asyncio.get_running_loop()
        loop.remove_reader(fd)
        loop.remove_writer(fd)
        with contextlib.suppress(OSError):
            self._close(fd)

    def _report(self, error: DeviceLostError) -> None:
        before, self._trouble = self._trouble, error
        if before is None or (before.what, before.remedy) != (error.what, error.remedy):
            self._on_trouble(error)

    # -- bytes ---------------------------------------------------------------------------------

    def _read(self, *, end_is_loss: bool = True) -> None:
        try:
            data = os.read(self._fd, _READ_SIZE)
        except BlockingIOError:
            return
        except OSError as error:
            self._lose(error.strerror or str(error))
            return
        if data:
            self._on_bytes(data)
        elif end_is_loss:
            self._lose("it delivers no more data")

    def _send(self) -> None:
        loop = asyncio.get_running_loop()
        try:
            del self._unsent[: os.write(self._fd, self._unsent)]
        except BlockingIOError:
            pass
        except OSError as error:
            self._lose(error.strerror or str(error))
            return
        if self._unsent:
            loop.add_writer(self._fd, self._send)
        else:
            loop.remove_writer(self._fd)
