"""A process of ours that is spoken with over a line, and begun anew whenever it ends.

Its output goes to the program's log. It ends with us: its line ends, and if it does not see that, a
thread of it does.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import logging
import os
import select
import signal
import socket
import sys
import threading
import time
import traceback
from collections.abc import Callable, Coroutine
from typing import Any, NoReturn, TypeVar

from woz_tui.network.driver_line import LineError
from woz_tui.network.stream_line import Sort, StreamLine
from woz_tui.system.retry_pauses import RetryPauses
from woz_tui.system.tasks import end_tasks, until_first_ends

#: Pauses before it is begun anew, in seconds.
FIRST_PAUSE_S, LONGEST_PAUSE_S = 0.2, 10.0
#: How long it may take to end when its line has ended, in seconds.
END_S = 2.0
#: How long is waited for the word why it has ended, in seconds.
_WHY_S = 0.5
#: How much of a line of its output is logged.
_LONGEST = 1000

#: Where its output is.
IN_PROGRAM_LOG = "see the log of the robot process (its name ends in .host.log)"

log = logging.getLogger(__name__)


class ChildLine(StreamLine):
    """The line to a process that runs `python -m MODULE`, which calls `serve_parent`.

    Args:
        module: Its module.
        setup: What it is told first.
        name: What it is called in the log.
    """

    def __init__(self, module: str, setup: bytes, name: str) -> None:
        super().__init__()
        self._module = module
        self._setup = setup
        self._name = name
        self._process: asyncio.subprocess.Process | None = None
        self._begun: asyncio.Future[None] | None = None
        self._task: asyncio.Task[None] | None = None
        self._last_words = self._killed_for = ""
        #: What has become of it last, such as `was ended by SIGKILL`.
        self.why = ""
        #: When the process that runs now spoke last, on the loop's clock; 0: it has not begun.
        self.heard = 0.0

    @property
    def pid(self) -> int:
        """Of the process that runs now, or ran last; 0: none."""
        return 0 if self._process is None else self._process.pid

    async def begin(self) -> None:
        """Start it, and return when it has begun. Raises `LineError`, with why it has not."""
        self._begun = asyncio.get_running_loop().create_future()
        self._task = asyncio.get_running_loop().create_task(self._keep(), name=self._name)
        try:
            await self._begun
        except BaseException:
            await self.close()
            raise

    async def close(self) -> None:
        """End it, without a word if it does not hear."""
        task, self._task = self._task, None
        self.end()
        if task is not None and self._process is not None:
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(self._process.wait(), END_S)
        await end_tasks(task)

    def kill(self, why: str = "") -> None:
        """End it without a word, and what it has started; it is begun anew. `why` is told."""
        self._killed_for = why
        if self._process is not None and self._process.returncode is None:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(self._process.pid, signal.SIGKILL)

    async def _keep(self) -> None:
        pauses = RetryPauses(FIRST_PAUSE_S, LONGEST_PAUSE_S)
        while True:
            since = time.monotonic()
            try:
                await self._once()
            except OSError as error:
                self.why = f"cannot be started: {error}"
            if self._task is None:
                return
            self._fail(
                f"{self._name} {self.why}",
                IN_PROGRAM_LOG,
            )
            self.nobody_is_there()
            log.error("%s %s", self._name, self.why)
            await asyncio.sleep(pauses.after(time.monotonic() - since > LONGEST_PAUSE_S))

    async def _once(self) -> None:
        ours, theirs = socket.socketpair()
        try:
            self._process = process = await asyncio.create_subprocess_exec(
                *(sys.executable, "-u", "-P", "-m", self._module, str(theirs.fileno())),
                stdin=asyncio.subprocess.DEVNULL,
                stdout=asyncio.subprocess.PIPE,
                stderr=asyncio.subprocess.STDOUT,
                pass_fds=[theirs.fileno()],
                start_new_session=True,
            )
        except OSError:
            ours.close()
            raise
        finally:
            theirs.close()
        assert process.stdout is not None
        self._last_words = self._killed_for = ""
        self.heard = 0.0
        reading = asyncio.create_task(self._read_output(process.stdout))
        try:
            await self.attach(ours)
            self.put(Sort.SETUP, json.dumps(sys.path), self._setup)
            await self.ended()
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(process.wait(), _WHY_S)
            self.why = self._why(process.returncode)
        finally:
            self.end()
            self.kill()
            await end_tasks(reading)
            await process.wait()

    def _why(self, status: int | None) -> str:
        said = f": {self._last_words}" if self._last_words else ""
        if self._killed_for:
            return self._killed_for
        if status is None:
            return "does not speak any more"
        if status < 0:
            return f"was ended by {signal.Signals(-status).name}"
        return f"has ended with status {status}{said}"

    async def _read_output(self, output: asyncio.StreamReader) -> None:
        while True:
            try:
                line = await output.readline()
            except ValueError:  # a line without an end
                continue
            if not line:
                return
            self._last_words = line.decode("utf-8", "replace").strip()[:_LONGEST]
            log.warning("%s: %s", self._name, self._last_words)

    def take(self, sort: Sort, key: str, payload: bytes) -> None:
        """Also how it has begun."""
        self.heard = asyncio.get_running_loop().time()
        match sort:
            case Sort.BEGUN:
                self.tell_interests()
                if self._begun is not None and not self._begun.done():
                    self._begun.set_result(None)
            case Sort.FAILED:
                self._fail(key, payload.decode("utf-8", "replace"))
            case _:
                super().take(sort, key, payload)

    def _fail(self, why: str, remedy: str) -> None:
        if self._begun is not None and not self._begun.done():
            self._begun.set_exception(LineError(why, remedy))


# -- in that process -------------------------------------------------------------------------------


class ParentLine(StreamLine):
    """The other end of the line."""

    def __init__(self) -> None:
        super().__init__()
        #: Where modules are found, and what the process is told first.
        self.setup: asyncio.Future[tuple[str, bytes]] = asyncio.get_running_loop().create_future()

    def begun(self) -> None:
        """Say that the process does its work."""
        self.put(Sort.BEGUN, "")

    def take(self, sort: Sort, key: str, payload: bytes) -> None:
        """Also what it is told first."""
        if sort is Sort.SETUP:
            self.setup.set_result((key, payload))
        else:
            super().take(sort, key, payload)


_Line = TypeVar("_Line", bound=ParentLine)
#: Is given what the process is told first, calls `begun`, and speaks over the line until that ends.
#: Raises `LineError` if it cannot begin.
Serve = Callable[[bytes, _Line], Coroutine[Any, Any, None]]


def serve_parent(serve: Serve[_Line], line: type[_Line]) -> NoReturn:
    """Be the process of a `ChildLine` until its line ends."""
    for number in (signal.SIGINT, signal.SIGHUP):  # of the terminal: the parent decides
        signal.signal(number, signal.SIG_IGN)
    connected = socket.socket(fileno=int(sys.argv[1]))
    connected.set_inheritable(False)
    leaving = threading.Thread(target=_leave_after, args=(connected.fileno(),), daemon=True)
    leaving.start()
    status = 1
    try:
        asyncio.run(_serve(serve, line, connected))
        status = 0
    except Exception:  # noqa: BLE001 - whatever a driver's module raises
        traceback.print_exc()
    finally:
        sys.stderr.flush()
        os._exit(status)  # whatever threads are left


async def _serve(serve: Serve[_Line], line: type[_Line], connected: socket.socket) -> None:
    parent = line()
    await parent.attach(connected)
    path, setup = await parent.setup
    sys.path[:] = json.loads(path)
    try:
        await until_first_ends(serve(setup, parent), _nobody_reads(parent))
    except LineError as error:
        parent.put(Sort.FAILED, str(error), error.remedy.encode())
        parent.end()
        await parent.ended()


async def _nobody_reads(parent: ParentLine) -> None:
    """Return when the line is over. What is printed from then on raises nothing."""
    await parent.ended()
    null = os.open(os.devnull, os.O_WRONLY)
    for number in (1, 2):
        os.dup2(null, number)


def _leave_after(line: int) -> None:
    """A loop that blocks does not keep the process when its parent is gone."""
    poll = select.poll()
    poll.register(line, select.POLLRDHUP)
    while not any(events & (select.POLLRDHUP | select.POLLHUP) for _, events in poll.poll()):
        pass
    time.sleep(END_S + 1)
    os._exit(1)
