"""spacenavd's socket, protocol 0: records of eight integers to whoever has connected."""

from __future__ import annotations

import contextlib
import socket
import struct
from pathlib import Path


class FakeSpacenavd:
    """Listens at `path` until it is closed."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._clients: list[socket.socket] = []
        self.start()

    def start(self) -> None:
        """Listen, as after a restart."""
        self._listener = socket.socket(socket.AF_UNIX)
        self._listener.bind(str(self.path))
        self._listener.listen()
        self._listener.setblocking(False)

    def push(self, *axes: int) -> None:
        """x, y, z and the turns about them; what is not said is 0."""
        self.send(struct.pack("=8i", 0, *axes, *(0,) * (6 - len(axes)), 16))

    def button(self, number: int, *, down: bool) -> None:
        """A button, from 0."""
        self.send(struct.pack("=8i", 1 if down else 2, number, 0, 0, 0, 0, 0, 0))

    def send(self, data: bytes) -> None:
        """To all."""
        self._accept()
        for client in self._clients:
            client.sendall(data)

    def close(self) -> None:
        """It ends; its socket's name stays, as after a crash."""
        self._accept()
        for each in (self._listener, *self._clients):
            each.close()
        self._clients.clear()

    def _accept(self) -> None:
        with contextlib.suppress(BlockingIOError):
            self._clients.append(self._listener.accept()[0])
