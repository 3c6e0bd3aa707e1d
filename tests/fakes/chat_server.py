"""A server of chat completions that answers as it is told, or fails as it is told."""

from __future__ import annotations

import asyncio
import json
import socket
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

from aiohttp import web

#: What it can do wrong; `503` beside: it says that it is not ready yet.
FAULTS = ("cut", "hang", "429", "500", "slow", "megabyte", "no done", "wrong json", "list", "empty")


class ChatServer:
    """Requests that came are in `asked`; `fault`: what it does wrong now; empty: nothing."""

    def __init__(self) -> None:
        self.asked: list[dict[str, Any]] = []
        self.keys: list[str] = []
        self.fault, self.text = "", "It is a whale.\nIt is thirty metres long."
        self.released = asyncio.Event()
        self.url = ""

    async def answer(self, request: web.Request) -> web.StreamResponse:
        self.asked.append(await request.json())
        self.keys.append(request.headers.get("Authorization", ""))
        if self.fault in ("429", "500", "503"):
            return web.Response(status=int(self.fault))
        if self.fault == "hang":
            await self.released.wait()
        response = web.StreamResponse(headers={"Content-Type": "text/event-stream"})
        await response.prepare(request)
        if self.fault == "slow":
            await self.released.wait()
        if self.fault == "megabyte":
            await self._send(response, "x" * (1 << 20))
        elif self.fault == "wrong json":
            await response.write(b"data: {nonsense\n\n")
        elif self.fault == "list":
            await response.write(b"data: [1, 2]\n\n")
        elif self.fault == "cut":
            await self._send(response, self.text[:5])
            assert request.transport is not None
            request.transport.get_extra_info("socket").shutdown(socket.SHUT_RDWR)
            return response
        elif self.fault != "empty":
            for piece in (self.text[:5], self.text[5:]):
                await self._send(response, piece)
        if self.fault != "no done":
            await response.write(b"data: [DONE]\n\n")
        await response.write_eof()
        return response

    async def _send(self, response: web.StreamResponse, text: str) -> None:
        piece = {
            "model": "small-q4",
            "system_fingerprint": "fp1",
            "choices": [{"delta": {"content": text}}],
        }
        await response.write(f"data: {json.dumps(piece)}\n\n".encode())


@asynccontextmanager
async def chat_server() -> AsyncIterator[ChatServer]:
    """One that serves until the block ends."""
    server = ChatServer()
    app = web.Application()
    app.router.add_post("/v1/chat/completions", server.answer)
    runner = web.AppRunner(app, shutdown_timeout=0.1)
    await runner.setup()
    site = web.TCPSite(runner, "127.0.0.1", 0)
    await site.start()
    host, port = runner.addresses[0][:2]
    server.url = f"http://{host}:{port}/v1"
    try:
        yield server
    finally:
        server.released.set()
        await runner.cleanup()
