"""Serves files of this machine to the robot and its tablet by HTTP: those listed, and no others.

The server stands on the network of the robot: random paths, nothing but GET and HEAD, bounded
connections, and no client can hold it up.
"""

from __future__ import annotations

import contextlib
import errno
import io
import ipaddress
import os
import re
import secrets
import selectors
import socket
import stat
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler
from pathlib import Path
from typing import IO, Any, Protocol

from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_tui.drivers.background import apart
from woz_tui.drivers.contract import DeviceLostError, DriverContext, DriverError

#: Connections at once; a tablet opens six.
MOST = 16
#: A request has to be whole, and an answer to be taken up piece by piece, within this, in seconds.
PATIENCE_S = 10.0
#: Connections that wait to be let in: those beyond are asked for again a second later.
_BACKLOG = 128
_ENDS_WITHIN_S = 1.0
#: How often those that are too slow are looked for, in seconds, while there are any connections.
_LOOK_S = 1.0
#: How long nobody is let in when the system has no place for another connection, in seconds.
_SHUT_S = 0.2

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
        self._listed: dict[str, ListedFile] = {}
        self._known: dict[ListedFile, str] = {}
        self._clients: dict[socket.socket, float] = {}
        self._threads: set[threading.Thread] = set()
        self._lock = threading.Lock()
        self._over = self._told_shut = False
        self._door = _listening(host, port, section)
        self.host = host
        self.port: int = self._door.getsockname()[1]
        self._waker, self._wakes = socket.socketpair()
        self._thread = threading.Thread(target=self._serve, name="robot files", daemon=True)
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

    def close(self) -> None:
        """End it with all connections. Waits for its threads a second at most."""
        self._over = True
        with contextlib.suppress(OSError):
            self._waker.send(b"!")
        until = time.monotonic() + _ENDS_WITHIN_S
        self._thread.join(_ENDS_WITHIN_S)
        with self._lock:
            clients, threads = list(self._clients), list(self._threads)
        for client in clients:
            _hang_up(client)
        for thread in threads:
            thread.join(max(0.0, until - time.monotonic()))
        self._waker.close()

    def _list(self, listed: ListedFile) -> str:
        place = self._known.get(listed)
        if place is None:
            place = f"/{self._token}/{len(self._known)}{listed.suffix}"
            self._known[listed] = place
            self._listed[place] = listed
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"http://{host}:{self.port}{place}"

    # -- in the server's threads ---------------------------------------------------------------

    def _serve(self) -> None:
        with self._door, self._wakes, selectors.DefaultSelector() as ready:
            ready.register(self._door, selectors.EVENT_READ)
            ready.register(self._wakes, selectors.EVENT_READ)
            while not self._over:
                came = ready.select(_LOOK_S if self._clients else None)
                if any(key.fileobj is self._door for key, _ in came):
                    self._let_in()
                self._show_out()

    def _let_in(self) -> None:
        try:
            client, _ = self._door.accept()
        except (BlockingIOError, ConnectionError):
            return  # they went away again
        except OSError as error:  # no more files: they go on knocking, and must not keep us busy
            self._shut(error)
            return
        with self._lock:
            full = len(self._clients) >= MOST
            if not full:
                self._clients[client] = time.monotonic()
        if full:
            client.close()
            return
        client.settimeout(self._patience)
        thread = threading.Thread(
            target=self._answer, args=(client,), name="robot files client", daemon=True
        )
        with self._lock:
            self._threads.add(thread)
        try:
            thread.start()
        except RuntimeError:  # the system gives no more threads: the tablet asks again
            with self._lock:
                self._threads.discard(thread)
                self._clients.pop(client, None)
            client.close()

    def _shut(self, error: OSError) -> None:
        """Accept nobody for a while; reported once."""
        if not self._told_shut:
            self._told_shut = True
            self._troubled(f"the robot cannot load files at the moment: {error.strerror or error}")
        time.sleep(_SHUT_S)

    def _show_out(self) -> None:
        """Whoever has not asked yet after all that time never will."""
        limit = time.monotonic() - self._patience
        with self._lock:
            slow = [client for client, since in self._clients.items() if since < limit]
        for client in slow:
            _hang_up(client)

    def _asked(self, client: socket.socket) -> None:
        """The request is whole: from here on the socket's own limit counts."""
        with self._lock:
            if client in self._clients:
                self._clients[client] = float("inf")

    def _answer(self, client: socket.socket) -> None:
        try:
            FileRequestHandler(client, self._listed, self._asked)
        except (OSError, ValueError):
            pass  # the client went away, was too slow, or its socket was closed under it
        except Exception as error:  # noqa: BLE001 - nothing else would notice
            self._troubled(f"a request of the robot failed: {error!r}")
        finally:
            with self._lock:
                self._clients.pop(client, None)
                self._threads.discard(threading.current_thread())
            _hang_up(client)
            client.close()


def _listening(host: str, port: int, section: str) -> socket.socket:
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
        door.bind((host, port))
        door.listen(_BACKLOG)
        door.setblocking(False)
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


def _hang_up(client: socket.socket) -> None:
    with contextlib.suppress(OSError):
        client.shutdown(socket.SHUT_RDWR)


# -- one client: RFC 9110, as far as a robot needs it ----------------------------------------------

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


class FileRequestHandler(BaseHTTPRequestHandler):
    """One connection with one request: it is answered when this is made."""

    protocol_version = "HTTP/1.1"
    #: The socket has its limit already.
    timeout = None

    def __init__(
        self,
        client: socket.socket,
        listed: Mapping[str, ListedFile],
        asked: Callable[[socket.socket], None],
    ) -> None:
        self._listed = listed
        self._asked = asked
        super().__init__(client, ("", 0), _NO_SERVER)

    def handle(self) -> None:
        """One request; its connection ends with it."""
        self.close_connection = True
        self.handle_one_request()

    def do_GET(self) -> None:
        """Headers and bytes."""
        self._give(body=True)

    def do_HEAD(self) -> None:
        """Headers only."""
        self._give(body=False)

    def send_error(self, code: int, message: str | None = None, explain: str | None = None) -> None:
        """A status without a page."""
        # What cannot be parsed is answered in the oldest way, so that there are headers at all.
        self.request_version = "HTTP/1.0"
        self._head(HTTPStatus(code), {"Content-Length": "0"})

    def log_message(self, format: str, *args: Any) -> None:  # noqa: A002 - http.server's name
        """Nothing is printed: the wizard's screen is a terminal."""

    def _give(self, *, body: bool) -> None:
        self._asked(self.connection)
        listed = self._listed.get(self.path.partition("?")[0])
        if listed is None:
            self.send_error(HTTPStatus.NOT_FOUND)
            return
        try:
            file, size = listed.open()
        except OSError:
            self.send_error(HTTPStatus.NOT_FOUND)
            return
        with file:
            self._send(listed, file, size, body=body)

    def _send(self, listed: ListedFile, file: IO[bytes], size: int, *, body: bool) -> None:
        # There are no validators here, so whoever makes a range depend on one gets the whole.
        wish = "" if self.headers["If-Range"] else self.headers["Range"] or ""
        wanted = byte_range(wish, size) if self.command == "GET" else ByteRange(0, size, size)
        if wanted is None:
            headers = {"Content-Range": f"bytes */{size}", "Content-Length": "0"}
            self._head(HTTPStatus.REQUESTED_RANGE_NOT_SATISFIABLE, headers)
            return
        headers = {
            "Content-Type": TYPES.get(listed.suffix, "application/octet-stream"),
            "Content-Length": str(wanted.end - wanted.start),
            "Accept-Ranges": "bytes",
            "Cache-Control": "no-cache",
            "X-Content-Type-Options": "nosniff",
        }
        if not wanted.whole:
            headers["Content-Range"] = f"bytes {wanted.start}-{wanted.end - 1}/{size}"
        self._head(HTTPStatus.OK if wanted.whole else HTTPStatus.PARTIAL_CONTENT, headers)
        if body:
            self._pour(file, wanted)

    def _pour(self, file: IO[bytes], wanted: ByteRange) -> None:
        file.seek(wanted.start)
        left = wanted.end - wanted.start
        while left > 0 and (piece := file.read(min(_PIECE, left))):
            self.connection.sendall(piece)
            left -= len(piece)

    def _head(self, status: HTTPStatus, headers: Mapping[str, str]) -> None:
        self.send_response_only(status)
        for name, value in headers.items():
            self.send_header(name, value)
        self.send_header("Connection", "close")
        self.end_headers()


#: `BaseHTTPRequestHandler` keeps a server it never uses here.
_NO_SERVER: Any = None


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
