"""A child process that is never left behind.

It leads a process group of its own, so that it dies with everything it started and a Ctrl-C in the
terminal does not reach it. When the robot process itself is killed the kernel kills the child, and
`guard` what the child had started.
"""

from __future__ import annotations

import asyncio
import contextlib
import os
import shutil
import signal
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import cast

from woz_drivers.programs import command_lines
from woz_tui.drivers.contract import DriverError
from woz_tui.system.retry_pauses import RetryPauses

# -- orphan guard --------------------------------------------------------------------------------
# The kernel ends a direct child with us, but not what that child started: both programs of
# `sh -c "piper | aplay"` would go on. So one small shell reads from a pipe which process groups
# there are. When we are gone, however that happened, the pipe ends, and it kills what is left.

_SHELL = Path("/bin/sh")
#: `+ 12` adds a group, `- 12` takes it away; numbers of groups are unique for as long as they run.
_SCRIPT = """
trap '' HUP INT TERM
while read -r sign group; do
  left=
  for one in $groups; do [ "$one" = "$group" ] || left="$left $one"; done
  [ "$sign" = - ] || left="$left $group"
  groups=$left
done
for one in $groups; do kill -s KILL -- "-$one"; done
"""


class Guard:
    """The shell and the pipe to it; it is started with the first group.

    Attributes:
        pid: The shell's, None before.
    """

    def __init__(self) -> None:
        self.pid: int | None = None
        self._pipe = -1

    def watch(self, group: int) -> None:
        """Kill this process group should we end before `release`."""
        if self.pid is None:
            self._start()
        self._write(f"+ {group}\n")

    def release(self, group: int) -> None:
        """The group has ended; its number may be given to somebody else."""
        self._write(f"- {group}\n")

    def _start(self) -> None:
        reading, self._pipe = os.pipe()  # neither end is inherited by other children
        os.set_blocking(self._pipe, False)
        silent = [(os.POSIX_SPAWN_OPEN, fd, os.devnull, os.O_WRONLY, 0) for fd in (1, 2)]
        try:
            self.pid = os.posix_spawn(
                _SHELL,
                (_SHELL.name, "-c", _SCRIPT),
                {},
                file_actions=[(os.POSIX_SPAWN_DUP2, reading, 0), *silent],
                setsid=True,
            )
        except (OSError, NotImplementedError):
            os.close(self._pipe)  # then without: the kernel still ends direct children
            self._pipe = -1
        finally:
            os.close(reading)

    def _write(self, line: str) -> None:
        with contextlib.suppress(OSError):
            os.write(self._pipe, line.encode())


#: The one of this process.
guard = Guard()


# --------------------------------------------------------------------------------------------------

#: How long the last words of a dead child may take to arrive, in seconds.
_LAST_WORDS_S = 0.2
#: Pauses before a dead child is started again, in seconds: doubled each time up to the limit, back
#: to the first after it has run well for a while.
_FIRST_PAUSE_S = 0.5
_LONGEST_PAUSE_S = 10.0
_WELL_S = 10.0
#: How long a listing of sound cards may take, in seconds.
_LIST_S = 8.0
#: How much of what a child says on stderr is kept, in bytes.
_KEPT = 4096


class RestartPauses(RetryPauses):
    """How long to wait before a child that ended is started again."""

    def __init__(self) -> None:
        super().__init__(_FIRST_PAUSE_S, _LONGEST_PAUSE_S)

    def after_run(self, lasted_s: float) -> float:
        """Seconds to wait after a run that went well for `lasted_s`."""
        return self.after(lasted_s >= _WELL_S)


class Child(asyncio.SubprocessProtocol):
    """One running child. `on_output(data)`: what it writes to stdout, in the event loop."""

    def __init__(self, program: str, on_output: Callable[[bytes], None] | None = None) -> None:
        self.program = program
        self._on_output = on_output
        self._stderr = b""
        self._transport: asyncio.SubprocessTransport | None = None
        self._exited = asyncio.Event()
        self._stdout_closed, self._stderr_closed = asyncio.Event(), asyncio.Event()

    # -- called by asyncio ---------------------------------------------------------------------

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """The child runs."""
        self._transport = cast(asyncio.SubprocessTransport, transport)

    def pipe_data_received(self, fd: int, data: bytes) -> None:
        """It wrote something."""
        if fd == 1 and self._on_output is not None:
            self._on_output(data)
        elif fd == 2:
            self._stderr = (self._stderr + data)[-_KEPT:]

    def pipe_connection_lost(self, fd: int, exc: Exception | None) -> None:
        """It closed one of its pipes."""
        if fd == 1:
            self._stdout_closed.set()
        elif fd == 2:
            self._stderr_closed.set()

    def process_exited(self) -> None:
        """It has ended."""
        self._exited.set()

    # -- for whoever started it ----------------------------------------------------------------

    @property
    def running(self) -> bool:
        """Whether it has not ended yet."""
        return not self._exited.is_set()

    @property
    def last_words(self) -> str:
        """The last line it wrote to stderr, or ''; with the list that it ends with, if it does, and
        what stands before that. Progress that overwrites itself counts once.
        """
        written = self._stderr.replace(b"\r", b"\n").decode("utf-8", "replace")
        lines = [line.rstrip() for line in written.split("\n") if line.strip()]
        items: list[str] = []
        while lines and lines[-1].lstrip().startswith("- "):
            items.insert(0, lines.pop().strip().removeprefix("- "))
        of_list = len(items) > 0 and len(lines) > 1 and lines[-1].endswith(":")
        said = [line.strip() for line in lines[-2 if of_list else -1 :]]
        return " ".join(["; ".join(said), ", ".join(items)]).strip()[:300]

    def send_text(self, text: str) -> None:
        """Give it `text` (UTF-8) on stdin and close that."""
        pipe = self._pipe(0)
        if isinstance(pipe, asyncio.WriteTransport):
            pipe.write(text.encode())
            pipe.close()

    def write(self, data: bytes) -> None:
        """Give it `data` on stdin, which stays open; nothing happens if it has ended."""
        pipe = self._pipe(0)
        if isinstance(pipe, asyncio.WriteTransport) and not pipe.is_closing():
            pipe.write(data)

    def hold(self, held: bool) -> None:
        """Stop fetching its output, or go on; a piece that was fetched already still arrives."""
        pipe = self._pipe(1)
        if isinstance(pipe, asyncio.ReadTransport) and not pipe.is_closing():
            if held:
                pipe.pause_reading()
            else:
                pipe.resume_reading()

    async def wait(self) -> int:
        """Its exit status, once it has ended and its last words have come; negative: the signal
        that ended it.
        """
        await self._exited.wait()
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(_LAST_WORDS_S):
                await self._stderr_closed.wait()
        return self._status()

    async def wait_or(self, event: asyncio.Event, seconds: float) -> int | None:
        """Its exit status if it ends before `event` is set and `seconds` have passed, else None."""
        tasks = [asyncio.ensure_future(self.wait()), asyncio.ensure_future(event.wait())]
        try:
            await asyncio.wait(tasks, timeout=seconds, return_when=asyncio.FIRST_COMPLETED)
            return self._status() if tasks[0].done() and not event.is_set() else None
        finally:
            for task in tasks:
                task.cancel()

    def reason(self, status: int) -> str:
        """Why it ended with this exit status: the last thing it said, or the status itself."""
        return self.last_words or f"exit status {status}"

    async def output_ended(self) -> bool:
        """Whether everything that it wrote to stdout has come; waits a moment for the rest. It has
        not while its output is held, or while something that it started may still write.
        """
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(_LAST_WORDS_S):
                await self._stdout_closed.wait()
        return self._stdout_closed.is_set()

    def kill(self) -> None:
        """End it and everything it started, at once."""
        assert self._transport is not None
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(self._transport.get_pid(), signal.SIGKILL)

    async def end(self) -> None:
        """Kill what is left of it and of its children, return when the system has removed it."""
        self.kill()
        assert self._transport is not None
        try:
            await self._exited.wait()
            guard.release(self._transport.get_pid())
        finally:
            self._transport.close()

    def _status(self) -> int:
        assert self._transport is not None
        status = self._transport.get_returncode()
        assert status is not None
        return status

    def _pipe(self, fd: int) -> asyncio.BaseTransport | None:
        assert self._transport is not None
        return self._transport.get_pipe_transport(fd)


async def start(
    words: Sequence[str],
    folder: Path,
    *,
    on_output: Callable[[bytes], None] | None = None,
    text: str | None = None,
    keeps_reading: bool = False,
    stdin: int | None = None,
    humble: bool = False,
    environment: Mapping[str, str] | None = None,
) -> Child:
    """Run a command in `folder`; `text` goes to its stdin. The caller must await `end()`.

    One that `keeps_reading` gets its input with `write`, or from the caller's descriptor `stdin`. A
    `humble` one gets the processor only
    when the robot does not need it. `environment` is added to ours.

    Raises `ProgramMissingError`, or `DriverError` if the system refuses to start it.
    """
    path = command_lines.find(words[0], folder)
    nothing = asyncio.subprocess.DEVNULL
    try:
        running, child = await asyncio.get_running_loop().subprocess_exec(
            lambda: Child(words[0], on_output),
            *_bound_to_us(),
            *(_humbly() if humble else ()),
            path,
            *words[1:],
            stdin=asyncio.subprocess.PIPE
            if keeps_reading or text is not None
            else stdin or nothing,
            stdout=nothing if on_output is None else asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.PIPE,
            cwd=folder,
            env={**os.environ, **(environment or {})},
            start_new_session=True,
        )
    except (OSError, ValueError) as error:
        raise DriverError(f"{words[0]} cannot be started: {error}") from error
    guard.watch(running.get_pid())
    if text is not None:
        child.send_text(text)
    return child


def temporary_folder() -> tempfile.TemporaryDirectory[str]:
    """A new folder for files of a child, as a context that deletes it. Raises `DriverError`."""
    with _there_is_place():
        return tempfile.TemporaryDirectory(prefix="woz-program-", ignore_cleanup_errors=True)


@contextlib.contextmanager
def temporary_file(name: str, content: bytes = b"") -> Iterator[Path]:
    """A new file for a child, in a folder of its own; both are deleted afterwards. Raises
    `DriverError`.
    """
    with temporary_folder() as folder:
        path = Path(folder) / name
        with _there_is_place():
            path.write_bytes(content)
        yield path


@contextlib.contextmanager
def _there_is_place() -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise DriverError(
            f"there is no place for temporary files: {error}",
            "free some space there, or set TMPDIR to another folder",
        ) from error


def _bound_to_us() -> tuple[str, ...]:
    """What makes the kernel kill the child with us (prctl PR_SET_PDEATHSIG), as a prefix.

    util-linux does it after the exec: Python code between fork and exec (`preexec_fn`) is not
    safe in a process with threads.
    """
    setpriv = shutil.which("setpriv")
    return (setpriv, "--pdeathsig", "KILL", "--") if setpriv is not None else ()


def _humbly() -> tuple[str, ...]:
    """What gives a child the lowest priority, as a prefix."""
    nice = shutil.which("nice")
    return (nice, "-n", "19") if nice is not None else ()


async def sound_cards(program: str, folder: Path) -> list[str]:
    """The sound cards that `aplay` or `arecord` lists. Raises `DriverError`."""
    listed = bytearray()
    running = await start((program, "-l"), folder, on_output=listed.extend)
    try:
        async with asyncio.timeout(_LIST_S):
            await running.wait()
    except TimeoutError:
        raise DriverError(f"{program} -l does not answer", "check the sound driver") from None
    finally:
        await running.end()
    lines = listed.decode("utf-8", "replace").splitlines()
    return [line for line in lines if line.startswith("card")]
