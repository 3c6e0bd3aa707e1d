"""News for pages that are open: a stream of server-sent events for each."""

from __future__ import annotations

import asyncio
import contextlib
import json
from collections.abc import Awaitable
from typing import Any

from aiohttp import web

#: Seconds after which a stream that has nothing to say says that it lives, and after which a
#: browser that takes nothing is given up.
_ALIVE_S, _STUCK_S = 15.0, 30.0
#: Milliseconds after which a browser looks for a lost stream again.
_RETRY_MS = 2000


class News:
    """What pages show at the moment, by the names of its parts."""

    def __init__(self) -> None:
        self.now: dict[str, Any] = {}
        self.closed = False
        #: Streams that follow it.
        self.readers = 0
        self._changed = asyncio.Event()

    def publish(self, now: dict[str, Any]) -> None:
        """From now on this holds."""
        if now != self.now:
            self.now = now
            self._wake()

    def close(self) -> None:
        """End all streams."""
        self.closed = True
        self._wake()

    def _wake(self) -> None:
        changed, self._changed = self._changed, asyncio.Event()
        changed.set()

    async def stream(self, request: web.Request) -> web.StreamResponse:
        """All parts at first, then those that are new. Whoever reads slowly gets the newest; what
        was between is kept for nobody.
        """
        response = web.StreamResponse(headers={"Content-Type": "text/event-stream"})
        self.readers += 1
        try:
            await response.prepare(request)
            await response.write(f"retry: {_RETRY_MS}\n\n".encode())
            shown: dict[str, Any] = {}
            while not self.closed:
                changed = self._changed
                parts = {name: told for name, told in self.now.items() if shown.get(name) != told}
                shown = self.now
                line = f"data: {json.dumps(parts)}\n\n" if parts else ": nothing new\n\n"
                async with asyncio.timeout(_STUCK_S):
                    await response.write(line.encode())
                await within(_ALIVE_S, changed.wait())
        except (ConnectionError, TimeoutError):
            pass  # it has left, or is stuck: it comes again by itself
        finally:
            self.readers -= 1
        return response


async def within(seconds: float, waited: Awaitable[Any]) -> None:
    """Wait for something, but not longer."""
    with contextlib.suppress(TimeoutError):
        async with asyncio.timeout(seconds):
            await waited
