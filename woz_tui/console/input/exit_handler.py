"""Ends or pauses the console, and leaves the robot and the terminal in order each time.

| event                                    | what happens                                      |
|------------------------------------------|---------------------------------------------------|
| SIGHUP, SIGTERM, SIGQUIT                 | connection closed (the host stops driving),       |
|                                          | terminal restored, gone within a second           |
| terminal gone (end of file, I/O error)   | the same, also where SIGHUP is ignored            |
| SIGINT                                   | the stop, as the ctrl+c that sends it             |
| ctrl+z, SIGTSTP                          | host told that nobody watches (driving stops),    |
|                                          | terminal restored, suspended; redrawn on resuming |
| SIGCONT after SIGSTOP                    | terminal set up again and redrawn                 |
| no terminal, TERM=dumb                   | refused with a sentence, see `missing_terminal`   |

Handlers are Python's plain ones: they run at the next bytecode of the main thread, while the
event loop's own would wait for a screen that may be busy or blocked for good.
"""

from __future__ import annotations

import contextlib
import os
import signal
import threading
import time
from collections.abc import Callable, Mapping
from types import FrameType
from typing import IO, Protocol

from woz_tui.console.input.terminal_monitor import TerminalMonitor
from woz_tui.console.link.message_feed import MessageFeed
from woz_tui.protocol.requests import Beat

#: After an ending has begun the process is gone after so long, whatever hangs; in seconds.
GRACE_S = 1.0
#: How long telling the robot may hold up a handler; in seconds.
TELL_S = 0.25
#: The exit code where the terminal vanished: that of SIGHUP.
GONE = 128 + signal.SIGHUP
_ENDING = (signal.SIGHUP, signal.SIGTERM, signal.SIGQUIT)


class TerminalControl(Protocol):
    """What an ending does to the terminal."""

    def restore(self) -> None:
        """Give the terminal back as it was found; safe to call twice and from any thread."""
        ...

    def pause(self) -> None:
        """Stop reading and drawing, give the terminal back for a while."""
        ...

    def resume(self) -> None:
        """Take the terminal again and draw everything."""
        ...

    def in_foreground(self) -> bool:
        """Whether this process may use its terminal."""
        ...


class ExitHandler:
    """Acts on signals and on the loss of the terminal.

    Args:
        terminal: What is given back.
        feed: What tells the robot.
        line: What the beats say about the line.
        stop: Stops everything; for SIGINT.
        leave: Asks the app to close, given the exit code; must not wait.
    """

    def __init__(
        self,
        terminal: TerminalControl,
        feed: MessageFeed,
        line: TerminalMonitor,
        stop: Callable[[], None],
        leave: Callable[[int], None],
    ) -> None:
        self._terminal = terminal
        self._feed = feed
        self._line = line
        self._stop = stop
        self._leave = leave
        self._once = threading.Lock()
        self._suspended = False

    def install(self) -> None:
        """Put the handlers in place; from the main thread."""
        for number in _ENDING:
            signal.signal(number, self._on_ending)
        signal.signal(signal.SIGINT, self._on_interrupt)
        signal.signal(signal.SIGTSTP, self._on_suspend)
        signal.signal(signal.SIGCONT, self._on_continue)

    def end(self, code: int) -> None:
        """End the console; from any thread, only the first call counts."""
        if not self._once.acquire(blocking=False):
            return
        threading.Thread(target=self._exit_by_force, args=(code,), daemon=True).start()
        run_aside(self._feed.close)
        self._terminal.restore()
        self._leave(code)

    def _exit_by_force(self, code: int) -> None:
        time.sleep(GRACE_S)
        os._exit(code)

    # -- handlers, in the main thread -----------------------------------------------------------

    def _on_ending(self, number: int, frame: FrameType | None) -> None:
        self.end(128 + number)

    def _on_interrupt(self, number: int, frame: FrameType | None) -> None:
        run_aside(self._stop)

    def _on_suspend(self, number: int, frame: FrameType | None) -> None:
        if self._suspended:
            return
        self._suspended = True
        run_aside(self._tell_away)
        self._terminal.pause()
        self._sleep()
        self._take_again()
        self._suspended = False

    def _on_continue(self, number: int, frame: FrameType | None) -> None:
        """After SIGSTOP, which nobody can catch: the shell may have changed the terminal."""
        if self._suspended or self._once.locked():
            return
        self._suspended = True
        self._terminal.pause()
        self._take_again()
        self._suspended = False

    def _sleep(self) -> None:
        """Stop the process as ctrl+z does, until it is continued in the foreground.

        The default action is used and not SIGSTOP: where nobody could ever continue the process
        (it is its session's first, no shell around it) the kernel then does not stop it.
        """
        ours = signal.signal(signal.SIGTSTP, signal.SIG_DFL)
        signal.pthread_kill(threading.get_ident(), signal.SIGTSTP)
        while not self._terminal.in_foreground():
            time.sleep(0.1)
            signal.pthread_kill(threading.get_ident(), signal.SIGTSTP)
        signal.signal(signal.SIGTSTP, ours)

    def _tell_away(self) -> None:
        self._line.leave()
        self._feed.ask(Beat(line_ok=False))

    def _take_again(self) -> None:
        self._line.reset()
        run_aside(self._feed.ask, Beat(line_ok=True))
        self._terminal.resume()


def run_aside(work: Callable[..., object], *arguments: object) -> None:
    """Do `work(*arguments)` in another thread and wait a moment for it.

    A handler interrupts its thread anywhere, perhaps inside a lock that `work` needs.
    """
    thread = threading.Thread(target=work, args=arguments, daemon=True)
    thread.start()
    thread.join(TELL_S)


def missing_terminal(
    stdin: IO[str] | None, stdout: IO[str] | None, environ: Mapping[str, str]
) -> str:
    """Why the console cannot run here, in a sentence; empty if it can."""
    if not _is_terminal(stdin):
        return (
            "the console needs a terminal, and standard input is none;"
            " start it in a terminal, over ssh with `ssh -t`"
        )
    if not _is_terminal(stdout):
        return (
            "the console draws on the terminal, and standard output is none;"
            " start it without a pipe or redirection"
        )
    term = environ.get("TERM", "")
    if term in ("", "dumb", "unknown"):
        return (
            f"the terminal type TERM={term or '(not set)'} cannot show the console;"
            " set TERM to what you use, for example `TERM=xterm-256color`"
        )
    return ""


def _is_terminal(stream: IO[str] | None) -> bool:
    with contextlib.suppress(OSError, ValueError):
        return stream is not None and stream.isatty()
    return False
