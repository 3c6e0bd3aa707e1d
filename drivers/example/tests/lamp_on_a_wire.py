"""A lamp at the other end of a pseudo-terminal: it speaks the wire, not Python."""

from __future__ import annotations

import asyncio
import contextlib
import os
import tty
from pathlib import Path


class LampOnAWire:
    """Answers as the real lamp does, at `port`: a name that lasts, as under /dev/serial/by-id."""

    def __init__(self, port: Path) -> None:
        self.port = port
        self.heard: list[str] = []
        self.error = ""
        self._fade = 0.0
        self._end: asyncio.TimerHandle | None = None
        self.plug()

    def plug(self) -> None:
        """Put the cable in."""
        self._master, self._slave = os.openpty()
        tty.setraw(self._slave)
        self._rest = b""
        self.port.symlink_to(os.ttyname(self._slave))
        asyncio.get_running_loop().add_reader(self._master, self._read)

    def pull(self) -> None:
        """Pull the cable, from which it has its power."""
        if self._master >= 0:
            self._halt()
            asyncio.get_running_loop().remove_reader(self._master)
            os.close(self._slave)
            os.close(self._master)
            self._master = -1
            self.port.unlink()

    def still(self) -> bool:
        """Whether it fades no more."""
        return self._end is None

    def received(self) -> dict[str, float]:
        """What came with the last fade."""
        return {"seconds": self._fade}

    def overheat(self) -> None:
        """It refuses to glow."""
        self.error = "too hot"

    def press(self) -> dict[str, float]:
        """Press the button."""
        self.say("BUTTON 1")
        return {"button": 1.0}

    def say(self, line: str) -> None:
        """Send a line on its own account."""
        os.write(self._master, line.encode() + b"\n")

    def _read(self) -> None:
        with contextlib.suppress(OSError):
            *lines, self._rest = (self._rest + os.read(self._master, 4096)).split(b"\n")
            for line in lines:
                self.heard.append(line.decode())
                self._answer(*line.decode().split())

    def _answer(self, word: str, *numbers: str) -> None:
        if word == "COLOR" and self.error:
            self.say(f"ERROR {word} {self.error}")
        elif word == "COLOR":
            self._halt()
            self._fade = int(numbers[-1]) / 1000
            self._end = asyncio.get_running_loop().call_later(self._fade, self._faded)
        else:
            self._halt()
            self.say(f"OK {word}")

    def _faded(self) -> None:
        self._end = None
        self.say("OK COLOR")

    def _halt(self) -> None:
        if self._end is not None:
            self._end.cancel()
            self._end = None
