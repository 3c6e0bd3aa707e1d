"""Sends pictures to the wizard's terminal: what it can draw, and whether it keeps up."""

from __future__ import annotations

import contextlib
import fcntl
import struct
import termios
from collections.abc import Callable, Mapping

from woz_tui.config.keys.terminals import detect_terminal
from woz_tui.console.camera import kitty
from woz_tui.console.drawing.terminal_output import Output
from woz_tui.console.input.terminal_monitor import TerminalMonitor

#: Values of TERM whose terminals draw pictures over kitty's placeholders. Others that answer the
#: question with yes (Konsole and WezTerm, it is said) know kitty's pictures, but write the
#: placeholders as text.
PLACEHOLDERS = ("xterm-kitty", "xterm-ghostty")


def question(environment: Mapping[str, str]) -> str:
    """What to ask a terminal that may draw pictures as kitty does; nothing for any other one."""
    direct = not detect_terminal(environment).multiplexer
    return kitty.QUESTION if direct and environment.get("TERM", "") in PLACEHOLDERS else ""


class PictureTerminal:
    """One terminal that can be sent pictures. Used in the screen's thread.

    Args:
        output: Where everything is written; None while the terminal is given back.
        line: The line to it; measured by the reading thread.
        wake: Lets the reading thread look around.
    """

    def __init__(
        self, output: Callable[[], Output | None], line: TerminalMonitor, wake: Callable[[], None]
    ) -> None:
        #: What the terminal said of itself; False until it has answered.
        self.kitty = self.sixel = False
        self._output, self._line, self._wake = output, line, wake

    @property
    def waiting(self) -> int:
        """Bytes that the terminal has not taken yet."""
        output = self._output()
        return output.waiting if output is not None else 0

    @property
    def written(self) -> int:
        """Bytes handed over so far."""
        output = self._output()
        return output.written if output is not None else 0

    @property
    def cell(self) -> tuple[int, int] | None:
        """Width and height of a cell in pixels; None where the terminal does not tell."""
        output = self._output()
        if output is None:
            return None
        with contextlib.suppress(OSError):
            told = fcntl.ioctl(output.fd, termios.TIOCGWINSZ, bytes(8))
            rows, columns, width, height = struct.unpack("HHHH", told)
            if rows and columns and width >= columns and height >= rows:
                return width // columns, height // rows
        return None

    def write(self, text: str) -> bool:
        """Write `text` behind all that has been drawn; False if it was dropped."""
        output = self._output()
        return output is not None and output.write(text)

    def hurry(self) -> None:
        """Find out soon when the terminal has what was written up to now."""
        self._line.hurry()
        self._wake()

    def arrived_us(self, written_us: int) -> int | None:
        """When the terminal had what was written until `written_us`; None: not yet.

        A terminal that answers no question has it when it has taken it.
        """
        confirmed = self._line.confirmed_us
        if confirmed is None:
            return None if self._line.waits or self.waiting else written_us
        return confirmed[1] if confirmed[0] >= written_us else None

    @property
    def shortest_us(self) -> int:
        """The shortest time from a question to its answer, in microseconds; 0: unknown."""
        return self._line.quickest_us
