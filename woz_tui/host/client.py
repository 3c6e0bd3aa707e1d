"""One connection to the robot process: lines in, lines out, and neither can hold up the robot."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Callable

import msgspec

from woz_tui.core import wire
from woz_tui.core.hub import Hub, Subscription
from woz_tui.core.requests import AnyRequest, Hello, Reply

#: Lines that may wait for a client that does not read; then its samples are dropped.
CAPACITY = 4096
#: Bytes that the kernel and asyncio may hold for it before lines begin to wait.
HIGH_WATER = 256 * 1024
#: Requests of one client that are carried out before all others have their turn.
REQUESTS_A_TURN = 64
#: Bytes of answers that may wait for a client that asks and asks and never reads.
MOST_WAITING = 8 << 20
#: How long a closed connection may take to deliver what was written, in seconds.
LINGER_S = 1.0


class Client(asyncio.Protocol):
    """Splits lines, decodes requests, writes what the hub offers.

    Args:
        name: How the log calls this connection: `con1`, `con2` ...
        hub: Source of the stream.
        on_request: Called with each decoded request.
        on_gone: Called once when the connection has ended.
    """

    def __init__(
        self,
        name: str,
        hub: Hub,
        on_request: Callable[[Client, AnyRequest], None],
        on_gone: Callable[[Client, str], None],
    ) -> None:
        self.name = name
        self.hello: Hello | None = None
        self.role = ""
        self.beat_us = 0
        self.silent = False
        #: Done when the connection has ended.
        self.gone: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._hub = hub
        self._on_request = on_request
        self._on_gone = on_gone
        self._transport: asyncio.Transport | None = None
        self._subscription: Subscription | None = None
        self._rest = b""
        self._lines: deque[bytes] = deque()
        self._paused = False
        self._wake_due = False
        self._due: list[bytes] = []
        self._why = "closed"

    # -- asyncio -----------------------------------------------------------------------------

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """The peer is there."""
        assert isinstance(transport, asyncio.Transport)
        transport.set_write_buffer_limits(high=HIGH_WATER)
        self._transport = transport

    def connection_lost(self, exc: Exception | None) -> None:
        """The peer is gone."""
        if self._subscription is not None:
            self._hub.unsubscribe(self._subscription)
            self._subscription = None
        self._transport = None
        self.gone.set_result(None)
        self._on_gone(self, self._why)

    def pause_writing(self) -> None:
        """The peer does not read: lines wait in the subscription, where samples may be dropped."""
        self._paused = True

    def resume_writing(self) -> None:
        """It reads again."""
        self._paused = False
        self._wake()

    def data_received(self, data: bytes) -> None:
        """Whole lines become requests at once; an over-long line ends the connection."""
        *lines, self._rest = (self._rest + data).split(b"\n")
        self._lines.extend(lines)
        if len(self._rest) > wire.MAX_LINE:
            self._lines.append(self._rest)
        self._work()

    def _work(self) -> None:
        """Some requests now, the others when everybody else has had a turn; until then no more."""
        for _ in range(min(len(self._lines), REQUESTS_A_TURN)):
            line = self._lines.popleft()
            if line.strip():
                self._line(line)
        if self._transport is None:
            self._lines.clear()
        elif self._lines:
            self._transport.pause_reading()
            asyncio.get_running_loop().call_soon(self._work)
        else:
            self._transport.resume_reading()

    def _line(self, line: bytes) -> None:
        if self._transport is None or self._transport.is_closing():
            return
        if len(line) > wire.MAX_LINE:
            self.send(Reply(ref=0, ok=False, reason=f"a line may have {wire.MAX_LINE} bytes"))
            self.close("line too long")
            return
        try:
            request = wire.decode_request(line)
        except wire.WireError as error:
            self.send(
                Reply(ref=wire.ref_of(line), ok=False, reason=str(error), hint="docs/protocol.md")
            )
            return
        self._on_request(self, request)

    # -- out ---------------------------------------------------------------------------------

    def send(self, answer: msgspec.Struct) -> None:
        """An answer to this client alone, after what the stream has already given it."""
        if self._transport is not None:
            self._collect()
            self._due.append(wire.encode(answer))
            self._wake()

    def follow(self, samples: bool) -> None:
        """Give it the stream from here on."""
        self._subscription = self._hub.subscribe(CAPACITY, samples, self._wake)

    @property
    def dropped(self) -> int:
        """Samples it did not get because it was too slow."""
        return self._subscription.dropped if self._subscription is not None else 0

    def _wake(self) -> None:
        """Write in the loop's next turn but one: all of its messages in one packet.

        The jobs and stops that a request sets in motion run in the next turn. They come first: a
        console that has been written to wakes up and competes for the processor.
        """
        if not self._wake_due:
            self._wake_due = True
            loop = asyncio.get_running_loop()
            loop.call_soon(loop.call_soon, self._write)

    def _write(self) -> None:
        self._wake_due = False
        self._flush()
        transport, subscription = self._transport, self._subscription
        overrun = subscription is not None and subscription.overrun
        if transport and (overrun or transport.get_write_buffer_size() > MOST_WAITING):
            self.close("too slow")

    def _collect(self) -> None:
        if self._subscription is not None and not self._paused:
            self._due += self._subscription.take()

    def _flush(self) -> None:
        self._collect()
        if self._due and self._transport is not None:
            self._transport.write(b"".join(self._due))
        self._due.clear()

    def close(self, why: str) -> None:
        """End the connection; what was sent before still goes out, if it is read soon."""
        if self._transport is None or self._transport.is_closing():
            return
        self._why = why
        self._flush()
        self._transport.close()
        asyncio.get_running_loop().call_later(LINGER_S, self._transport.abort)
