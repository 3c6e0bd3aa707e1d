"""Terminals that draw pictures, that are slow, or both."""

from __future__ import annotations

import fcntl
import os
import re
import struct
import termios
import time
from collections.abc import Sequence
from typing import Any

from tests.fakes.terminal import FakeTerminal

#: What pyte would write as text: kitty's sequences and sixels.
_PICTURES = re.compile(rb"\x1b[_P].*?\x1b\\", re.DOTALL)
_OPEN = re.compile(rb"\x1b[_P](?:(?!\x1b\\).)*\Z", re.DOTALL)


class DrawingTerminal(FakeTerminal):
    """A terminal of 8 x 16 pixels a cell.

    Args:
        command: The program and its arguments.
        sixel: Whether it says that it knows sixels.
        graphics: What it answers to the question for kitty's pictures; None: nothing.
        speed: Bytes a second that it takes; 0: as many as come.
        options: As for `FakeTerminal`.
    """

    def __init__(
        self,
        command: Sequence[str],
        *,
        sixel: bool = False,
        graphics: bytes | None = None,
        speed: int = 0,
        **options: Any,
    ) -> None:
        self._sixel, self._graphics, self._speed = sixel, graphics, speed
        self._torn = b""
        super().__init__(command, **options)

    def resize(self, columns: int, rows: int) -> None:
        super().resize(columns, rows)
        size = struct.pack("HHHH", rows, columns, 8 * columns, 16 * rows)
        fcntl.ioctl(self.master, termios.TIOCSWINSZ, size)

    def _show(self, data: bytes) -> None:
        if b"\x1b_Gi=31,s=1,v=1,a=q" in data and self._graphics is not None:
            os.write(self.master, b"\x1b_Gi=31;" + self._graphics + b"\x1b\\")
        if self._sixel and b"\x1b[c" in data:
            os.write(self.master, b"\x1b[?62;4;22c")
            data = data.replace(b"\x1b[c", b"")
        data = self._torn + data
        left = _OPEN.search(data)
        self._torn = data[left.start() :] if left else b""
        data = data[: left.start()] if left else data
        super()._show(_PICTURES.sub(b"", data))

    def _read(self) -> None:
        """As fast as it is: a terminal at the other end of a slow line."""
        if not self._speed:
            super()._read()
            return
        debt_s, before = 0.0, time.monotonic()
        while True:
            debt_s = max(0.0, debt_s - (time.monotonic() - before))
            self._read_at = before = time.monotonic()
            if debt_s > 0:
                time.sleep(debt_s)
            try:
                data = b"" if self._closed else os.read(self.master, 512)
            except OSError:
                data = b""
            with self._changed:
                if data:
                    self.written += data
                    self._show(data)
                self._changed.notify_all()
                if not data:
                    return
            debt_s += len(data) / self._speed
