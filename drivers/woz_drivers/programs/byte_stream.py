"""The bytes that a command writes all the time: started again whenever it ends or falls silent."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from woz_drivers.programs import child_process
from woz_drivers.programs.child_process import Child, RestartPauses
from woz_tui.drivers.contract import DriverError
from woz_tui.system.clock import Clock
from woz_tui.system.tasks import end_tasks

#: A command that writes nothing is told of, and later ended and started again, in seconds; the
#: first output may take longer, because cameras start slowly and ssh needs time to connect.
_STALE_S = 1.0
_STUCK_S = 5.0
_STUCK_AT_FIRST_S = 20.0
_LOOK_S = 0.1


@dataclass(frozen=True, slots=True)
class StreamCommand:
    """What is run in `folder`, and how it is talked about.

    Attributes:
        nothing: What it delivers while it is silent, such as "no sound".
        remedy: What to do when it ended or had to be given up.
        least: It has begun to deliver once so many bytes of a run have come.
        advise: What to do about the words with which it ended; empty: `remedy`.
        fed: It reads what is written to it, and answers: its silence counts from the first of what
            it has not answered.
        name: What it is called in sentences; without one, as its program.
    """

    words: tuple[str, ...]
    folder: Path
    nothing: str
    remedy: str
    least: int = 1
    advise: Callable[[str], str] | None = None
    fed: bool = False
    name: str = ""

    @property
    def title(self) -> str:
        """What it is called."""
        return self.name or self.words[0]


@dataclass(frozen=True, slots=True)
class StreamListener:
    """Who is told, in the event loop: a new run begins, output, silence, why a run ended, and that
    a run can be written to.
    """

    begun: Callable[[], None]
    output: Callable[[bytes], None]
    silent: Callable[[str], None]
    ended: Callable[[DriverError], None]
    writable: Callable[[], None] = lambda: None


class ChunkCutter:
    """Cuts a stream of bytes, however it is split, into chunks of `size` bytes."""

    def __init__(self, size: int, on_chunk: Callable[[bytes], None]) -> None:
        self._size = size
        self._on_chunk = on_chunk
        self._rest = bytearray()

    def feed(self, data: bytes) -> None:
        """Call `on_chunk` for every chunk that `data` completes."""
        self._rest += data
        end = len(self._rest) // self._size * self._size
        for start in range(0, end, self._size):
            self._on_chunk(bytes(self._rest[start : start + self._size]))
        del self._rest[:end]


class ByteStream:
    """Keeps one command running between `start` and `close`."""

    def __init__(self, command: StreamCommand, clock: Clock, listener: StreamListener) -> None:
        self._command = command
        self._clock = clock
        self._listener = listener
        self._child: Child | None = None
        self._held = self._owes = False
        self._bytes = 0
        self._started_us = self._received_us = 0
        self._task: asyncio.Task[None] | None = None

    @property
    def running(self) -> bool:
        """Whether the command runs."""
        return self._child is not None

    @property
    def lasted_us(self) -> int:
        """How long after the start of its latest run something came last, in microseconds."""
        return self._received_us - self._started_us

    def start(self) -> None:
        """Start the command."""
        self._task = asyncio.create_task(self._keep_running())

    async def close(self) -> None:
        """End it and everything it started."""
        await end_tasks(self._task)
        self._task = None

    def write(self, data: bytes) -> None:
        """Give a command that is `fed` some data; lost while it does not run."""
        if self._child is not None:
            self._child.write(data)
            if not self._owes:
                self._owes = True
                self._received_us = self._clock.now_us()

    def hold(self, held: bool) -> None:
        """Stop fetching its output, or go on; its silence counts from when it goes on."""
        if self._child is not None:
            self._held = held
            self._child.hold(held)
            self._received_us = self._clock.now_us()

    async def _keep_running(self) -> None:
        pauses = RestartPauses()
        while True:
            try:
                trouble = await self._run()
            except DriverError as error:
                trouble = error
            self._listener.ended(trouble)
            await asyncio.sleep(pauses.after_run(self.lasted_us / 1_000_000))

    async def _run(self) -> DriverError:
        """Run the command until it ends; returns why it did. Raises if it cannot be started."""
        command = self._command
        program = command.title
        self._listener.begun()
        self._held, self._owes = False, not command.fed
        self._bytes = 0
        self._started_us = self._received_us = self._clock.now_us()
        running = await child_process.start(
            command.words, command.folder, on_output=self._received, keeps_reading=command.fed
        )
        self._child = running
        self._listener.writable()
        try:
            stuck = await self._until_end(running)
        finally:
            self._child = None
            await running.end()
        if stuck:
            return DriverError(f"{program} ran, but delivered {command.nothing}", command.remedy)
        status = await running.wait()
        reason = running.reason(status)
        advice = command.advise(reason) if command.advise is not None else ""
        return DriverError(f"{program} ended: {reason}", advice or command.remedy)

    async def _until_end(self, running: Child) -> bool:
        """Whether it had to be given up because nothing came."""
        waiting = asyncio.ensure_future(self._end(running))
        try:
            while not waiting.done():
                await asyncio.wait([waiting], timeout=_LOOK_S)
                if self._held or not self._owes:
                    continue
                silence_us = self._clock.now_us() - self._received_us
                if silence_us >= self._patience_s * 1_000_000:
                    return not waiting.done()
                if silence_us >= _STALE_S * 1_000_000:
                    self._listener.silent(f"{self._command.title} delivers {self._command.nothing}")
        finally:
            waiting.cancel()
        return False

    async def _end(self, running: Child) -> None:
        """Return when it has ended and what it wrote has been fetched, however long that is held:
        what is in the pipe is the end of a recording.
        """
        await running.wait()
        while not await running.output_ended() and self._held:
            pass

    @property
    def _patience_s(self) -> float:
        """How long it may be silent now."""
        return _STUCK_S if self._bytes >= self._command.least else _STUCK_AT_FIRST_S

    def _received(self, data: bytes) -> None:
        self._bytes += len(data)
        self._received_us = self._clock.now_us()
        self._owes = not self._command.fed
        self._listener.output(data)
