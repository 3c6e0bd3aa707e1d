"""STOMP 1.2 over asyncio: one connection to a message broker.

Source: the STOMP 1.2 specification (stomp.github.io). A SEND has no content-length, because
ActiveMQ hands on what has one as bytes, which planners refuse.
"""

from __future__ import annotations

import asyncio
import contextlib
import re
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping
from dataclasses import dataclass, field
from typing import NoReturn

from woz_tui.system.retry_pauses import RetryPauses
from woz_tui.system.tasks import end_tasks

#: A longer frame ends the connection, in bytes.
LONGEST_FRAME = 4 << 20
#: More headers than this, or longer ones together, end the connection.
MOST_HEADERS = 100
LONGEST_HEADERS = 1 << 16
#: How often each side shows that it lives, in seconds; it counts as gone after twice that.
HEART_BEAT_S = 2.0
_CONNECT_S = 5.0
_GOODBYE_S = 1.0
#: What waits for a broker that does not read, in bytes.
_MOST_UNREAD = 4 << 20
#: Pauses between two attempts, in seconds.
_FIRST_PAUSE_S, _LONGEST_PAUSE_S = 0.5, 8.0
_ESCAPES = (("\\", "\\\\"), ("\r", "\\r"), ("\n", "\\n"), (":", "\\c"))


class StompError(Exception):
    """The broker cannot be used; the text says why and what helps."""


class StompRefusedError(StompError):
    """The broker answered with an error: trying again does not help."""


@dataclass(frozen=True, slots=True)
class StompFrame:
    """One frame: its command, its headers, its body."""

    command: str
    headers: Mapping[str, str] = field(default_factory=dict)
    body: bytes = b""

    def encode(self) -> bytes:
        """As it goes over the wire."""
        plain = self.command in ("CONNECT", "CONNECTED")  # these two escape nothing
        lines = [self.command]
        for name, value in self.headers.items():
            lines.append(f"{name}:{value}" if plain else f"{_escape(name)}:{_escape(value)}")
        return "\n".join(lines).encode() + b"\n\n" + self.body + b"\0"


def _escape(text: str) -> str:
    for sign, escaped in _ESCAPES:
        text = text.replace(sign, escaped)
    return text


def _unescape(text: str) -> str:
    pieces, rest = [], iter(text)
    for sign in rest:
        if sign != "\\":
            pieces.append(sign)
            continue
        after = next(rest, "")
        meant = {"r": "\r", "n": "\n", "c": ":", "\\": "\\"}.get(after)
        if meant is None:
            raise StompError(f"the broker sent an unknown escape: \\{after}")
        pieces.append(meant)
    return "".join(pieces)


async def read_frame(reader: asyncio.StreamReader) -> StompFrame | None:
    """The next frame; None for a heart beat. Raises `StompError`, `OSError`, or
    `asyncio.IncompleteReadError` at the end.
    """
    try:
        command = await _line(reader)
        if not command:
            return None
        headers: dict[str, str] = {}
        lines = length_of_all = 0
        while line := await _line(reader):
            name, colon, value = line.partition(":")
            lines, length_of_all = lines + 1, length_of_all + len(line)
            if not colon or lines > MOST_HEADERS or length_of_all > LONGEST_HEADERS:
                raise StompError("what answers there is no STOMP broker")
            if command != "CONNECTED":
                name, value = _unescape(name), _unescape(value)
            headers.setdefault(name, value)  # the first of several counts
        length = headers.get("content-length", "")
        if length.isascii() and length.isdigit():
            if int(length) > LONGEST_FRAME:
                raise StompError(f"the broker sent more than {LONGEST_FRAME} bytes at once")
            body = await reader.readexactly(int(length))
            await reader.readexactly(1)
        else:
            body = (await reader.readuntil(b"\0"))[:-1]
    except (asyncio.LimitOverrunError, ValueError) as error:
        raise StompError(f"what answers there is no STOMP broker: {error}") from error
    return StompFrame(command, headers, body)


async def _line(reader: asyncio.StreamReader) -> str:
    line = await reader.readuntil(b"\n")
    return line[:-1].removesuffix(b"\r").decode("utf-8", "replace")


@dataclass(frozen=True, slots=True)
class StompPlace:
    """Where the broker is and who we are. `virtual_host`: empty is the host's own name."""

    host: str
    port: int = 61613
    login: str = ""
    passcode: str = ""
    virtual_host: str = ""

    def __str__(self) -> str:
        return f"{self.host}:{self.port}"


class StompConnection:
    """A connection that is open. `connect_stomp` makes it."""

    def __init__(
        self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, place: StompPlace
    ) -> None:
        self._reader = reader
        self._writer = writer
        self._place = place
        self._beats: asyncio.Task[None] | None = None
        self._silence_s: float | None = None
        self._subscriptions = 0

    async def open(self) -> None:
        """Say hello. Raises `StompError`."""
        place = self._place
        beat = round(HEART_BEAT_S * 1000)
        headers = {
            "accept-version": "1.2",
            "host": place.virtual_host or place.host,
            "heart-beat": f"{beat},{beat}",
        }
        if place.login:
            headers |= {"login": place.login, "passcode": place.passcode}
        self._writer.write(StompFrame("CONNECT", headers).encode())
        answer = await self._frame()
        if answer.command != "CONNECTED":
            raise StompRefusedError(
                f"{place} refused: {_error_of(answer)} (check the login, the passcode and the"
                " virtual host, which is / in RabbitMQ)"
            )
        theirs, wanted = _heart_beat(answer.headers.get("heart-beat", "0,0"))
        if theirs:
            self._silence_s = 2 * max(theirs / 1000, HEART_BEAT_S)
        if wanted:
            every = max(wanted / 1000, HEART_BEAT_S)
            self._beats = asyncio.create_task(self._beat(every), name="stomp beats")

    def subscribe(self, topic: str) -> None:
        """Get the topic's messages from now on."""
        self._subscriptions += 1
        headers = {"destination": topic, "id": str(self._subscriptions), "ack": "auto"}
        self._writer.write(StompFrame("SUBSCRIBE", headers).encode())

    def send(self, topic: str, text: str) -> None:
        """Send a text; what cannot be sent any more is noticed by whoever reads. A broker that
        reads no more is left.
        """
        if self._writer.transport.get_write_buffer_size() > _MOST_UNREAD:
            self._writer.transport.abort()
        headers = {"destination": topic, "content-type": "text/xml;charset=utf-8"}
        self._writer.write(StompFrame("SEND", headers, text.encode().replace(b"\0", b"")).encode())

    async def messages(self) -> AsyncIterator[tuple[str, str]]:
        """Topic and text of each message, until the connection is lost, which raises
        `StompError`.
        """
        while True:
            frame = await self._frame()
            match frame.command:
                case "MESSAGE":
                    text = frame.body.decode("utf-8", "replace")
                    yield frame.headers.get("destination", ""), text
                case "ERROR":
                    raise StompRefusedError(f"{self._place} says: {_error_of(frame)}")
                case _:
                    pass

    async def close(self) -> None:
        """Say goodbye, and do not wait long for the answer."""
        await end_tasks(self._beats)
        with contextlib.suppress(OSError, TimeoutError, StompError):
            async with asyncio.timeout(_GOODBYE_S):
                self._writer.write(StompFrame("DISCONNECT", {"receipt": "bye"}).encode())
                while (await self._frame()).command != "RECEIPT":
                    pass
        self._writer.close()

    async def _frame(self) -> StompFrame:
        try:
            while True:
                async with asyncio.timeout(self._silence_s):
                    frame = await read_frame(self._reader)
                if frame is not None:
                    return frame
                await asyncio.sleep(0)  # however many have come, others have their turn
        except TimeoutError:
            raise StompError(f"{self._place} is silent; is it still running?") from None
        except (OSError, asyncio.IncompleteReadError):
            raise StompError(f"{self._place} closed the connection") from None

    async def _beat(self, every: float) -> None:
        while True:
            await asyncio.sleep(every)
            self._writer.write(b"\n")


async def connect_stomp(place: StompPlace) -> StompConnection:
    """Connect to a broker. Raises `StompError`."""
    try:
        async with asyncio.timeout(_CONNECT_S):
            streams = await asyncio.open_connection(place.host, place.port, limit=LONGEST_FRAME)
            connection = StompConnection(*streams, place)
            try:
                await connection.open()
            except BaseException:
                streams[1].close()
                raise
    except TimeoutError:
        raise StompError(f"{place} does not answer; is a STOMP broker there?") from None
    except OSError as error:
        raise StompError(f"{place} cannot be reached: {error.strerror or error}") from None
    return connection


async def stay_connected(
    place: StompPlace,
    serve: Callable[[StompConnection], Awaitable[None]],
    tell: Callable[[str], None],
) -> NoReturn:
    """Connect and `serve` until this is cancelled, again and again when the broker goes away, which
    `tell` says to a person. Raises `StompRefusedError` when it does not let us in.
    """
    pauses = RetryPauses(_FIRST_PAUSE_S, _LONGEST_PAUSE_S)
    while True:
        connection = None
        try:
            connection = await connect_stomp(place)
            await serve(connection)
        except StompRefusedError:
            raise
        except StompError as error:
            tell(f"{error}; it is tried again")
        finally:
            if connection is not None:
                await connection.close()
        await asyncio.sleep(pauses.after(connection is not None))


def _heart_beat(text: str) -> tuple[int, int]:
    """What the broker sends, and what it wants, in milliseconds; 0: nothing."""
    found = re.fullmatch(r"\s*(\d{1,9})\s*,\s*(\d{1,9})\s*", text, re.ASCII)
    return (int(found[1]), int(found[2])) if found else (0, 0)


def _error_of(frame: StompFrame) -> str:
    """What the broker says: some put the reason into the header, some below it."""
    said = frame.headers.get("message", "").strip()
    below = frame.body.decode("utf-8", "replace").strip().partition("\n")[0].strip()
    if below not in said:
        said = f"{said}: {below}" if said else below
    return said[:200] or f"an answer {frame.command!r}"
