"""What strangers send to `--listen` is refused soon, and fills neither memory nor log files."""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections.abc import AsyncIterator
from pathlib import Path

import pytest

from woz_tui.network.certificates import Authority
from woz_tui.network.listen_address import ListenAddress
from woz_tui.remote.access_server import AccessServer

HEAD = b"Host: robot\r\n"
#: So much is sent that could never lie in the kernel's buffers.
MUCH = 100_000_000


@pytest.fixture
async def port(tmp_path: Path) -> AsyncIterator[int]:
    server = AccessServer(tmp_path / "S01.sock", Authority(tmp_path / "access"))
    server.adopt({"local": "wizard"})
    address = await server.listen(ListenAddress.read("ws://127.0.0.1:0"))
    yield int(address.rpartition(":")[2])
    await server.close()


async def sent(port: int, head: bytes, body: int = 0) -> tuple[str, int]:
    """The first line of the answer, and how many bytes of a body were taken."""
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    writer.write(head)
    taken = 0
    with contextlib.suppress(ConnectionError):
        while taken < body:
            writer.write(bytes(1_000_000))
            await writer.drain()
            taken += 1_000_000
    answer = b""
    with contextlib.suppress(ConnectionError):
        answer = await reader.readline()
    writer.close()
    return answer.decode("latin-1").strip(), taken


@pytest.mark.parametrize(
    "head",
    [
        b"GET /" + b"x" * 100_000 + b" HTTP/1.1\r\n" + HEAD + b"\r\n",
        b"GET /session HTTP/1.1\r\n" + HEAD + b"A: " + b"x" * 100_000 + b"\r\n\r\n",
        b"GET /session HTTP/1.1\r\n" + b"A: x\r\n" * 10_000 + b"\r\n",
        b"GET /session HTTP/1.1\r\n" + HEAD + b"Content-Length: many\r\n\r\n",
        b"GET /session HTTP/1.1\r\nHost\r\n\r\n",
        b"\x16\x03\x01\x02\x00\x01\r\n\r\n",
    ],
    ids=["URL", "header", "headers", "length", "colon", "TLS"],
)
async def test_nonsense_is_answered_without_a_traceback(
    port: int, head: bytes, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.INFO):
        for _ in range(3):
            answer, _ = await sent(port, head)
            assert answer.startswith("HTTP/1.") and answer.split()[1][0] == "4"
    assert [line for line in caplog.records if line.exc_info] == []
    assert sum(len(line.getMessage()) for line in caplog.records) < 1000


@pytest.mark.parametrize("path", ["session", "clock", "other"])
@pytest.mark.parametrize("method", ["GET", "POST"])
@pytest.mark.parametrize("length", [f"Content-Length: {MUCH}", "Transfer-Encoding: chunked"])
async def test_no_body_is_taken(port: int, path: str, method: str, length: str) -> None:
    body = b"5f5e100\r\n" if "chunked" in length else b""  # one chunk of all
    head = f"{method} /{path} HTTP/1.1\r\nHost: robot\r\n{length}\r\n\r\n".encode() + body
    answer, taken = await sent(port, head, MUCH)
    assert taken < MUCH / 4
    assert not answer or answer.split()[1][0] == "4"
