"""A lamp at the other end of a pseudo-terminal: it speaks the wire, not Python."""

from __future__ import annotations

import asyncio
import contextlib
import os
import tty


class LampOnAWire:
    """Answers as the real lamp does; `port` is where a driver finds it."""

    def __init__(self) -> None:
        self._master, slave = os.openpty()
        tty.setraw(slave)
        self.port = os.ttyname(slave)
        self._slave = slave
        self.heard: list[str] = []
        self.slow = False
        self.error = ""
        self._rest = b""
        asyncio.get_running_loop().add_reader(self._master, self._read)

    def _read(self) -> None:
        with contextlib.suppress(OSError):
            *lines, self._rest = (self._rest + os.read(self._master, 4096)).split(b"\n")
            for line in lines:
                self.heard.append(line.decode())
                self._answer(line.decode().split()[0])

    def _answer(self, word: str) -> None:
        if self.error and word == "COLOR":
            self.say(f"ERROR {word} {self.error}")
        elif not (self.slow and word == "COLOR"):
            self.say(f"OK {word}")

    def say(self, line: str) -> None:
        """Send a line on its own account."""
        os.write(self._master, line.encode() + b"\n")

    def pull(self) -> None:
        """Pull the cable."""
        if self._master >= 0:
            asyncio.get_running_loop().remove_reader(self._master)
            os.close(self._slave)
            os.close(self._master)
            self._master = -1
