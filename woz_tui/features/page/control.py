"""Orders to a `woz page` that runs, from another terminal of the same user: its codes, new ones.

A socket beside those of sessions, in a folder that nobody else can enter.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import socket
from collections.abc import Awaitable, Callable, Collection, Sequence
from pathlib import Path

from woz_tui.features.page.visitors import PageRole
from woz_tui.system import session_sockets

#: Seconds for which a page may take to answer, and bytes of an order or an answer.
_ANSWER_S, _MOST_BYTES = 5.0, 1 << 16


class PageControl:
    """Listens for orders.

    Args:
        session: The name of the session's socket.
        port: That of the pages: several may be open for one session.
        told: Addresses and codes, in words.
        renew: Makes other codes for these roles.
    """

    def __init__(
        self,
        session: str,
        port: int,
        told: Callable[[], Sequence[str]],
        renew: Callable[[Collection[PageRole]], Awaitable[None]],
    ) -> None:
        self._session = session
        self._path = session_sockets.folder() / f"{session}.{port}.page"
        self._told, self._renew = told, renew
        self._server: asyncio.Server | None = None

    async def start(self) -> None:
        """Begin to listen. Raises `OSError`."""
        for other in open_pages(self._session):
            if other == self._path or not session_sockets.answers(other):  # it was killed
                other.unlink(missing_ok=True)
        self._server = await asyncio.start_unix_server(self._answer, self._path, limit=_MOST_BYTES)

    async def close(self) -> None:
        """Listen no more."""
        if self._server is not None:
            self._server.close()
            self._path.unlink(missing_ok=True)

    async def _answer(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        with contextlib.suppress(OSError, ValueError, TypeError):
            wanted = {PageRole(each) for each in json.loads(await reader.readline())}
            if wanted:
                await self._renew(wanted)
            writer.write(json.dumps([*self._told()]).encode() + b"\n")
            await writer.drain()
        writer.close()


def open_pages(session: str = "") -> list[Path]:
    """Where pages of this user listen for orders, of one session or of all."""
    found = session_sockets.folder().glob("*.page")
    return sorted(each for each in found if not session or each.name.startswith(f"{session}."))


def order(path: Path, renew: Collection[PageRole] = ()) -> list[str] | None:
    """Addresses and codes of a page, with others for these roles; None: none runs there."""
    try:
        with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as line:
            line.settimeout(_ANSWER_S)
            line.connect(os.fspath(path))
            line.sendall(json.dumps([role.value for role in renew]).encode() + b"\n")
            with line.makefile("rb") as answer:
                told = json.loads(answer.readline(_MOST_BYTES))
    except ConnectionRefusedError:  # it was killed
        path.unlink(missing_ok=True)
        return None
    except (OSError, ValueError):
        return None
    return [str(each) for each in told] if isinstance(told, list) else None
