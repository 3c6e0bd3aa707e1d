"""Other machines may join the session: starts the process that lets them in, and keeps it."""

from __future__ import annotations

import asyncio
import contextlib
import json
import logging
import sys
from collections.abc import Callable, Mapping
from pathlib import Path

from woz_tui.protocol.messages import Notice
from woz_tui.protocol.sentence import Sentence
from woz_tui.system.retry_pauses import RetryPauses
from woz_tui.system.tasks import end_tasks

#: Pauses before it is started again, in seconds.
_FIRST_PAUSE_S, _LONGEST_PAUSE_S = 0.5, 8.0
#: How long it may take to end, in seconds.
_END_S = 2.0

log = logging.getLogger(__name__)


class RemoteAccess:
    """The process that listens for other machines.

    Args:
        socket: The session's.
        address: Where it listens.
        publish: Takes what the wizard is to know.
    """

    def __init__(self, socket: Path, address: str, publish: Callable[[Notice], object]) -> None:
        self._socket = socket
        self._address = address
        self._publish = publish
        self._roles: Mapping[str, str] = {}
        self._process: asyncio.subprocess.Process | None = None
        self._task: asyncio.Task[None] | None = None
        #: Where it listens, and why it cannot; either is told once.
        self._listening = self._trouble = ""

    def start(self, roles: Mapping[str, str]) -> None:
        """Begin; `roles`: name -> role."""
        self._roles = roles
        self._task = asyncio.get_running_loop().create_task(self._keep_running())

    def adopt(self, roles: Mapping[str, str]) -> None:
        """The experiment says so from now on."""
        if self._roles != roles:
            self._roles = roles
            self._send_roles()

    async def close(self) -> None:
        """Let nobody in any more."""
        task, self._task = self._task, None
        await end_tasks(task)
        if self._process is not None:
            await _end_process(self._process)

    def kill(self) -> None:
        """End the process without a word, as a crash does; it is started again."""
        if self._process is not None:
            self._process.kill()

    async def _keep_running(self) -> None:
        pauses = RetryPauses(_FIRST_PAUSE_S, _LONGEST_PAUSE_S)
        while True:
            self._listening = ""
            with contextlib.suppress(OSError):
                await self._run_once()
            if self._listening:
                self._tell(
                    "warning",
                    Sentence(
                        "host.access_ended",
                        "Access from other machines has ended; it is started again",
                    ),
                )
            await asyncio.sleep(pauses.after(bool(self._listening)))

    async def _run_once(self) -> None:
        self._process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-P", "-m", "woz_tui.remote.access_server"),
            *("--session", str(self._socket), "--listen", self._address),
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE,
        )
        try:
            self._send_roles()
            assert self._process.stdout is not None
            while line := await self._process.stdout.readline():
                self._on_line(line)
        finally:
            await _end_process(self._process)

    def _send_roles(self) -> None:
        if self._process is not None and self._process.stdin is not None:
            with contextlib.suppress(OSError, RuntimeError):
                self._process.stdin.write(json.dumps({"roles": {**self._roles}}).encode() + b"\n")

    def _on_line(self, line: bytes) -> None:
        try:
            announced: dict[str, str] = json.loads(line)
        except ValueError:
            log.warning("the process for other machines wrote %r", line[:200])
            return
        if listening := announced.get("listening"):
            self._listening, self._trouble = listening, ""
            host, _, port = listening.rpartition(":")
            everywhere = host in ("0.0.0.0", "[::]")
            text = Sentence(
                "host.join_at", "Other machines can join at {address}", address=listening
            )
            if everywhere:
                text = Sentence(
                    "host.join_by_port",
                    "Other machines can join at port {port} of this computer",
                    port=port,
                )
            self._tell("info", text)
        elif refused := announced.get("refused"):
            self._tell(
                "warning",
                Sentence(
                    "host.not_let_in",
                    "Somebody from another machine was not let in: {refused}",
                    refused=refused,
                ),
            )
        elif (trouble := announced.get("trouble", "")) != self._trouble:
            self._trouble = trouble
            self._tell(
                "error",
                Sentence(
                    "host.cannot_join",
                    "Other machines cannot join at {address}: {trouble}",
                    address=self._address,
                    trouble=trouble,
                ),
            )

    def _tell(self, level: str, text: str) -> None:
        self._publish(Notice(level=level, text=text))


async def _end_process(process: asyncio.subprocess.Process) -> None:
    if process.returncode is not None:
        return
    if process.stdin is not None:
        process.stdin.close()
    try:
        async with asyncio.timeout(_END_S):
            await process.wait()
    except TimeoutError:
        process.kill()
        await process.wait()
