"""One connection to the robot process. Neither its lines in nor those out can delay the robot.

A stop is looked for in whatever has been received; everything else waits for its turn.
"""

from __future__ import annotations

import asyncio
import os
from collections import deque
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import cache
from typing import Any

import msgspec

from woz_tui.bus.hub import Hub, Subscription
from woz_tui.feature import pieces
from woz_tui.gate.table import FeatureGate
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol.requests import (
    AskCheck,
    AskEnd,
    AskMarker,
    AskMistake,
    AskNote,
    AskRelease,
    AskSet,
    AskStop,
    Hello,
    Reply,
    Request,
)
from woz_tui.protocol.sentence import Sentence
from woz_tui.session.recent_messages import RecentMessages, unlisted
from woz_tui.session.redactor import Redactor
from woz_tui.system.clock import Standstill


class RoleView:
    """What a role sees of a session, as it goes on.

    Args:
        redactor: Decides it.
        before: The messages from which it knows what holds, and the last ones of the log.
    """

    def __init__(
        self, redactor: Redactor, before: Iterable[m.Message], recent: Iterable[m.Message]
    ) -> None:
        self.redactor = redactor
        self._recent = RecentMessages()
        self._last: tuple[m.Message | None, m.Message | None] = None, None
        for message in before:
            redactor.apply(message)
        for message in recent:
            self._keep(redactor.message(message))

    def listen(self, hub: Hub) -> None:
        hub.listen(self._remember, but=unlisted())
        hub.listen(self.redactor.apply, *self.redactor.READS)

    def redacted(self, message: m.Message) -> m.Message | None:
        """What this role gets of `message`; None: nothing."""
        if self._last[0] is not message:
            self._last = message, self.redactor.message(message)
        return self._last[1]

    @property
    def recent(self) -> list[m.Message]:
        """The last lines as they were seen."""
        return self._recent.lines

    def _remember(self, message: m.Message) -> None:
        self._keep(self.redacted(message))

    def _keep(self, message: Any) -> None:
        if message is not None:
            self._recent.add(message)


#: Lines that may wait for a client that does not read; then its samples are dropped.
CAPACITY = 4096
#: Bytes that the kernel and asyncio may hold for it before lines begin to wait.
HIGH_WATER = 256 * 1024
#: Requests of all clients together that are carried out in one turn of the loop, and the seconds
#: after which no further one begins.
REQUESTS_A_TURN, TURN_S = 8, 0.005
#: Bytes of requests that are read ahead, to find a stop behind them.
READ_AHEAD = 1 << 20
#: What is carried out although its sender has left: the stop, the end, and what the log is for.
CARRIED_OUT_AFTER_LEAVING = (*(AskStop, AskEnd, AskMarker, AskNote, AskMistake, AskSet, AskCheck),)


@cache
def carried_out_after_leaving() -> tuple[type[Request], ...]:
    """What is carried out although its client has left, of features too."""
    gates = pieces("gate", FeatureGate).values()
    return (*CARRIED_OUT_AFTER_LEAVING, *(kind for gate in gates for kind in gate.after_leaving))


#: Bytes of answers that may wait for a client that asks and asks and never reads.
MOST_WAITING = 8 << 20
#: How long a closed connection may take to deliver what was written, in seconds.
LINGER_S = 1.0


class RequestScheduler:
    """Has waiting requests carried out: so many in one turn of the loop, one of each client after
    the other. However much is asked and by however many, the robot and a stop come in between.
    """

    def __init__(self) -> None:
        self._waiting: deque[ClientConnection] = deque()
        self._under_way = False

    def join(self, client: ClientConnection) -> None:
        """`client` has requests again; unless this turn had its requests, the first begin now."""
        self._waiting.append(client)
        if not self._under_way:
            self._serve()

    def _serve(self) -> None:
        self._under_way = bool(self._waiting)
        if not self._under_way:
            return
        loop = asyncio.get_running_loop()
        loop.call_soon(self._serve)
        until = loop.time() + TURN_S
        for _ in range(REQUESTS_A_TURN):
            client = self._waiting.popleft()
            try:
                client.serve()
            finally:
                if client.waits:
                    self._waiting.append(client)
            if not self._waiting or loop.time() >= until:
                return


def part_text(client: ClientConnection) -> str:
    """What a sentence calls that which this client plays, or would play."""
    return client.part or Sentence("host.robot", "the robot")


def take_over_hint(client: ClientConnection) -> str:
    """How somebody plays although another console does."""
    part = f" --as {client.part}" if client.part else ""
    return Sentence(
        "host.take_over",
        "start `woz attach --take-over{part}` to play {client} here",
        part=part,
        client=part_text(client),
    )


class ClientConnection(asyncio.Protocol):
    """Splits lines, decodes requests, writes what the hub offers.

    Args:
        name: How the log calls this connection: `con1`, `con2` ...
        hub: Source of the stream.
        turns: Decides when a request is carried out.
        standstill: Knows how long what is read now has waited in the socket.
        on_request: Called with each decoded request.
        on_stop: Called with a stop as soon as it has been received; its answer waits for its turn.
        on_close: Called once when the connection has ended.
        recorded: Whether every line so far is in the log; each reply says so.
    """

    def __init__(
        self,
        name: str,
        hub: Hub,
        turns: RequestScheduler,
        standstill: Standstill,
        *,
        on_request: Callable[[ClientConnection, Request], None],
        on_stop: Callable[[ClientConnection, AskStop], None],
        on_close: Callable[[ClientConnection, str], None],
        recorded: Callable[[], bool],
    ) -> None:
        self.name = name
        self.hello: Hello | None = None
        self.role = ""
        #: Which it plays, or would if it played; empty: none in particular.
        self.part = ""
        #: What this client may see; None: all.
        self.view: RoleView | None = None
        self.beat_us = 0
        #: Why it does not watch the robot at the moment; empty: it does, as far as is known.
        self.silent = ""
        #: Whether its terminal is there, as its last beat says.
        self.line_ok = True
        #: Done when the connection has ended.
        self.closed: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._hub = hub
        self._turns = turns
        self._standstill = standstill
        self._on_request = on_request
        self._on_stop = on_stop
        self._on_close = on_close
        self._recorded = recorded
        self._transport: asyncio.Transport | None = None
        self._subscription: Subscription | None = None
        self._rest = bytearray()
        #: Lines that wait, and the answer to a stop that has overtaken those in front of it; each
        #: with the `Clock.boot_us` since which it may have waited, here and in the socket.
        self._lines: deque[tuple[bytes | Reply, int]] = deque()
        self._ahead = 0
        self._overtaken = 0
        self._ended = False
        self._paused = False
        self._wake_due = False
        self._due: list[bytes] = []
        self._why = "closed"

    # -- asyncio -----------------------------------------------------------------------------

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        assert isinstance(transport, asyncio.Transport)
        transport.set_write_buffer_limits(high=HIGH_WATER)
        self._transport = transport

    def connection_lost(self, exc: Exception | None) -> None:
        self._unsubscribe()
        transport, self._transport = self._transport, None
        if exc is not None and transport is not None:
            # Found out by writing: asyncio reads no more, but a stop may have come before.
            self.data_received(_left_unread(transport))
        self.closed.set_result(None)
        self._on_close(self, self._why)

    def eof_received(self) -> bool:
        """It sends no more: what it has sent is carried out and answered, then it is closed."""
        self._ended = True
        if not self._lines:
            self.close("closed")
        return True

    def pause_writing(self) -> None:
        """The peer does not read: lines wait in the subscription, where samples may be dropped."""
        self._paused = True

    def resume_writing(self) -> None:
        self._paused = False
        self._wake()

    def data_received(self, data: bytes) -> None:
        """A stop is pressed at once; other whole lines wait; an over-long one ends the connection.

        Only the last stop overtakes what is in front of it: a thousand are no more than one.
        """
        self._rest += data
        lines: list[bytes] = []
        if b"\n" in data:
            *lines, rest = bytes(self._rest).split(b"\n")
            self._rest = bytearray(rest)
        if len(self._rest) > codec.MAX_LINE:
            lines.append(bytes(self._rest))
            self._rest.clear()
        lines = [line for line in lines if line.strip()]
        idle = not self._lines
        self._ahead += sum(map(len, lines))
        place, stop = _last_stop(lines)
        if stop is not None:
            self._ahead -= len(lines[place])
            self._overtaken = len(self._lines) + place
            self._on_stop(self, stop)
        since_us = self._standstill.since_us() if lines else 0
        self._lines.extend((line, since_us) for line in lines)
        if stop is not None:
            self._lines[self._overtaken] = Reply(ref=stop.ref, ok=True), since_us
        if self._transport is not None and self._ahead > READ_AHEAD:
            self._transport.pause_reading()
        if idle and lines:
            self._turns.join(self)

    @property
    def waits(self) -> bool:
        """Whether it has sent requests that have not been carried out."""
        return bool(self._lines)

    def serve(self) -> None:
        """Carry out the first request that waits."""
        line, since_us = self._lines.popleft()
        overtaken, self._overtaken = self._overtaken > 0, max(0, self._overtaken - 1)
        if isinstance(line, Reply):
            self.send(line)
        else:
            self._ahead -= len(line)
            self._carry_out(line, since_us, overtaken)
        if self._transport is None:
            return
        if self._ahead <= READ_AHEAD:
            self._transport.resume_reading()
        if self._ended and not self._lines:
            self.close("closed")

    def _carry_out(self, line: bytes, since_us: int, overtaken: bool) -> None:
        left = self._transport is None or self._transport.is_closing()
        if len(line) > codec.MAX_LINE:
            self.refuse(
                0,
                Sentence(
                    "host.line_too_long",
                    "a line can have at most {max_line} bytes",
                    max_line=codec.MAX_LINE,
                ),
            )
            self.close("line too long")
            return
        try:
            request = codec.decode_request(line)
        except codec.WireError as error:
            self.refuse(codec.ref_of(line), str(error), "docs/reference/protocol.md")
            return
        if overtaken and isinstance(request, AskRelease):
            # It was sent before the stop, and so not because of it.
            reason = Sentence("host.newer_stop", "a newer stop arrived on the same connection")
            self.refuse(
                request.ref, reason, Sentence("host.release_again", "release the stop again")
            )
        elif not left or isinstance(request, carried_out_after_leaving()):
            if not request.sent_us:
                request = msgspec.structs.replace(request, sent_us=since_us)
            self._on_request(self, request)

    # -- out ---------------------------------------------------------------------------------

    def refuse(self, ref: int, reason: str, hint: str = "", command: str = "") -> None:
        """Answer the request `ref` with why it is not carried out; `hint`: what helps."""
        self.send(Reply(ref=ref, ok=False, reason=reason, hint=hint, command=command))

    def send(self, answer: msgspec.Struct) -> None:
        """An answer to this client alone, after what the stream has already given it."""
        if self._transport is not None:
            if isinstance(answer, Reply) and not self._recorded():
                answer = msgspec.structs.replace(answer, recorded=False)
            self._collect()
            self._due.append(codec.encode(answer))
            self._wake()

    def follow(self, samples: bool) -> None:
        """Give it the stream from here on."""
        redact = self.view.redacted if self.view is not None else None
        self._subscription = self._hub.subscribe(CAPACITY, samples, self._wake, redact)

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
            self.close("the client reads too slowly")

    def _collect(self) -> None:
        if self._subscription is not None and not self._paused:
            self._due += self._subscription.take_all()

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
        self._unsubscribe()
        self._transport.close()
        asyncio.get_running_loop().call_later(LINGER_S, self._abort)

    def _abort(self) -> None:
        # A transport that has delivered everything in the meantime cannot be aborted any more.
        if self._transport is not None:
            self._transport.abort()

    def _unsubscribe(self) -> None:
        if self._subscription is not None:
            self._hub.unsubscribe(self._subscription)
            self._subscription = None


def _last_stop(lines: list[bytes]) -> tuple[int, AskStop | None]:
    """The last stop among `lines` and where it is."""
    for index in reversed(range(len(lines))):
        if b'"stop"' in lines[index] and len(lines[index]) <= codec.MAX_LINE:
            with suppress(codec.WireError):
                request = codec.decode_request(lines[index])
                if isinstance(request, AskStop):
                    return index, request
    return 0, None


def _left_unread(transport: asyncio.Transport) -> bytes:
    """What the peer sent before it left and nobody has read; no more than is read ahead."""
    pieces: list[bytes] = []
    with suppress(OSError):
        file = transport.get_extra_info("socket").fileno()
        while (piece := os.read(file, READ_AHEAD)) and sum(map(len, pieces)) < READ_AHEAD:
            pieces.append(piece)
    return b"".join(pieces)
