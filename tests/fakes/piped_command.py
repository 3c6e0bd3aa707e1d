"""A named pipe that a test writes to, read by the command of a microphone or a camera."""

from __future__ import annotations

import os
from pathlib import Path


class PipedCommand:
    """A named pipe that `cat PIPE` turns into a driver's command."""

    def __init__(self, path: Path) -> None:
        self.path = path
        os.mkfifo(path)
        self._end: int | None = None

    @property
    def command(self) -> tuple[str, ...]:
        """What the robot file would say."""
        return ("cat", str(self.path))

    def connected(self) -> bool:
        """Whether a command listens; if so, something can be sent."""
        if self._end is None:
            try:
                self._end = os.open(self.path, os.O_WRONLY | os.O_NONBLOCK)
            except OSError:
                return False
        return True

    def send(self, data: bytes, /) -> None:
        """Deliver raw bytes; at most 64 KiB wait to be fetched."""
        assert self._end is not None, "nobody listens yet"
        assert os.write(self._end, data) == len(data), "the pipe is full"

    def unplug(self) -> None:
        """The command comes to its end."""
        if self._end is not None:
            os.close(self._end)
            self._end = None
