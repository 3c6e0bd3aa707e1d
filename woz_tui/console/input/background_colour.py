"""Asks a terminal for the colour of its ground, before any session is attached.

The answer begins with ESC, which is the stop. So it is asked for in a short window only, in which
nothing is played; a stop pressed meanwhile is kept, and carried out first of all. Behind it the
terminal is asked what it is, which every terminal answers: with that answer the window is over,
also where nobody tells the colour. An answer that comes later is known to the console's scanner,
which drops it.
"""

from __future__ import annotations

import contextlib
import os
import select
import termios
import time
from dataclasses import dataclass

from woz_tui.console.input.byte_scanner import Scanner
from woz_tui.console.input.escape_sequences import Key, StopToken, TerminalReply

QUESTION = b"\x1b]11;?\x1b\\\x1b[c"
#: How long the answers may take, in seconds.
WINDOW_S = 0.3
#: In per mille: a ground at least so bright is light.
_LIGHT = 500


@dataclass(frozen=True, slots=True)
class TerminalBackground:
    """Whether the ground is light (None: nobody knows), the stops that were pressed, and the other
    keys.
    """

    light: bool | None = None
    stops: tuple[str, ...] = ()
    keys: tuple[str, ...] = ()


def ask_background(source: int, target: int, window_s: float = WINDOW_S) -> TerminalBackground:
    """Ask the terminal at the descriptors `source` and `target`; never raises because of it."""
    try:
        before = termios.tcgetattr(source)
    except termios.error:
        return TerminalBackground()
    quiet = [*before]
    quiet[3] &= ~(termios.ICANON | termios.ECHO | termios.ISIG)
    try:
        termios.tcsetattr(source, termios.TCSANOW, quiet)
        os.write(target, QUESTION)
        return _read_answer(source, time.monotonic() + window_s)
    except (OSError, termios.error):
        return TerminalBackground()
    finally:
        with contextlib.suppress(termios.error):
            termios.tcsetattr(source, termios.TCSANOW, before)


def _read_answer(source: int, until: float) -> TerminalBackground:
    scanner = Scanner()
    scanner.expects_background = True
    light: bool | None = None
    stops: list[str] = []
    keys: list[str] = []
    answered = False
    while not answered or scanner.waiting is not None:
        left = until - time.monotonic() if not answered else 0.0
        pause = left if scanner.waiting is None else scanner.waiting
        if pause <= 0:
            break
        if select.select([source], [], [], pause)[0]:
            data = os.read(source, 4096)
            tokens = scanner.feed(data) if data else scanner.close()
        else:
            data, tokens = b"-", scanner.expire()
        for token in tokens:
            if isinstance(token, StopToken):
                stops.append(token.source)
            elif isinstance(token, Key):
                keys.append(token.chord)
            elif isinstance(token, TerminalReply):
                answered = answered or token.what == "attributes"
                if token.what == "background" and len(token.values) == 3:
                    light = _brightness(token.values) >= _LIGHT
        if not data:
            break
    stops += [token.source for token in scanner.close() if isinstance(token, StopToken)]
    return TerminalBackground(light, tuple(stops), tuple(keys))


def _brightness(colour: tuple[int, ...]) -> float:
    """As the eye weighs the colours (ITU-R BT.601)."""
    red, green, blue = colour
    return 0.299 * red + 0.587 * green + 0.114 * blue
