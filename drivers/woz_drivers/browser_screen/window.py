"""The page that a browser has open, and the way to it: news by server-sent events, and back a word
when it has painted.
"""

from __future__ import annotations

import asyncio
import itertools
import json
import mimetypes
import secrets
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path
from typing import Any

from aiohttp import web

from woz_drivers.browser_screen.settings import BrowserScreenSettings

_ASSETS = files("woz_drivers.browser_screen") / "assets"
#: Nothing from elsewhere, and nobody may show it in a frame.
_HEADERS = {
    "Content-Security-Policy": "default-src 'self'; base-uri 'none'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Cache-Control": "no-store",
    "Referrer-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Server": "woz",
}
#: Seconds from one sign of life to the next: a browser that is gone is noticed by it.
_ALIVE_S = 2.0
_RETRY_MS = 500
_CODE_BYTES = 12
#: Bytes of what a browser tells of one painting.
_TOLD_BYTES = 4096


class NotPaintedError(Exception):
    """The browser did not show it; the text says why."""


class NobodyLooksError(Exception):
    """No browser has the page open."""


class BrowserWindow:
    """One browser at a time: while it is there, others are turned away.

    Args:
        settings: The driver's.
        came: Called with its address when a browser opens the page.
        left: Called when it is gone.
    """

    def __init__(
        self,
        settings: BrowserScreenSettings,
        came: Callable[[str], None],
        left: Callable[[], None],
    ) -> None:
        self._settings = settings
        self._came, self._left = came, left
        self._code = settings.code or secrets.token_hex(_CODE_BYTES)
        self._port = settings.port
        self._numbers = itertools.count(1)
        #: What is shown now, also to a browser that comes later.
        self._now: dict[str, Any] = {"number": 0, "kind": "words", "text": ""}
        self._file: Path | None = None
        self._browser: asyncio.Event | None = None
        self._painted: dict[int, asyncio.Future[float]] = {}
        self._runner: web.AppRunner | None = None

    @property
    def address(self) -> str:
        """What is typed into the browser."""
        host = self._settings.listen.rpartition(":")[0]
        return f"http://{host}:{self._port}/{self._code}/"

    async def listen(self) -> None:
        """Begin. Raises `OSError`."""
        application = web.Application(client_max_size=_TOLD_BYTES)
        application.on_response_prepare.append(_add_headers)
        place = f"/{self._code}"
        application.add_routes(
            [
                web.get(f"{place}/", self._give_page),
                web.get(f"{place}/icon", _no_icon),
                web.get(f"{place}/news", self._give_news),
                web.get(f"{place}/picture/{{number}}", self._give_picture),
                web.post(f"{place}/painted", self._take_painted),
                web.get(f"{place}/{{asset:screen\\.(?:js|css)}}", _give_asset),
            ]
        )
        self._runner = web.AppRunner(
            application, access_log=None, handle_signals=False, shutdown_timeout=0.2
        )
        await self._runner.setup()
        await web.TCPSite(self._runner, self._settings.host, self._settings.port).start()
        self._port = self._runner.addresses[0][1]

    async def close(self) -> None:
        """Let the browser go."""
        if self._browser is not None:
            self._browser.set()
        if self._runner is not None:
            await self._runner.cleanup()
            self._runner = None

    # -- showing -------------------------------------------------------------------------------

    async def show(self, kind: str, text: str = "", file: Path | None = None) -> float:
        """Show it and wait until it is painted; milliseconds that this took by the page's own
        clock, from the page's being told. Raises `NobodyLooksError` or `NotPaintedError`.
        """
        if self._browser is None:
            raise NobodyLooksError
        number = next(self._numbers)
        self._file = file
        self._now = {"number": number, "kind": kind, "text": text}
        painted: asyncio.Future[float] = asyncio.get_running_loop().create_future()
        self._painted[number] = painted
        self._browser.set()
        try:
            async with asyncio.timeout(self._settings.patience):
                return await painted
        except TimeoutError:
            patience = f"{self._settings.patience:g} s"
            raise NotPaintedError(f"the browser has not painted it within {patience}") from None
        finally:
            del self._painted[number]

    # -- paths -----------------------------------------------------------------------------------

    async def _give_page(self, request: web.Request) -> web.Response:
        page = (_ASSETS / "screen.html").read_text(encoding="utf-8")
        page = page.replace("BACKGROUND", self._settings.background)
        return web.Response(text=page, content_type="text/html")

    async def _give_news(self, request: web.Request) -> web.StreamResponse:
        if self._browser is not None:
            raise web.HTTPConflict(text="another browser shows it")
        self._browser = news = asyncio.Event()
        try:
            response = web.StreamResponse(headers={"Content-Type": "text/event-stream"})
            await response.prepare(request)
            await response.write(f"retry: {_RETRY_MS}\n\n".encode())
            self._came(request.remote or "")
            shown = -1
            while self._runner is not None:
                news.clear()
                if self._now["number"] != shown:
                    shown = self._now["number"]
                    await response.write(f"data: {json.dumps(self._now)}\n\n".encode())
                try:
                    async with asyncio.timeout(_ALIVE_S):
                        await news.wait()
                except TimeoutError:
                    await response.write(b": here\n\n")
        except ConnectionError:
            pass
        finally:
            self._browser = None
            for painted in self._painted.values():
                if not painted.done():
                    painted.set_exception(NobodyLooksError())
            self._left()
        return response

    async def _give_picture(self, request: web.Request) -> web.StreamResponse:
        """Only that which is shown now."""
        if self._file is None or request.match_info["number"] != str(self._now["number"]):
            raise web.HTTPNotFound
        kind, _ = mimetypes.guess_type(self._file.name)
        return web.FileResponse(self._file, headers={"Content-Type": kind or "image/png"})

    async def _take_painted(self, request: web.Request) -> web.Response:
        if request.headers.get("Origin") != f"{request.scheme}://{request.host}":
            raise web.HTTPForbidden
        try:
            told = json.loads(await request.text())
            number, after_ms, error = int(told["number"]), float(told["after"]), str(told["error"])
        except (KeyError, TypeError, ValueError):
            raise web.HTTPBadRequest from None
        painted = self._painted.get(number)
        if painted is not None and not painted.done():
            if error:
                painted.set_exception(NotPaintedError(error))
            else:
                painted.set_result(after_ms)
        return web.Response(status=204)


async def _add_headers(request: web.Request, response: web.StreamResponse) -> None:
    response.headers.update(_HEADERS)


async def _no_icon(request: web.Request) -> web.Response:
    return web.Response(status=204)


async def _give_asset(request: web.Request) -> web.Response:
    name = request.match_info["asset"]
    kind = "text/css" if name.endswith(".css") else "text/javascript"
    return web.Response(text=(_ASSETS / name).read_text(encoding="utf-8"), content_type=kind)
