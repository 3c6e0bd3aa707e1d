"""Writing to a terminal that may stop taking anything, as a frozen ssh client does.

The screen's thread never waits: it hands over what it drew, and a thread of its own writes it as
fast as the terminal takes it. When too much is waiting all of it is thrown away, because nobody
wants to see old pictures later; once the terminal takes output again the screen is drawn anew.
"""

from __future__ import annotations

import contextlib
import os
import select
import threading
import time
from collections import deque
from collections.abc import Callable

#: Bytes that may wait for the terminal: a few full screens.
LIMIT = 256 * 1024
_CHUNK = 16 * 1024
#: Ends whatever escape sequence the terminal is in the middle of.
_CANCEL = b"\x18"


class Output:
    """One terminal's output.

    Args:
        fd: The terminal. It is opened a second time, so that writing without blocking changes
            nothing for the programs that share `fd`.
        on_recovered: Called from the writing thread when output was dropped and the terminal
            takes it again: draw everything anew.
        limit: Bytes that may wait.
    """

    def __init__(self, fd: int, on_recovered: Callable[[], None], limit: int = LIMIT) -> None:
        self._fd, self._own = _open_again(fd)
        self._on_recovered = on_recovered
        self._limit = limit
        self._more = threading.Condition()  # on a reentrant lock: signal handlers write too
        self._writing = threading.Lock()
        self._waiting: deque[bytes] = deque()
        self._size = 0
        self._rest = b""
        #: Bytes that have been handed over so far, dropped ones left out.
        self.written = 0
        self._dropped = False
        self._over = False
        self._thread = threading.Thread(target=self._run, name="woz-output", daemon=True)
        self._thread.start()

    @property
    def stalled(self) -> bool:
        """Whether output is being dropped at the moment."""
        return self._dropped

    @property
    def fd(self) -> int:
        """The terminal."""
        return self._fd

    @property
    def waiting(self) -> int:
        """Bytes that the terminal has not taken yet."""
        with self._more:
            return self._size + len(self._rest)

    def write(self, text: str) -> bool:
        """Hand `text` over; False if it was dropped. Never waits for the terminal.

        A text is written whole or not at all, so that no escape sequence is torn.
        """
        data = text.encode("utf-8", "replace")
        with self._more:
            if self._over or self._dropped:
                return False
            if self._waiting and self._size + len(data) > self._limit:
                self._waiting.clear()
                self._size = 0
                self._dropped = True
                return False
            self._waiting.append(data)
            self._size += len(data)
            self.written += len(data)
            self._more.notify()
        return True

    def finish(self, last: str, seconds: float) -> None:
        """Write what is waiting, then `last`, then nothing ever again; gives up after `seconds`."""
        until = time.monotonic() + seconds
        with self._more:
            if self._over:
                return
            self._over = True
            waiting = [] if self._dropped else list(self._waiting)
            self._waiting.clear()
            self._more.notify()
        if self._writing.acquire(timeout=seconds):
            try:
                rest = b"".join((self._rest, *waiting))
                if not _write_until(self._fd, rest, time.monotonic() + seconds / 2):
                    last = _CANCEL.decode() + last
                _write_until(self._fd, last.encode(), until)
            finally:
                self._writing.release()
        if self._own:
            os.close(self._fd)

    def _run(self) -> None:
        while True:
            with self._more:
                self._more.wait_for(self._has_work)
                if self._over:
                    return
            if not select_for_writing(self._fd, 0.2):
                continue
            self._write_some()
            if self._dropped and not self._rest:
                with self._more:
                    self._dropped = False
                self._on_recovered()

    def _has_work(self) -> bool:
        return self._over or self._dropped or bool(self._waiting) or bool(self._rest)

    def _write_some(self) -> None:
        """One piece, if nobody finishes at the moment."""
        with self._writing:
            if self._over:
                return
            if not self._rest:
                with self._more:
                    self._rest = b"".join(self._waiting)
                    self._waiting.clear()
                    self._size = 0
            self._rest = self._rest[_write_some(self._fd, self._rest[:_CHUNK]) :]


def select_for_writing(fd: int, seconds: float) -> bool:
    """Wait until `fd` takes something, at most `seconds`."""
    poll = select.poll()
    poll.register(fd, select.POLLOUT)
    return bool(poll.poll(max(0.0, seconds) * 1000))


def _open_again(fd: int) -> tuple[int, bool]:
    """A description of our own that does not block; `fd` itself where there is no other way."""
    flags = os.O_WRONLY | os.O_NONBLOCK | os.O_NOCTTY | os.O_CLOEXEC
    with contextlib.suppress(OSError):
        return os.open(os.ttyname(fd), flags), True
    return fd, False


def _write_some(fd: int, data: bytes) -> int:
    """How many bytes were taken; a terminal that is gone takes everything."""
    try:
        return os.write(fd, data)
    except BlockingIOError:
        return 0
    except OSError:
        return len(data)


def _write_until(fd: int, data: bytes, until: float) -> bool:
    """Whether all of `data` was taken in time."""
    while data:
        if not select_for_writing(fd, until - time.monotonic()):
            return False
        data = data[_write_some(fd, data) :]
    return True
