"""A browser with the page of a `browser-screen`: it speaks its wire, and paints nothing."""

from __future__ import annotations

import asyncio
import contextlib
import json
from typing import Any

import aiohttp

#: Seconds after which it looks for a server that is not there yet.
_AGAIN_S = 0.05


class ScreenBrowser:
    """Opens an address, and says that it has painted whatever it is told to show.

    Args:
        address: Of the page, with `/` at its end.
        error: What it says instead; empty: it has painted.
        silent: It never says anything.
    """

    def __init__(self, address: str, *, error: str = "", silent: bool = False) -> None:
        self.address = address
        self.error, self.silent = error, silent
        #: What it was told, and of pictures what they hold.
        self.told: list[dict[str, Any]] = []
        self.pictures: list[bytes] = []
        #: How often it was turned away.
        self.refused = 0
        self._task: asyncio.Task[None] | None = None

    def open(self) -> None:
        """Begin, and look for the page until it is there."""
        self._task = asyncio.get_running_loop().create_task(self._run())

    async def close(self) -> None:
        """Close its window."""
        if self._task is not None:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)

    async def _run(self) -> None:
        async with aiohttp.ClientSession() as http:
            while True:
                with contextlib.suppress(aiohttp.ClientError):
                    await self._follow(http)
                await asyncio.sleep(_AGAIN_S)

    async def _follow(self, http: aiohttp.ClientSession) -> None:
        async with http.get(f"{self.address}news") as stream:
            if stream.status != 200:
                self.refused += 1
                return
            async for line in stream.content:
                if line.startswith(b"data: "):
                    await self._show(http, json.loads(line.removeprefix(b"data: ")))

    async def _show(self, http: aiohttp.ClientSession, told: dict[str, Any]) -> None:
        self.told.append(told)
        if told["kind"] == "picture":
            async with http.get(f"{self.address}picture/{told['number']}") as picture:
                self.pictures.append(await picture.read())
        if self.silent:
            return
        origin = "/".join(self.address.split("/")[:3])
        said = json.dumps({"number": told["number"], "after": 32.04, "error": self.error})
        async with http.post(
            f"{self.address}painted", data=said, headers={"Origin": origin}
        ) as answer:
            assert answer.status == 204
