"""A place in which whole sessions are run: folders, processes, and what is in the log.

Everything a test starts here is told apart by the runtime folder in its environment, so that the
end of the test can find and kill what is left, also where a robot process has outlived its parent.
"""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Self

import psutil

from tests.fakes.terminal import ROOT, WAIT_S, FakeTerminal
from woz_tui.log import log_reader
from woz_tui.log.line_reader import decode
from woz_tui.system.session_sockets import answers
from woz_tui.system.user_folders import WIZARD

#: Between two looks at a file or a process, in seconds.
LOOK_S = 0.02


def until(true: Callable[[], Any], what: str, timeout: float = WAIT_S) -> Any:
    """What `true` returns as soon as that is true in any sense; fails after `timeout` seconds."""
    end = time.monotonic() + timeout
    while not (value := true()):
        if time.monotonic() > end:
            raise AssertionError(f"it never came: {what}")
        time.sleep(LOOK_S)
    return value


class Lab:
    """Folders and processes of one test; a context manager that leaves nothing behind."""

    #: What a command begins with so that it runs on another computer.
    inside: tuple[str, ...] = ()

    def __init__(self) -> None:
        # Not pytest's folder: a socket's path may only have 107 bytes.
        self.folder = Path(tempfile.mkdtemp(prefix="woz-e2e-"))
        self.recordings = self.folder / "recordings"
        self.runtime = self.folder / "run"
        self.runtime.mkdir(mode=0o700)
        (self.folder / "state" / WIZARD).parent.mkdir(parents=True)
        (self.folder / "state" / WIZARD).touch()  # nobody is asked who plays
        self.environ = {
            "XDG_RUNTIME_DIR": str(self.runtime),
            "XDG_STATE_HOME": str(self.folder / "state"),
            "XDG_CONFIG_HOME": str(self.folder / "config"),
            "WOZ_SOCKET": "",
        }
        self._closing = contextlib.ExitStack()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *failed: object) -> None:
        self._closing.close()
        for process in self.processes():
            with contextlib.suppress(psutil.NoSuchProcess):
                process.kill()
        until(lambda: not self.processes(), "the end of every process")
        shutil.rmtree(self.folder)

    # -- starting ----------------------------------------------------------------------------

    def file(self, name: str, text: str) -> Path:
        """A file in the lab's folder."""
        path = self.folder / name
        path.write_text(text, encoding="utf-8")
        return path

    def terminal(self, words: Sequence[str], **options: Any) -> FakeTerminal:
        """`woz` with these arguments on a terminal; `options` as of `FakeTerminal`."""
        return self.program([sys.executable, "-m", "woz_tui", *words], **options)

    def program(self, command: Sequence[str], **options: Any) -> FakeTerminal:
        """Any program on a terminal, in the lab's environment."""
        env: Mapping[str, str] = options.pop("env", {})
        terminal = FakeTerminal([*self.inside, *command], env={**self.environ, **env}, **options)
        return self._closing.enter_context(terminal)

    def run(self, experiment: Path, *words: str, **options: Any) -> FakeTerminal:
        """`woz run` with a participant, as soon as the console stands."""
        terminal = self.terminal(["run", str(experiment), *self.session(*words)], **options)
        recording(terminal)
        return terminal

    def session(self, *words: str) -> list[str]:
        """Options that every session of the lab has."""
        return ["--recordings", str(self.recordings), "--participant", "P01", *words]

    def attach(self, *words: str, **options: Any) -> FakeTerminal:
        """`woz attach`, as soon as the console stands."""
        terminal = self.terminal(["attach", *words], **options)
        recording(terminal)
        return terminal

    def host(self, experiment: Path, *words: str) -> subprocess.Popen[bytes]:
        """`woz host`, as soon as it listens."""
        process = self.woz("host", str(experiment), *self.session(*words))
        until(lambda: process.poll() is not None or any(map(answers, self.sockets())), "a host")
        return process

    def woz(self, *words: str, **options: Any) -> subprocess.Popen[bytes]:
        """`woz` with these arguments, without a terminal."""
        process = subprocess.Popen(
            [*self.inside, sys.executable, "-m", "woz_tui", *words],
            cwd=ROOT,
            env={**os.environ, **self.environ, **options.pop("env", {})},
            stdin=options.pop("stdin", subprocess.DEVNULL),
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            **options,
        )
        self._closing.callback(_end, process)
        return process

    def start(self, command: Sequence[str]) -> subprocess.Popen[bytes]:
        """A companion of the session (emulated servos ...), with a standard input for orders."""
        process = subprocess.Popen(
            command,
            cwd=ROOT,
            env={**os.environ, **self.environ},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
        )
        self._closing.callback(_end, process)
        return process

    # -- looking -----------------------------------------------------------------------------

    def processes(self) -> list[psutil.Process]:
        """Every process that was started here and lives, whoever its parent is by now."""
        found = []
        for process in psutil.process_iter():
            with contextlib.suppress(psutil.Error, OSError):
                mine = process.environ().get("XDG_RUNTIME_DIR") == str(self.runtime)
                if mine and process.status() != psutil.STATUS_ZOMBIE:
                    found.append(process)
        return found

    def running(self, command: str) -> psutil.Process:
        """The only process of `woz` with this command, as soon as it is there. A child of it that
        is about to run something else has its words, too.
        """

        def alone() -> psutil.Process | None:
            found: dict[int, tuple[int, psutil.Process]] = {}
            for process in self.processes():
                with contextlib.suppress(psutil.NoSuchProcess):
                    if command in process.cmdline()[:5]:
                        found[process.pid] = process.ppid(), process
            first = [process for parent, process in found.values() if parent not in found]
            return first[0] if len(first) == 1 else None

        process = until(alone, f"a single `woz {command}`")
        assert isinstance(process, psutil.Process)
        return process

    def host_process(self) -> psutil.Process:
        """The robot process."""
        return self.running("host")

    def sockets(self) -> list[Path]:
        """The sockets of robot processes that live or have died."""
        return list(self.runtime.glob("woz/*.sock"))

    def socket(self) -> Path:
        """The only socket."""
        (path,) = until(self.sockets, "a socket")
        return Path(path)

    @property
    def log(self) -> Log:
        """The newest log."""
        return Log(until(lambda: _logs(self.recordings), "a log")[-1])


class Log:
    """The file of actions, read while it is written."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._read: list[log_reader.LogLine] = []
        self._bytes = 0

    def lines(self, kind: str = "", **fields: object) -> list[log_reader.LogLine]:
        """All lines, or those of one kind whose fields have these values."""
        self._read_on()
        return [
            line
            for line in self._read
            if kind in ("", line.kind)
            and all(line.fields.get(name) == value for name, value in fields.items())
        ]

    def _read_on(self) -> None:
        """What has been written since: who looks again and again reads each line once."""
        with self.path.open("rb") as file:
            file.seek(self._bytes)
            data = file.read()
        whole = data[: data.rfind(b"\n") + 1]
        self._bytes += len(whole)
        found = (decode(raw) for raw in whole.splitlines())
        self._read += [line for line in found if line is not None and line.seq >= 0]

    def wait(self, kind: str, count: int = 1, **fields: object) -> log_reader.LogLine:
        """The `count`th line of this kind, as soon as it is there."""
        what = f"line {count} of {kind} {fields}"
        try:
            found = until(lambda: len(lines := self.lines(kind, **fields)) >= count and lines, what)
        except AssertionError as error:
            tail = "\n".join(line.raw.decode() for line in self.lines()[-25:])
            raise AssertionError(f"{error}; the log ends with\n{tail}") from None
        line = found[count - 1]
        assert isinstance(line, log_reader.LogLine)
        return line

    def end_of(self, line: log_reader.LogLine) -> int:
        """Bytes of the file up to and including `line`."""
        data = self.path.read_bytes()
        return data.index(line.raw) + len(line.raw) + 1

    def whole(self) -> tuple[list[log_reader.LogLine], log_reader.Damage]:
        """Every line of every file of the session, and what was wrong with them."""
        damage = log_reader.Damage()
        return list(log_reader.read(self.path, damage)), damage


def _logs(folder: Path) -> list[Path]:
    if not folder.is_dir():
        return []
    found = (path for path in folder.glob("*.jsonl") if ".samples" not in path.name)
    return sorted(found, key=lambda path: path.stat().st_mtime_ns)


def _end(process: subprocess.Popen[bytes]) -> None:
    if process.poll() is None:
        with contextlib.suppress(ProcessLookupError):
            process.send_signal(signal.SIGKILL)
    process.wait()
    for pipe in (process.stdin, process.stdout, process.stderr):
        if pipe is not None:
            pipe.close()


def recording(terminal: FakeTerminal) -> None:
    """Until the console knows its robot process: "Not recording yet" says that it waits,
    and a key pressed then belongs to nothing.
    """
    terminal.wait_for(lambda text: re.search(r"[^○o\s] Recording", text) is not None)


def end_session(terminal: FakeTerminal) -> None:
    """The last choice of the dialog for leaving."""
    terminal.send("\x11")
    terminal.wait_text("─ Leave ─")
    for key in ("\x1b[B", "\x1b[B", "\r"):
        terminal.send(key)


@contextlib.contextmanager
def stopped_process(process: psutil.Process) -> Iterator[None]:
    """Nothing of `process` runs inside; it is continued whatever happens."""
    process.suspend()
    try:
        yield
    finally:
        with contextlib.suppress(psutil.NoSuchProcess):
            process.resume()
