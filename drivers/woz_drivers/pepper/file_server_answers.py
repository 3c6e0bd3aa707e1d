"""What one client of the file server gets: RFC 9110, as far as a robot needs it."""

from __future__ import annotations

import io
import os
import re
import socket
import stat
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler
from pathlib import Path
from typing import IO, Any

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
class Listed:
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
class Part:
    """Bytes `start` to `end`, without the last, of `size`."""

    start: int
    end: int
    size: int

    @property
    def whole(self) -> bool:
        """Whether it is all of it."""
        return self.start == 0 and self.end == self.size


def part(wish: str, size: int) -> Part | None:
    """What a `Range` header asks for; all of it for a wish that is not understood.

    None if there are no such bytes.
    """
    found = _RANGE.fullmatch(wish.strip())
    if found is None or found[1] == found[2] == "":
        return Part(0, size, size)
    if not found[1]:
        last = int(found[2])
        return Part(max(0, size - last), size, size) if last and size else None
    start = int(found[1])
    if found[2] and int(found[2]) < start:
        return Part(0, size, size)
    end = min(int(found[2]) + 1, size) if found[2] else size
    return Part(start, end, size) if start < size else None


class Answers(BaseHTTPRequestHandler):
    """One connection with one request: it is answered when this is made."""

    protocol_version = "HTTP/1.1"
    #: The socket has its limit already.
    timeout = None

    def __init__(
        self,
        client: socket.socket,
        listed: Mapping[str, Listed],
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

    def _send(self, listed: Listed, file: IO[bytes], size: int, *, body: bool) -> None:
        # There are no validators here, so whoever makes a range depend on one gets the whole.
        wish = "" if self.headers["If-Range"] else self.headers["Range"] or ""
        wanted = part(wish, size) if self.command == "GET" else Part(0, size, size)
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

    def _pour(self, file: IO[bytes], wanted: Part) -> None:
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
