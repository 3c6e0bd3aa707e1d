"""What tests of qi messaging have on their desk: another end's processes, scripts and services."""

from __future__ import annotations

import asyncio
import contextlib
import json
import sys
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping
from pathlib import Path
from typing import Any

from qimessaging import HostedMethod, HostedObject, HostedProperty, HostedSignal, QiServer
from qimessaging.frames import QiMessage, QiMessageReader

PATIENCE = 40.0


async def until(holds: Callable[[], bool]) -> None:
    """Wait for a condition, generously."""
    async with asyncio.timeout(PATIENCE):
        while not holds():  # noqa: ASYNC110 - of whatever the condition is made
            await asyncio.sleep(0.002)


class QiCaller:
    """The qi package as a client in another process; `do` is one line of `qi_caller.py`."""

    def __init__(self, process: asyncio.subprocess.Process) -> None:
        self._process = process

    @classmethod
    async def start(cls, script: Path, environment: Mapping[str, str]) -> QiCaller:
        process = await asyncio.create_subprocess_exec(
            sys.executable,
            str(script),
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE,
            env=environment,
            limit=16 << 20,
        )
        return cls(process)

    async def do(self, *what: Any) -> Any:
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write(json.dumps(what).encode() + b"\n")
        async with asyncio.timeout(PATIENCE):
            kind, value = json.loads(await self._process.stdout.readline())
        if kind == "error":
            raise RuntimeError(value)
        return value

    async def end(self) -> None:
        self._process.kill()
        await self._process.communicate()


class MessagingServer:
    """A server of ours with one service for each thing that is to be seen on the wire."""

    def __init__(self, server: QiServer | None = None) -> None:
        self.server = server or QiServer()
        self.entered: list[str] = []
        self.cancelled: list[str] = []
        self.children: list[HostedObject] = []
        self.service = self.server.add(
            "Thing",
            methods=[
                HostedMethod("say", "(s)", "s", lambda text: f"one {text}"),
                HostedMethod("say", "(ss)", "s", lambda text, language: f"two {text} {language}"),
                HostedMethod("kind", "(i)", "s", lambda _: "number"),
                HostedMethod("kind", "(s)", "s", lambda _: "text"),
                HostedMethod("kind", "([f])", "s", lambda _: "list"),
                HostedMethod(
                    "scaled", "([f]f)", "[f]", lambda values, by: [v * by for v in values]
                ),
                HostedMethod("echo", "(m)", "m", lambda value: value),
                HostedMethod("raw", "(r)", "r", lambda value: value),
                HostedMethod("fail", "()", "v", self._fail),
                HostedMethod("slow", "(f)", "s", self._slow),
                HostedMethod("entered", "()", "i", lambda: len(self.entered)),
                HostedMethod(
                    "fire", "(sf)", "v", lambda *values: self.service.emit("fired", *values)
                ),
                HostedMethod("child", "()", "o", self._child),
            ],
            signals=[HostedSignal("fired", "(sf)")],
            properties=[HostedProperty("level", "i", 3)],
        )

    def service_of_children(self) -> HostedObject:
        """Add a service whose only child is handed out to all; return the child."""
        only = self._child()
        self.server.add("Family", methods=[HostedMethod("child", "()", "o", lambda: only)])
        return only

    def _fail(self) -> None:
        raise ValueError("the joint ZörgYaw does not exist")

    async def _slow(self, seconds: float) -> str:
        self.entered.append("slow")
        try:
            await asyncio.sleep(seconds)
        except asyncio.CancelledError:
            self.cancelled.append("slow")
            raise
        return "at last"

    def _child(self) -> HostedObject:
        child = HostedObject(
            [
                HostedMethod("say", "(s)", "s", lambda text: f"child {text}"),
                HostedMethod("fire", "(s)", "v", lambda text: child.emit("signal", text)),
                HostedSignal("signal", "(s)"),
            ]
        )
        self.children.append(child)
        return child


@contextlib.asynccontextmanager
async def messaging_server() -> AsyncIterator[tuple[MessagingServer, int]]:
    """Such a server, listening, and its port."""
    server = MessagingServer()
    endpoint = await server.server.listen("127.0.0.1")
    yield server, endpoint.port
    await server.server.close()


@contextlib.asynccontextmanager
async def script(
    play: Callable[[asyncio.StreamReader, asyncio.StreamWriter], Awaitable[None]],
) -> AsyncIterator[int]:
    """A server that does with each connection what a test says; its port."""

    async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        with contextlib.suppress(ConnectionError, asyncio.IncompleteReadError):
            await play(reader, writer)
        writer.close()

    server = await asyncio.start_server(serve, "127.0.0.1", 0)
    yield server.sockets[0].getsockname()[1]
    server.close()


async def frames(reader: asyncio.StreamReader) -> AsyncIterator[QiMessage]:
    """The messages that come in."""
    puzzle = QiMessageReader()
    while data := await reader.read(1 << 16):
        for frame in puzzle.feed(data):
            yield frame


@contextlib.asynccontextmanager
async def between(
    port: int, greeted: Callable[[QiMessage, asyncio.StreamWriter], None]
) -> AsyncIterator[int]:
    """A connection's middle man, which keeps greetings from the server and answers itself."""

    async def play(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        back_reader, back_writer = await asyncio.open_connection("127.0.0.1", port)
        back = asyncio.create_task(_pump(back_reader, writer))
        try:
            async for frame in frames(reader):
                if frame.service == 0:
                    greeted(frame, writer)
                else:
                    back_writer.write(frame.encoded())
        finally:
            back.cancel()
            back_writer.close()

    async with script(play) as own:
        yield own


@contextlib.asynccontextmanager
async def answering(port: int, answer: Callable[[QiMessage], bytes]) -> AsyncIterator[int]:
    """A middle man who hands on what is asked, and what `answer` makes of each answer."""

    async def play(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        answers, calls = await asyncio.open_connection("127.0.0.1", port)

        async def ask() -> None:
            async for frame in frames(reader):
                calls.write(frame.encoded())
            calls.close()

        asking = asyncio.create_task(ask())
        async for frame in frames(answers):
            writer.write(answer(frame))
        await asking

    async with script(play) as own:
        yield own


async def _pump(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    while data := await reader.read(1 << 16):
        writer.write(data)
