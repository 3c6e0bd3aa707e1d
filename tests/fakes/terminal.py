"""A terminal for programs under test: a pseudo-terminal, and pyte to read its screen.

It answers what real ones answer (`CSI c`, `CSI 5 n`, with `kitty` also the keyboard query), can
freeze as an ssh client does, and can be closed.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import re
import select
import signal
import struct
import subprocess
import sys
import termios
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import pyte

ROOT = Path(__file__).parents[2]
WAIT_S = 60.0
#: A reader that has not come round for so long has been kept waiting by a busy machine.
LATE_S = 0.5

#: Makes the pseudo-terminal the controlling one, then becomes the program.
LAUNCH = "import fcntl,os,sys,termios;fcntl.ioctl(0,termios.TIOCSCTTY,0);" + (
    "os.execvp(sys.argv[1],sys.argv[1:])"
)
#: The same with SIGHUP ignored, as `nohup` does.
LAUNCH_NOHUP = "import signal;signal.signal(signal.SIGHUP,signal.SIG_IGN);" + LAUNCH
#: What pyte would draw instead of obeying: kitty's keyboard, questions about modes.
_STRANGE = re.compile(rb"\x1b\[[<>=?][0-9;]*u|\x1b\[\?[0-9;]*\$p|\x18")
_UNFINISHED = re.compile(rb"\x1b(\[[0-9;<>=?$]*)?\Z")
_FOREIGN = ("TMUX", "STY", "COLORTERM", "LINES", "COLUMNS", "NO_COLOR", "TERM_PROGRAM")


class _Screen(pyte.Screen):
    """A screen whose answers go back to the program."""

    def __init__(self, columns: int, rows: int, answer: Callable[[str], None]) -> None:
        self._answer = answer
        super().__init__(columns, rows)

    def write_process_input(self, data: str) -> None:
        self._answer(data)


class FakeTerminal:
    """Runs `command` on a terminal of its own; use it as a context manager.

    Args:
        command: The program and its arguments.
        columns: Of the screen.
        rows: Of the screen.
        env: Changes to the environment; TERM is xterm-256color unless given.
        answers: Whether questions are answered at all.
        kitty: Whether it speaks the kitty keyboard protocol.
        nohup: Whether the program starts with SIGHUP ignored.
    """

    def __init__(
        self,
        command: Sequence[str],
        *,
        columns: int = 80,
        rows: int = 24,
        env: Mapping[str, str] | None = None,
        answers: bool = True,
        kitty: bool = False,
        nohup: bool = False,
    ) -> None:
        self._answers, self._kitty = answers, kitty
        self._changed = threading.Condition()
        self._thawed = threading.Event()
        self._thawed.set()
        self._resting = threading.Event()
        self._read_at = time.monotonic()
        #: When the program last asked how the line is; None: not yet.
        self._asked_at: float | None = None
        #: What waits for the line to go on; None: it does.
        self._under_way: bytearray | None = None
        self._screen = _Screen(columns, rows, self._reply)
        self._stream = pyte.ByteStream(self._screen)
        self._held = b""
        #: Everything the program wrote.
        self.written = bytearray()
        self.master, slave = os.openpty()
        #: The device that the program's side is.
        self.device = os.ttyname(slave)
        self._closed = False
        self.resize(columns, rows)
        #: The terminal's settings before the program began.
        self.attributes_before: list[Any] = termios.tcgetattr(self.master)
        launch = LAUNCH_NOHUP if nohup else LAUNCH
        self.process = subprocess.Popen(
            [sys.executable, "-c", launch, *command],
            stdin=slave,
            stdout=slave,
            stderr=slave,
            cwd=ROOT,
            env=_environment(env or {}),
            start_new_session=True,
        )
        os.close(slave)
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def __enter__(self) -> FakeTerminal:
        return self

    def __exit__(self, *failed: object) -> None:
        if self.process.poll() is None:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()
        self._thawed.set()
        self.close()

    # -- hands --------------------------------------------------------------------------------

    def send(self, data: bytes | str) -> None:
        """Type; what is sent in one call arrives in one read (if it is not too long)."""
        self._catch_up()
        self._pass_on(data.encode() if isinstance(data, str) else data)

    def _pass_on(self, data: bytes) -> None:
        if self._under_way is not None:
            self._under_way += data
        else:
            os.write(self.master, data)

    def _catch_up(self) -> None:
        """Answer a question that is asked now, if a busy machine is late with that: what is typed
        on a line that has stood still is rightly not played.
        """
        began, asked_at = time.monotonic(), self._asked_at
        late = self._read_at if asked_at is None else min(self._read_at, asked_at + LATE_S)
        if not self._thawed.is_set() or self._under_way is not None or began - late < LATE_S:
            return
        with self._changed:
            self._changed.wait_for(lambda: (self._asked_at or 0.0) > began, 2 * LATE_S)

    def resize(self, columns: int, rows: int) -> None:
        """Change the window's size."""
        with self._changed:
            self._screen.resize(rows, columns)
        fcntl.ioctl(self.master, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))

    def freeze(self) -> None:
        """Take no more output, as a frozen ssh client; keys still work. Nothing is read any more
        when this returns.
        """
        self._thawed.clear()
        assert self._resting.wait(WAIT_S), "its reader has ended"

    def thaw(self) -> None:
        """Take output again."""
        self._resting.clear()
        self._thawed.set()

    def stall(self) -> None:
        """What is typed and answered from now on is under way, until `flow`; output is taken."""
        with self._changed:
            self._under_way = bytearray()

    @property
    def under_way(self) -> bytes:
        """What has been typed and answered since `stall`."""
        return bytes(self._under_way or b"")

    def flow(self) -> None:
        """What was under way comes, in one read (if it is not too long)."""
        with self._changed:
            data, self._under_way = self._under_way, None
            os.write(self.master, data or b"")

    def close(self) -> None:
        """Close the window: the program sees a hang-up and the end of its input."""
        if not self._closed:
            self._closed = True
            os.close(self.master)

    # -- eyes ---------------------------------------------------------------------------------

    @property
    def text(self) -> str:
        """The screen as it is now."""
        with self._changed:  # not by `display`, which measures every character again
            rows = (self._screen.buffer[y] for y in range(self._screen.lines))
            places = range(self._screen.columns)
            return "\n".join("".join(row[x].data for x in places).rstrip() for row in rows)

    def wait_for(self, true: Callable[[str], bool], timeout: float = WAIT_S) -> str:
        """The screen's text as soon as `true(text)`; fails with the screen that never was."""
        with self._changed:
            if not self._changed.wait_for(lambda: true(self.text), timeout):
                raise AssertionError(f"the screen never came; this is it:\n{self.text}")
            return self.text

    def wait_text(self, text: str, timeout: float = WAIT_S) -> str:
        """The screen as soon as `text` stands on it."""
        return self.wait_for(lambda screen: text in screen, timeout)

    def wait_written(self, data: bytes, timeout: float = WAIT_S) -> None:
        """Until the program has written `data`."""
        with self._changed:
            if not self._changed.wait_for(lambda: data in self.written, timeout):
                raise AssertionError(f"{data!r} was never written")

    def attributes(self) -> list[Any]:
        """The terminal's settings now (raw, echo ...)."""
        return termios.tcgetattr(self.master)

    def wait_exit(self, timeout: float = WAIT_S) -> int:
        """The program's exit code, once it has ended."""
        return self.process.wait(timeout)

    # -- the wire -----------------------------------------------------------------------------

    def _reply(self, data: str) -> None:
        if self._answers:
            with contextlib.suppress(OSError):
                self._pass_on(data.encode())

    def _read(self) -> None:
        poll = select.poll()
        poll.register(self.master, select.POLLIN)
        while True:
            if not self._thawed.is_set():
                self._resting.set()
                self._thawed.wait()
            begun = time.monotonic()
            # Nobody may be inside a read when the window is closed: it would stay open.
            if not self._closed and not poll.poll(20):
                self._read_at = begun
                continue
            with self._changed:
                try:
                    data = b"" if self._closed else os.read(self.master, 65536)
                except OSError:
                    data = b""
                if not data:
                    self._changed.notify_all()
                    return
                self.written += data
                self._show(data)
                self._read_at = begun
                if b"\x1b[5n" in data:
                    self._asked_at = time.monotonic()
                self._changed.notify_all()

    def _show(self, data: bytes) -> None:
        data = self._held + data
        unfinished = _UNFINISHED.search(data)
        cut = unfinished.start() if unfinished else len(data)
        data, self._held = data[:cut], data[cut:]
        if self._kitty and b"\x1b[?u" in data:
            self._reply("\x1b[?25u")
        self._stream.feed(_STRANGE.sub(b"", data))


def _environment(changes: Mapping[str, str]) -> dict[str, str]:
    kept = {name: value for name, value in os.environ.items() if name not in _FOREIGN}
    return {**kept, "TERM": "xterm-256color", "LC_ALL": "C.UTF-8", **changes}
