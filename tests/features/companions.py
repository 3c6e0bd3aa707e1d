"""A program that runs beside a session as long as it lasts, because the file asks for it."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from pathlib import Path
from typing import TypeVar

import psutil

from tests.config.reading import HEAD, HELLO, panel
from woz_tui.client import connect
from woz_tui.console.link.host_start import Launch, RobotProcess
from woz_tui.protocol.messages import Message
from woz_tui.protocol.requests import AskEnd

Kind = TypeVar("Kind", bound=Message)


def launched(folder: Path, section: str) -> RobotProcess:
    """The session of the file `study.yaml` with this section."""
    file = folder / "study.yaml"
    file.write_text(panel(HELLO, head=f"{HEAD}{section}\n"))
    return Launch([str(file), "--recordings", str(folder / "recordings")]).wait()


async def next_of(messages: AsyncIterator[Message], kind: type[Kind]) -> Kind:
    """The next message of this kind."""
    async with asyncio.timeout(60):
        async for message in messages:
            if isinstance(message, kind):
                return message
    raise AssertionError("the session has ended")


def companion(host: RobotProcess, command: str) -> psutil.Process:
    """The process of `woz` with this command."""
    children = psutil.Process(host.pid).children()
    (found,) = [each for each in children if command in each.cmdline()]
    return found


async def is_kept_running(
    host: RobotProcess, command: str, there: type[Message], gone: type[Message]
) -> None:
    """It runs with the session, is started again when it was killed, and ends with the session."""
    async with connect(host.socket) as woz:
        messages = woz.messages(there, gone, held=True)
        await next_of(messages, there)
        companion(host, command).kill()
        await next_of(messages, gone)
        await next_of(messages, there)
        last = companion(host, command)
        await woz.request(AskEnd())
    await asyncio.to_thread(last.wait, 20)
