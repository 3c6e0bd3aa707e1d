"""Serves files of this machine to the robot and its tablet by HTTP: those listed, and no others.

The server stands on the network of the robot: random paths, nothing but GET and HEAD, bounded
connections, and no client can hold it up. It has a thread and an event loop of its own, so that
neither a film nor a slow disk delays the robot.
"""

from __future__ import annotations

import asyncio
import contextlib
import errno
import io
import ipaddress
import itertools
import logging
import os
import re
import secrets
import socket
import stat
import threading
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from http import HTTPStatus
from pathlib import Path
from typing import IO, Any, Protocol

from aiohttp import ClientError, web

from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_tui.drivers.background import apart
from woz_tui.drivers.contract import DeviceLostError, DriverContext, DriverError

#: Connections at once; a tablet opens six.
MOST = 16
#: A request has to be whole, and an answer to be taken up piece by piece, within this, in seconds.
PATIENCE_S = 10.0
_ENDS_WITHIN_S = 1.0

#: What a client sends that is no request is nothing to log: the door is open to the whole network.
_SILENT = logging.getLogger(f"{__name__}.requests")
_SILENT.setLevel(logging.CRITICAL + 1)

_BIND_TROUBLES = {
    errno.EADDRINUSE: "take another `{section}.port`, or 0 for any",
    errno.EADDRNOTAVAIL: "this machine has no such address: correct `{section}.address`, or leave"
    " it empty so that it is found out",
    errno.EACCES: "ports below 1024 belong to the system: take a higher `{section}.port`",
}


class FileServer:
    """Serves listed files at `http://host:port/token/...`.

    `troubled(text)` is called from a thread for what should not happen. All methods are for one
    thread; what is listed may be asked for from then on. `section` is where the robot file says
    address and port.
    """

    def __init__(
        self,
        host: str,
        port: int,
        troubled: Callable[[str], None],
        *,
        patience: float = PATIENCE_S,
        section: str = "tablet",
    ) -> None:
        """Begin. Raises `DriverError` in words if the address or the port cannot be had."""
        self._troubled = troubled
        self._patience = patience
        self._token = secrets.token_urlsafe(16)
        self._numbers = itertools.count()
        self._listed: dict[str, ListedFile] = {}
        self._known: dict[ListedFile, str] = {}
        self._told_full = False
        self._door = _listening(host, port, section, patience)
        self.host = host
        self.port: int = self._door.getsockname()[1]
        self._loop = asyncio.new_event_loop()
        self._over = asyncio.Event()
        self._thread = threading.Thread(target=self._run, name="robot files", daemon=True)
        self._thread.start()

    def list_file(self, path: Path) -> str:
        """The address of a file from now on; the same one each time.

        Where it leads is settled now; what is in it, when it is asked for. Raises `DriverError` if
        it is missing or cannot be read.
        """
        try:
            real = path.resolve(strict=True)
            if not real.is_file():
                raise DriverError(f"{path} is no file", "name a picture, a video or a sound")
            with real.open("rb"):
                pass
        except (OSError, RuntimeError) as error:  # RuntimeError: links in a circle
            why = getattr(error, "strerror", None) or str(error)
            raise DriverError(
                f"{path} cannot be served: {why}", "check its name and that you may read it"
            ) from None
        return self._list(ListedFile(real.suffix.lower(), path=real))

    def list_page(self, html: str) -> str:
        """The address of a page that was made here."""
        return self._list(ListedFile(".html", content=html.encode()))

    def list_sound(self, wav: bytes) -> str:
        """The address of a sound that was made here, until it is withdrawn."""
        return self._list(ListedFile(".wav", content=wav))

    def withdraw(self, address: str) -> None:
        """What is listed there is not served any more."""
        place = f"/{address.partition('://')[2].partition('/')[2]}"
        listed = self._listed.pop(place, None)
        if listed is not None:
            del self._known[listed]

    def close(self) -> None:
        """End it with all connections. Waits for its thread a second at most."""
        with contextlib.suppress(RuntimeError):  # it has ended
            self._loop.call_soon_threadsafe(self._over.set)
        self._thread.join(_ENDS_WITHIN_S)

    def _list(self, listed: ListedFile) -> str:
        place = self._known.get(listed)
        if place is None:
            place = f"/{self._token}/{next(self._numbers)}{listed.suffix}"
            self._known[listed] = place
            self._listed[place] = listed
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"http://{host}:{self.port}{place}"

    # -- in the server's thread ------------------------------------------------------------------

    def _run(self) -> None:
        self._loop.set_exception_handler(self._failed)
        with contextlib.closing(self._loop):
            self._loop.run_until_complete(self._serve())

    async def _serve(self) -> None:
        server = _BoundedServer(
            self._answer,
            request_factory=_request,
            keepalive_timeout=self._patience,
            access_log=None,
            logger=_SILENT,
        )
        async with await self._loop.create_server(server, sock=self._door):
            await self._over.wait()
            for connection in server.connections:
                if connection.transport is not None:
                    connection.transport.abort()
        await server.shutdown(0.0)

    def _failed(self, loop: asyncio.AbstractEventLoop, context: Mapping[str, Any]) -> None:
        """What nobody waits for, such as no place for another connection: that is told once."""
        if "transport" in context:
            return  # a client went away, or was too slow
        error = context.get("exception")
        if not isinstance(error, OSError):
            self._troubled(f"a request of the robot failed: {error or context['message']!r}")
        elif not self._told_full:
            self._told_full = True
            self._troubled(f"the robot cannot load files at the moment: {error.strerror or error}")

    async def _answer(self, request: web.BaseRequest) -> web.StreamResponse:
        """One request; its connection ends with it."""
        try:
            answer = await self._answered(request)
        except (OSError, ClientError):
            raise  # the client went away, or was too slow
        except Exception as error:
            self._troubled(f"a request of the robot failed: {error!r}")
            raise
        answer.force_close()
        return answer

    async def _answered(self, request: web.BaseRequest) -> web.StreamResponse:
        if request.method not in ("GET", "HEAD"):
            return web.Response(status=HTTPStatus.NOT_IMPLEMENTED)
        # As it was sent: a path with dots is not the one to which they would lead.
        listed = self._listed.get(request.raw_path.partition("?")[0])
        if listed is None:
            return web.Response(status=HTTPStatus.NOT_FOUND)
        try:
            file, size = listed.open()
        except OSError:
            return web.Response(status=HTTPStatus.NOT_FOUND)
        with file:
            return await _send(request, listed, file, size)


def _listening(host: str, port: int, section: str, patience: float) -> socket.socket:
    """A socket that listens. Raises `DriverError`."""
    try:
        family = socket.AF_INET6 if ipaddress.ip_address(host).version == 6 else socket.AF_INET
    except ValueError:
        raise DriverError(
            f"{host!r} is no address of this machine",
            f"give `{section}.address` in numbers, or leave it empty so that it is found out",
        ) from None
    door = socket.socket(family, socket.SOCK_STREAM)
    try:
        door.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        # Of each connection: who takes up nothing for so long is gone.
        door.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, round(patience * 1000))
        door.bind((host, port))
        door.listen()
    except OSError as error:
        door.close()
        why = error.strerror or str(error)
        remedy = _BIND_TROUBLES.get(
            error.errno or 0, "check `{section}.address` and `{section}.port`"
        ).format(section=section)
        raise DriverError(f"files cannot be served at {host}, port {port}: {why}", remedy) from (
            None
        )
    return door


class _BoundedServer(web.Server):
    """Hangs up on whoever comes beyond `MOST`."""

    def connection_made(self, handler: web.RequestHandler, transport: asyncio.Transport) -> None:
        super().connection_made(handler, transport)
        if len(self.connections) > MOST:
            # When it has begun to wait for a request: before, its end would be an error.
            asyncio.get_running_loop().call_soon(transport.abort)


def _request(
    message: Any, payload: Any, protocol: Any, writer: Any, task: asyncio.Task[None]
) -> web.BaseRequest:
    return _Request(message, payload, protocol, writer, task, asyncio.get_running_loop())


class _Request(web.BaseRequest):
    """A request whose answer does not tell the versions of Python and of the server."""

    async def _prepare_hook(self, response: web.StreamResponse) -> None:
        response.headers.pop("Server", None)


# -- one answer: RFC 9110, as far as a robot needs it ----------------------------------------------

TYPES: Mapping[str, str] = {
    ".png": "image/png",
    ".jpg": "image/jpeg",
    ".jpeg": "image/jpeg",
    ".gif": "image/gif",
    ".svg": "image/svg+xml",
    ".webp": "image/webp",
    ".bmp": "image/bmp",
    ".mp4": "video/mp4",
    ".m4v": "video/mp4",
    ".webm": "video/webm",
    ".mkv": "video/x-matroska",
    ".mov": "video/quicktime",
    ".avi": "video/x-msvideo",
    ".3gp": "video/3gpp",
    ".ogv": "video/ogg",
    ".mpg": "video/mpeg",
    ".mpeg": "video/mpeg",
    ".wmv": "video/x-ms-wmv",
    ".flv": "video/x-flv",
    ".wav": "audio/wav",
    ".mp3": "audio/mpeg",
    ".ogg": "audio/ogg",
    ".oga": "audio/ogg",
    ".flac": "audio/flac",
    ".m4a": "audio/mp4",
    ".html": "text/html; charset=utf-8",
    ".htm": "text/html; charset=utf-8",
}
_PIECE = 1 << 16
#: One range, as `Range: bytes=0-99`; several at once are answered with the whole.
_RANGE = re.compile(r"bytes=(\d{0,18})-(\d{0,18})", re.ASCII)
#: A link that was put there since, or a pipe, is not followed and not waited for.
_FLAGS = os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC


def _opened(path: str, flags: int) -> int:
    return os.open(path, flags | _FLAGS)


@dataclass(frozen=True, slots=True)
class ListedFile:
    """What may be asked for: a file by its real path, or a page as it is."""

    suffix: str
    path: Path | None = None
    content: bytes = b""

    def open(self) -> tuple[IO[bytes], int]:
        """Its bytes, and how many there are. Raises `OSError` if it is no file any more."""
        if self.path is None:
            return io.BytesIO(self.content), len(self.content)
        # Not `fdopen`: that lets a folder's descriptor lie.
        file = open(self.path, "rb", buffering=0, opener=_opened)  # noqa: SIM115
        found = os.fstat(file.fileno())
        if not stat.S_ISREG(found.st_mode):
            file.close()
            raise FileNotFoundError(f"{self.path} is no file any more")
        return file, found.st_size


@dataclass(frozen=True, slots=True)
class ByteRange:
    """Bytes `start` to `end`, without the last, of `size`."""

    start: int
    end: int
    size: int

    @property
    def whole(self) -> bool:
        """Whether it is all of it."""
        return self.start == 0 and self.end == self.size


def byte_range(wish: str, size: int) -> ByteRange | None:
    """What a `Range` header asks for; all of it for a wish that is not understood.

    None if there are no such bytes.
    """
    found = _RANGE.fullmatch(wish.strip())
    if found is None or found[1] == found[2] == "":
        return ByteRange(0, size, size)
    if not found[1]:
        last = int(found[2])
        return ByteRange(max(0, size - last), size, size) if last and size else None
    start = int(found[1])
    if found[2] and int(found[2]) < start:
        return ByteRange(0, size, size)
    end = min(int(found[2]) + 1, size) if found[2] else size
    return ByteRange(start, end, size) if start < size else None


async def _send(
    request: web.BaseRequest, listed: ListedFile, file: IO[bytes], size: int
) -> web.StreamResponse:
    # There are no validators here, so whoever makes a range depend on one gets the whole.
    wish = "" if "If-Range" in request.headers else request.headers.get("Range", "")
    wanted = byte_range(wish, size) if request.method == "GET" else ByteRange(0, size, size)
    if wanted is None:
        status = HTTPStatus.REQUESTED_RANGE_NOT_SATISFIABLE
        return web.Response(status=status, headers={"Content-Range": f"bytes */{size}"})
    answer = web.StreamResponse(
        headers={
            "Content-Type": TYPES.get(listed.suffix, "application/octet-stream"),
            "Content-Length": str(wanted.end - wanted.start),
            "Accept-Ranges": "bytes",
            "Cache-Control": "no-cache",
            "X-Content-Type-Options": "nosniff",
        }
    )
    answer.force_close()
    if not wanted.whole:
        answer.set_status(HTTPStatus.PARTIAL_CONTENT)
        answer.headers["Content-Range"] = f"bytes {wanted.start}-{wanted.end - 1}/{size}"
    await answer.prepare(request)
    if request.method == "GET":
        file.seek(wanted.start)
        left = wanted.end - wanted.start
        while left > 0 and (piece := file.read(min(_PIECE, left))):
            await answer.write(piece)
            left -= len(piece)
    return answer


def is_address(text: str) -> bool:
    """Whether it is to be fetched from somewhere, rather than a file of this machine."""
    return "://" in text


class RobotAddress(Protocol):
    """A robot, as far as it is served files."""

    @property
    def local_host(self) -> str:
        """This machine's address as the robot reaches it; empty: it is not there."""


class ServedFiles:
    """Serves files where the robot reaches this machine.

    The server begins with the first file, and anew when the robot is reached in another way.
    """

    def __init__(
        self, robot: RobotAddress, settings: NaoqiSettings, context: DriverContext
    ) -> None:
        self._robot = robot
        self._settings = settings
        self._context = context
        self._server: FileServer | None = None

    async def connected(self) -> None:
        """A server at another address than this robot needs is of no use."""
        if self._server is not None and self._server.host != self._host:
            await self.close()

    async def address(self, path: Path) -> str:
        """Where the robot fetches this file from. Raises `DriverError`."""
        server = self._serving()
        return await apart(lambda: server.list_file(path))

    async def page(self, html: str) -> str:
        """Where the tablet fetches a page from. Raises `DriverError`."""
        return self._serving().list_page(html)

    @contextlib.contextmanager
    def sound(self, wav: bytes) -> Iterator[str]:
        """Where the robot fetches a sound that was made here, meanwhile. Raises `DriverError`."""
        server = self._serving()
        address = server.list_sound(wav)
        try:
            yield address
        finally:
            server.withdraw(address)

    async def close(self) -> None:
        """Serve nothing more."""
        server, self._server = self._server, None
        if server is not None:
            await apart(server.close)

    @property
    def _host(self) -> str:
        return self._settings.serving.address or self._robot.local_host

    def _serving(self) -> FileServer:
        if self._server is None:
            host = self._host
            if not host:
                raise DeviceLostError(
                    "the robot is not connected, so no files can be sent", "wait for it"
                )
            self._server = FileServer(
                host,
                self._settings.serving.port,
                self._troubled,
                section=self._settings.serving_section,
            )
        return self._server

    def _troubled(self, text: str) -> None:
        self._context.notice("warning", text, "show or play it again", tells=("request",))
