"""Records of one length from a device that is open."""

from __future__ import annotations

import asyncio
import os
import struct
from collections.abc import Callable
from typing import Any

from woz_tui.drivers.contract import DeviceLostError


def open_device(path: str) -> int:
    """A descriptor that never blocks. Raises `DeviceLostError`."""
    try:
        return os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    except PermissionError as error:
        raise DeviceLostError(
            f"no permission to open {path}", "sudo usermod -aG input $USER, then log in again"
        ) from error
    except OSError as error:
        raise DeviceLostError(f"{path} cannot be opened: {error.strerror}") from error


class RecordReader:
    """Hands on what comes from `fd` until it is closed or the device is gone.

    Args:
        fd: The device; it belongs to this reader.
        record: How a record is packed.
        on_record: Given the fields of each.
        on_end: The device is gone.
    """

    def __init__(
        self,
        fd: int,
        record: struct.Struct,
        on_record: Callable[[tuple[Any, ...]], None],
        on_end: Callable[[], None],
    ) -> None:
        self._fd = fd
        self._record = record
        self._on_record = on_record
        self._on_end = on_end
        self._rest = b""
        asyncio.get_running_loop().add_reader(fd, self.read)

    def close(self) -> None:
        """Let go of the device."""
        if self._fd >= 0:
            asyncio.get_running_loop().remove_reader(self._fd)
            os.close(self._fd)
            self._fd = -1

    def read(self) -> None:
        """Hand on what has come."""
        try:
            data = os.read(self._fd, 64 * self._record.size)
        except BlockingIOError:
            return
        except OSError:
            data = b""
        if not data:
            self.close()
            self._on_end()
            return
        data = self._rest + data
        whole = len(data) - len(data) % self._record.size
        self._rest = data[whole:]
        for record in self._record.iter_unpack(data[:whole]):
            self._on_record(record)
