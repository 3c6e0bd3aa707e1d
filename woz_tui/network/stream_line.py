"""The line to another process of this computer, over a socket of the two: no network, no zenoh.

What is urgent overtakes what waits on either side, what is bulky goes when nothing else does. Whose
socket ends is gone, which the other one notices at once. In the event loop alone.
"""

from __future__ import annotations

import asyncio
import contextlib
import enum
import logging
import socket
import struct
from collections import deque
from collections.abc import Iterator
from typing import TypeVar

from woz_tui.network import driver_line
from woz_tui.network.driver_line import A_TURN, DriverLine, EndSubscription, Presence, Receive
from woz_tui.network.driver_messages import MOST_BYTES

#: Bytes that may wait to be sent, or to be taken.
MOST_WAITING = 4 * MOST_BYTES
#: Before each frame: how long the rest is, its sort, how long its key is.
_HEAD = struct.Struct("<IBH")

log = logging.getLogger(__name__)

_User = TypeVar("_User")


class Sort(enum.IntEnum):
    """What a frame is: one of a driver, or what the two ends of the line say to each other."""

    PLAIN = 0
    URGENT = 1
    BULKY = 2
    #: Which frames, and whose presence, the other side is waiting for, and is not any more.
    RECEIVES = 3
    RECEIVES_NOT = 4
    WATCHES = 5
    WATCHES_NOT = 6
    #: Somebody is here, or is gone.
    HERE = 7
    GONE = 8
    #: How a process is to begin; whether it has, or why not.
    SETUP = 9
    BEGUN = 10
    FAILED = 11


def _framed(sort: Sort, key: str, payload: bytes) -> bytes:
    name = key.encode()
    return _HEAD.pack(len(name) + len(payload), sort, len(name)) + name + payload


class _Stream(asyncio.Protocol):
    """One connection of a line: from its bytes to frames and back."""

    def __init__(self, line: StreamLine) -> None:
        self._line = line
        self._loop = asyncio.get_running_loop()
        self._transport: asyncio.Transport | None = None
        self._bytes = bytearray()
        self._full = False
        self._urgent: deque[bytes] = deque()
        self._plain: deque[bytes] = deque()
        self._plain_bytes = 0
        #: The newest of each key.
        self._bulky: dict[str, bytes] = {}
        self._came: deque[tuple[Sort, str, bytes]] = deque()
        self._came_bytes = 0
        self._due = False

    # -- sending -----------------------------------------------------------------------------

    def send(self, sort: Sort, key: str, payload: bytes) -> bool:
        """Whether there was room."""
        if self._transport is None:
            return False
        frame = _framed(sort, key, payload)
        if sort is Sort.BULKY:
            self._bulky[key] = frame
        elif sort is not Sort.PLAIN:
            self._urgent.append(frame)
        elif (
            len(self._plain) >= driver_line.CAPACITY
            or self._plain_bytes + len(frame) > MOST_WAITING
        ):
            return False
        else:
            self._plain.append(frame)
            self._plain_bytes += len(frame)
        self._flush()
        return True

    def _flush(self) -> None:
        while self._transport is not None and not self._full:
            if self._urgent:
                frame = self._urgent.popleft()
            elif self._plain:
                frame = self._plain.popleft()
                self._plain_bytes -= len(frame)
            elif self._bulky:
                frame = self._bulky.pop(next(iter(self._bulky)))
            else:
                return
            self._transport.write(frame)

    def pause_writing(self) -> None:
        """The socket takes no more for now."""
        self._full = True

    def resume_writing(self) -> None:
        self._full = False
        self._flush()

    def end(self) -> None:
        """What was sent last goes out first."""
        if self._transport is not None:
            self._full = False
            self._bulky.clear()
            self._flush()
            self._transport.close()

    # -- receiving ---------------------------------------------------------------------------

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        assert isinstance(transport, asyncio.Transport)
        transport.set_write_buffer_limits(0)  # what waits, waits here, where it can be overtaken
        self._transport = transport

    def data_received(self, data: bytes) -> None:
        """Urgent frames are handed over at once, of others some in each turn of the loop."""
        self._bytes += data
        for sort, key, payload in self._frames():
            if sort is Sort.PLAIN or sort is Sort.BULKY:
                self._came.append((sort, key, payload))
                self._came_bytes += len(payload)
            else:
                self._line.take(sort, key, payload)
        if self._came and not self._due:
            self._deliver()
        if self._transport is not None and self._crowded:
            with contextlib.suppress(RuntimeError):
                self._transport.pause_reading()

    @property
    def _crowded(self) -> bool:
        return len(self._came) > driver_line.CAPACITY or self._came_bytes > MOST_WAITING

    def _frames(self) -> Iterator[tuple[Sort, str, bytes]]:
        at, held = 0, self._bytes
        while len(held) - at >= _HEAD.size:
            length, sort, named = _HEAD.unpack_from(held, at)
            begin = at + _HEAD.size
            if length > 2 * MOST_BYTES or named > length or sort > Sort.FAILED:
                log.error("what came over a line is no frame: it is closed")
                if self._transport is not None:
                    self._transport.abort()
                at = len(held)
                break
            if len(held) - begin < length:
                break
            key = bytes(held[begin : begin + named]).decode("utf-8", "replace")
            at = begin + length
            yield Sort(sort), key, bytes(held[begin + named : at])
        del held[:at]

    def _deliver(self) -> None:
        self._due = False
        for _ in range(min(len(self._came), A_TURN)):
            sort, key, payload = self._came.popleft()
            self._came_bytes -= len(payload)
            self._line.take(sort, key, payload)
        if self._came:
            self._due = True
            self._loop.call_soon(self._deliver)
        if self._transport is not None and not self._crowded:
            with contextlib.suppress(RuntimeError):
                self._transport.resume_reading()

    def connection_lost(self, exc: Exception | None) -> None:
        """The other side is gone; what it sent before counts."""
        self._transport = None
        while self._came:
            self._deliver()
        self._line.lost(self)


class StreamLine(DriverLine):
    """One end of it. When its connection has ended it can get another one: then everything that was
    asked for through it holds again.
    """

    def __init__(self) -> None:
        self._stream: _Stream | None = None
        self._receivers: dict[str, list[Receive]] = {}
        self._watchers: dict[str, list[Presence]] = {}
        self._shown: set[str] = set()
        #: Who is there.
        self._there: set[str] = set()
        self._ended = asyncio.Event()

    # -- its connection ----------------------------------------------------------------------

    async def attach(self, connected: socket.socket) -> None:
        """Use this connection from now on."""
        loop, stream = asyncio.get_running_loop(), _Stream(self)
        connected.setblocking(False)
        self._ended.clear()
        self._stream = stream
        await loop.connect_accepted_socket(lambda: stream, connected)

    def tell_interests(self) -> None:
        """What is waited for, and who is here, to an other side that does not know it."""
        for key in self._receivers:
            self.put(Sort.RECEIVES, key)
        for key in self._watchers:
            self.put(Sort.WATCHES, key)
        for key in self._shown:
            self.put(Sort.HERE, key)

    @property
    def connected(self) -> bool:
        """Whether the other side is there."""
        return self._stream is not None

    async def ended(self) -> None:
        """Return when the connection is over."""
        await self._ended.wait()

    def lost(self, stream: _Stream) -> None:
        if stream is self._stream:
            self._stream = None
            self._ended.set()

    def nobody_is_there(self) -> None:
        """Tell those who watch."""
        for key in tuple(self._there):
            self._on_presence(key, False)

    def end(self) -> None:
        """Close the connection, after what was sent last."""
        if self._stream is not None:
            self._stream.end()

    # -- what its users call -----------------------------------------------------------------

    def put(self, sort: Sort, key: str, payload: bytes = b"") -> bool:
        """Send a frame; whether there was room."""
        return self._stream is not None and self._stream.send(sort, key, payload)

    def send(self, key: str, payload: bytes, *, urgent: bool = False) -> bool:
        """Have it sent and return at once."""
        return self.put(Sort.URGENT if urgent else Sort.PLAIN, key, payload)

    def send_bulky(self, key: str, payload: bytes) -> None:
        """The same for what may be lost and is long."""
        self.put(Sort.BULKY, key, payload)

    def receive(self, key: str, receive: Receive) -> EndSubscription:
        """Hand over in the running event loop what comes under this key."""
        return self._begin(self._receivers, key, receive, (Sort.RECEIVES, Sort.RECEIVES_NOT))

    def show_presence(self, key: str) -> None:
        """Let the other side notice when this process goes."""
        self._shown.add(key)
        self.put(Sort.HERE, key)

    def watch_presence(self, key: str, presence: Presence) -> EndSubscription:
        """Hear of the other side's coming and going."""
        end = self._begin(self._watchers, key, presence, (Sort.WATCHES, Sort.WATCHES_NOT))
        if key in self._there:
            presence(True)
        return end

    def _begin(
        self, users: dict[str, list[_User]], key: str, user: _User, told: tuple[Sort, Sort]
    ) -> EndSubscription:
        """The other side is told of the first and of the last one who waits for a key."""
        users.setdefault(key, []).append(user)
        if len(users[key]) == 1:
            self.put(told[0], key)

        def end() -> None:
            users[key].remove(user)
            if not users[key]:
                del users[key]
                self.put(told[1], key)

        return end

    # -- what comes --------------------------------------------------------------------------

    def take(self, sort: Sort, key: str, payload: bytes) -> None:
        match sort:
            case Sort.PLAIN | Sort.URGENT | Sort.BULKY:
                if len(payload) <= MOST_BYTES:
                    for receive in tuple(self._receivers.get(key, ())):
                        receive(payload)
            case Sort.HERE | Sort.GONE:
                self._on_presence(key, sort is Sort.HERE)
            case Sort.RECEIVES | Sort.RECEIVES_NOT:  # who waits for it is there
                self._on_presence(key, sort is Sort.RECEIVES)

    def _on_presence(self, key: str, there: bool) -> None:
        if there:
            self._there.add(key)
        else:
            self._there.discard(key)
        for presence in tuple(self._watchers.get(key, ())):
            presence(there)
