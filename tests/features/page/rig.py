"""Pages of a served session, and browsers without a window that read them."""

from __future__ import annotations

import asyncio
import json
import ssl
from collections.abc import AsyncIterator, Callable, Collection, Sequence
from contextlib import AsyncExitStack, asynccontextmanager
from typing import Any, Self

import aiohttp

from tests.host.rig import ServedSession
from tests.session.rig import WAIT_S
from woz_tui.features.page.server import PageServer
from woz_tui.features.page.visitors import PageRole
from woz_tui.network.listen_address import ListenAddress
from woz_tui.system.clock import Clock

Holds = Callable[[dict[str, Any]], object]


class Reader:
    """A stream of news, and what the page shows by it."""

    def __init__(self, response: aiohttp.ClientResponse) -> None:
        self.response = response
        self.view: dict[str, Any] = {}
        self.updates = 0

    async def more(self) -> None:
        """Read one update."""
        line = b""
        while not line.startswith(b"data: "):
            line = await asyncio.wait_for(self.response.content.readline(), WAIT_S)
            assert line, f"the stream ended; seen {self.view}"
        self.view |= json.loads(line.removeprefix(b"data: "))
        self.updates += 1

    async def until(self, holds: Holds) -> dict[str, Any]:
        """Read until the view fits."""
        while not (self.view and holds(self.view)):
            await self.more()
        return self.view


class WebBrowser:
    """A browser with its cookies, that sends the headers that browsers send."""

    def __init__(self, http: aiohttp.ClientSession, here: str) -> None:
        self.http = http
        self.here = here

    async def get(self, path: str, **headers: str) -> tuple[int, str]:
        """Status and text of a page."""
        async with self.http.get(self.here + path, headers=headers) as response:
            return response.status, await response.text()

    async def post(self, path: str, origin: str | None = "", **fields: str) -> tuple[int, str]:
        """Send a form, from a page of our own unless an origin is given (None: without any);
        status and text of the page to which that leads.
        """
        headers = {} if origin is None else {"Origin": origin or self.here}
        async with self.http.post(self.here + path, data=fields, headers=headers) as response:
            return response.status, await response.text()

    async def join(self, code: str) -> Self:
        """Open the address with this code."""
        status, _ = await self.get(f"/join/{code}")
        assert status == 200
        return self

    @asynccontextmanager
    async def news(self, path: str) -> AsyncIterator[Reader]:
        """The stream of a page."""
        headers = {"Sec-Fetch-Site": "same-origin"}
        async with self.http.get(self.here + path, headers=headers) as response:
            assert response.status == 200, await response.text()
            yield Reader(response)


class PageRig:
    """A server of pages, and whoever opens them."""

    def __init__(
        self, server: PageServer, host: str, port: int, stack: AsyncExitStack, scheme: str = "http"
    ) -> None:
        self.server = server
        self.port = port
        self.here = f"{scheme}://{host}:{port}"
        self._stack = stack

    async def stranger(self, here: str = "") -> WebBrowser:
        """A browser that nobody has let in."""
        jar = aiohttp.CookieJar(unsafe=True)  # from addresses, too
        http = await self._stack.enter_async_context(aiohttp.ClientSession(cookie_jar=jar))
        return WebBrowser(http, here or self.here)

    async def watcher(self) -> WebBrowser:
        """A browser that watches."""
        return await (await self.stranger()).join(self.server.visitors.codes[PageRole.WATCH])

    async def participant(self) -> WebBrowser:
        """A browser in which somebody answers."""
        return await (await self.stranger()).join(self.server.visitors.codes[PageRole.ANSWER])


@asynccontextmanager
async def pages(
    session: ServedSession,
    names: tuple[str, ...] = (),
    told: list[str] | None = None,
    clock: Clock | None = None,
    *,
    debrief: bool = False,
    roles: Collection[PageRole] = tuple(PageRole),
    begins: str = "",
    tls: ssl.SSLContext | None = None,
    cameras: Sequence[str] = (),
) -> AsyncIterator[PageRig]:
    """Pages of this session until the block ends."""
    tell = (told if told is not None else []).append
    server = PageServer(
        session.path,
        names,
        tell,
        clock=clock,
        debrief=debrief,
        roles=roles,
        begins=begins,
        cameras=cameras,
    )
    async with AsyncExitStack() as stack:
        host, port = await server.start(ListenAddress("127.0.0.1", 0), tls)
        stack.push_async_callback(server.close)
        yield PageRig(server, host, port, stack, "http" if tls is None else "https")
