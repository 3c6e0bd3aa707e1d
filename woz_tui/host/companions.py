"""Programs of features that run beside a session, each in a process of its own.

One that ends is started again. The session waits for none of them.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import shlex
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from woz_tui.protocol.messages import Notice
from woz_tui.protocol.sentence import Sentence
from woz_tui.system.retry_pauses import RetryPauses
from woz_tui.system.tasks import end_tasks
from woz_tui.system.text_cleaning import one_line

#: Pauses before one is started again, in seconds, and how long one that works runs at least.
_FIRST_PAUSE_S, _LONGEST_PAUSE_S, _WORKS_S = 1.0, 60.0, 10.0
#: How long it may take to end by itself when the session has ended, and then when it is told to, as
#: it removes what it has made; together less than the robot process has for it. In seconds.
_END_S, _TIDY_S = 1.0, 1.5
_MOST_TEXT = 400

log = logging.getLogger(__name__)


class Companions:
    """The programs beside one session, by the feature whose each is.

    Args:
        socket: The session's.
        publish: Takes what the wizard is to know.
    """

    def __init__(self, socket: Path, publish: Callable[[Notice], object]) -> None:
        self._socket = socket
        self._publish = publish
        self._running: dict[str, Companion] = {}
        #: Those that others have taken the place of; what they have must be free first.
        self._ending: dict[str, asyncio.Task[None]] = {}

    def adopt(self, commands: Mapping[str, str]) -> None:
        """From here on these run, each a command of `woz` with its options, and no others."""
        for name, runs in [*self._running.items()]:
            if commands.get(name) != runs.command:
                self._ending[name] = self._running.pop(name).end_soon()
        for name, command in commands.items():
            if name not in self._running:
                companion = Companion(command, self._socket, self._publish)
                self._running[name] = companion
                companion.start(self._ending.get(name))

    async def close(self) -> None:
        """The session has ended: they end, too."""
        await asyncio.gather(*(each.close() for each in self._running.values()))
        await asyncio.gather(*self._ending.values(), return_exceptions=True)
        self._running.clear()


class Companion:
    """One program, `woz COMMAND SOCKET` with the options that stand behind the command."""

    def __init__(self, command: str, socket: Path, publish: Callable[[Notice], object]) -> None:
        self.command = command
        name, *options = shlex.split(command)
        self._words: Sequence[str] = ("-P", "-m", "woz_tui", name, str(socket), *options)
        self._called = f"`woz {name}`"
        self._publish = publish
        self._process: asyncio.subprocess.Process | None = None
        self._task: asyncio.Task[None] | None = None
        self._last_words = ""

    def start(self, before: asyncio.Task[None] | None = None) -> None:
        """Begin, once that which was there `before` has ended; it is kept running."""
        self._task = asyncio.get_running_loop().create_task(self._keep_running(before))

    def end_soon(self) -> asyncio.Task[None]:
        """Have it end; what is done when it has."""
        assert self._task is not None
        self._task.cancel()
        return self._task

    async def close(self) -> None:
        """It ends with its session, or is ended."""
        process = self._process
        if process is not None:
            with contextlib.suppress(TimeoutError):
                async with asyncio.timeout(_END_S):
                    await process.wait()
        await end_tasks(self._task)

    async def _keep_running(self, before: asyncio.Task[None] | None) -> None:
        if before is not None:
            await asyncio.wait([before])
        pauses = RetryPauses(_FIRST_PAUSE_S, _LONGEST_PAUSE_S)
        while True:
            began = time.monotonic()
            try:
                said = await self._run_once()
            except OSError as error:
                said = str(error)
            if self._process is not None and self._process.returncode == 0:
                return  # its session has ended
            works = time.monotonic() - began >= _WORKS_S
            if works or said != self._last_words:
                self._last_words = said
                called = self._called
                text = Sentence("host.not_running", "{program} does not run", program=called)
                if works:
                    text = Sentence(
                        "host.started_again",
                        "{program} has ended and is started again",
                        program=called,
                    )
                if said:
                    text = Sentence("session.said_of", "{who}: {what}", who=text, what=said)
                self._publish(Notice(level="warning", text=text))
            await asyncio.sleep(pauses.after(works))

    async def _run_once(self) -> str:
        """Until it ends; what it said for people last, or at all: libraries write there, too."""
        self._process = process = await asyncio.create_subprocess_exec(
            sys.executable,
            *self._words,
            stdin=asyncio.subprocess.DEVNULL,
            stdout=asyncio.subprocess.DEVNULL,
            stderr=asyncio.subprocess.PIPE,
        )
        said = for_people = ""
        try:
            assert process.stderr is not None
            async for line in process.stderr:
                said = one_line(line.decode(errors="replace").strip())[:_MOST_TEXT]
                log.info("%s: %s", self._called, said)
                for_people = said if said.startswith("woz: ") else for_people
            await process.wait()
        finally:
            if process.returncode is None:
                process.terminate()
                try:
                    with contextlib.suppress(TimeoutError):
                        async with asyncio.timeout(_TIDY_S):
                            await process.wait()
                finally:
                    if process.returncode is None:
                        process.kill()  # it stands still
                        await process.wait()
        return (for_people or said).removeprefix("woz: ")
