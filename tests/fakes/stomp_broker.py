"""A message broker that speaks STOMP 1.2 over TCP: topics, logins, and what goes wrong."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Self

from tests.fakes.ports import free_port


class StompBroker:
    """Hands each SEND to who has subscribed. `frames` are those that came, as they came.

    Attributes:
        passcode: Who gives another one is refused.
        silent: It answers nothing.
        heart_beat: What it says of its own and wants of ours, in milliseconds.
    """

    def __init__(self) -> None:
        self.frames: list[bytes] = []
        self.passcode = ""
        self.silent = False
        self.heart_beat = "0,0"
        self.port = free_port()
        self._server: asyncio.Server | None = None
        self._subscribers: dict[asyncio.StreamWriter, list[tuple[str, str]]] = {}
        self._answers: dict[str, Callable[[asyncio.StreamWriter, dict[str, str], bytes], None]] = {
            "CONNECT": self._connect,
            "SUBSCRIBE": self._subscribe,
            "SEND": self._send,
            "DISCONNECT": self._disconnect,
        }

    async def __aenter__(self) -> Self:
        await self.start()
        return self

    async def __aexit__(self, *failed: object) -> None:
        await self.stop()

    async def start(self) -> None:
        """Listen; at the same port as before."""
        self._server = await asyncio.start_server(
            self._serve, "127.0.0.1", self.port, limit=1 << 22
        )

    async def stop(self) -> None:
        """Break off all connections."""
        if self._server is not None:
            self._server.close()
        for writer in tuple(self._subscribers):
            writer.transport.abort()
        self._subscribers.clear()

    def publish(self, topic: str, text: str) -> None:
        """A message of a planner."""
        for writer, topics in self._subscribers.items():
            for ident, wanted in topics:
                if wanted == topic:
                    head = f"MESSAGE\nsubscription:{ident}\nmessage-id:1\ndestination:{topic}\n\n"
                    writer.write(head.encode() + text.encode() + b"\0")

    def sent(self, topic: str) -> list[str]:
        """Texts that clients sent to a topic."""
        return [
            body.decode()
            for command, headers, body in map(_read, self.frames)
            if command == "SEND" and headers["destination"] == topic
        ]

    @property
    def subscribed(self) -> bool:
        """Whether anybody listens."""
        return any(self._subscribers.values())

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._subscribers[writer] = []
        try:
            while True:
                frame = (await reader.readuntil(b"\0"))[:-1].lstrip(b"\n")
                self.frames.append(frame)
                if not self.silent:
                    command, headers, body = _read(frame)
                    self._answers[command](writer, headers, body)
        except (asyncio.IncompleteReadError, OSError, asyncio.CancelledError):
            pass
        finally:
            self._subscribers.pop(writer, None)
            writer.close()

    def _connect(self, writer: asyncio.StreamWriter, headers: dict[str, str], _: bytes) -> None:
        if headers.get("passcode", "") != self.passcode:
            writer.write(b"ERROR\nmessage:Bad CONNECT\n\nAccess refused for user 'me'\n\0")
            writer.close()
            return
        writer.write(f"CONNECTED\nversion:1.2\nheart-beat:{self.heart_beat}\n\n\0".encode())

    def _subscribe(self, writer: asyncio.StreamWriter, headers: dict[str, str], _: bytes) -> None:
        self._subscribers[writer].append((headers["id"], headers["destination"]))

    def _send(self, _: asyncio.StreamWriter, headers: dict[str, str], body: bytes) -> None:
        self.publish(headers["destination"], body.decode())

    def _disconnect(self, writer: asyncio.StreamWriter, headers: dict[str, str], _: bytes) -> None:
        writer.write(f"RECEIPT\nreceipt-id:{headers['receipt']}\n\n\0".encode())


def _read(frame: bytes) -> tuple[str, dict[str, str], bytes]:
    head, _, body = frame.partition(b"\n\n")
    command, *lines = head.decode().split("\n")
    return command, dict(line.split(":", 1) for line in lines), body
