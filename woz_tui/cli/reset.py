"""`woz reset`: put this terminal back after a console that could not do it itself.

A console that is killed (`kill -9`, a line that drops while the shell on the other side stays)
leaves its terminal with a keyboard that sends codes, without a cursor or on the other screen.
"""

from __future__ import annotations

import os
import sys
import termios
from argparse import ArgumentParser, Namespace

from woz_tui.cli.error_sentences import os_error_text

#: Undoes what a console sets, in whichever state it was left: all keyboard flags of kitty (as many
#: as may be stacked), modified keys, marks around pastes, reports of mouse, focus and size, what is
#: being drawn; then plain characters, wrapped lines, the normal screen with its cursor.
RESTORE = (
    "\x1b[<32u\x1b[=0u\x1b[>4;0m"
    "\x1b[?2026l\x1b[?2004l\x1b[?2048l\x1b[?2031l"
    "\x1b[?1016l\x1b[?1015l\x1b[?1006l\x1b[?1005l\x1b[?1004l\x1b[?1003l\x1b[?1002l\x1b[?1000l"
    "\x1b[?1049l\x1b[<32u\x1b[=0u\x1b[?1l\x1b>\x1b[?7h\x1b[?25h\x1b[0m\r\n"
)
_DELETE, _INTERRUPT, _END = b"\x7f", b"\x03", b"\x04"


def add(parser: ArgumentParser) -> None:
    """Declare the command's options: none."""
    parser.epilog = "Type it and enter (or ctrl+j), also where you do not see what you type."


def run(arguments: Namespace) -> int:
    """Restore the terminal that this process was started from."""
    try:
        descriptor = os.open("/dev/tty", os.O_RDWR | os.O_NOCTTY | os.O_CLOEXEC)
    except OSError as error:
        print(f"woz reset: there is no terminal: {os_error_text(error)}", file=sys.stderr)
        return 1
    try:
        os.write(descriptor, RESTORE.encode())
        _line_mode(descriptor)
    except (OSError, termios.error) as error:
        print(f"woz reset: the terminal did not take it: {error}", file=sys.stderr)
        return 1
    finally:
        os.close(descriptor)
    return 0


def _line_mode(descriptor: int) -> None:
    """What `stty sane` sets: lines with an echo, ctrl+c interrupts; what was typed is dropped."""
    read, write, control, local, *speeds, characters = termios.tcgetattr(descriptor)
    read |= termios.ICRNL | termios.IXON | termios.BRKINT
    read &= ~(termios.IGNCR | termios.INLCR | termios.IGNBRK)
    write |= termios.OPOST | termios.ONLCR
    local |= termios.ISIG | termios.ICANON | termios.IEXTEN
    local |= termios.ECHO | termios.ECHOE | termios.ECHOK
    characters[termios.VINTR], characters[termios.VEOF] = _INTERRUPT, _END
    characters[termios.VERASE] = _DELETE
    settings = [read, write, control, local, *speeds, characters]
    termios.tcsetattr(descriptor, termios.TCSAFLUSH, settings)
