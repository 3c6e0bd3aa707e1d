"""One connection: messages go out, replies find their calls, events their listeners.

Both ends use it. What comes in as a call is handed to `incoming`; a connection without it
answers that it serves nothing.
"""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import math
from collections import deque
from collections.abc import Callable, Mapping
from typing import Any, Final, Protocol

from qimessaging.decoding import ValueDecoder
from qimessaging.encoding import encode
from qimessaging.errors import CallTimeoutError, ConnectionLostError, ProtocolError
from qimessaging.frames import LONGEST, MessageKind, QiMessage, QiMessageReader

#: Where an event comes from: service, object, signal.
Source = tuple[int, int, int]

CAPABILITIES: Final[Mapping[str, bool]] = {
    "ClientServerSocket": True,  # calls may come to services of ours over this connection
    "MessageFlags": True,
    "MetaObjectCache": False,
    "RemoteCancelableCalls": True,
    "RelativeEndpointURI": True,  # the directory says which services its own socket serves
}

#: Bytes that may wait for a peer that does not read; after that it is taken for dead.
_MOST_WAITING: Final = 128 << 20

#: Messages are taken for so long without a break, in seconds.
_TURN_S: Final = 0.005

_ANSWERS: Final = frozenset({MessageKind.REPLY, MessageKind.ERROR, MessageKind.CANCELED})
_ASKING: Final = frozenset({MessageKind.CALL, MessageKind.POST, MessageKind.CANCEL})

Incoming = Callable[["QiConnection", QiMessage], None]


class MessageListener(Protocol):
    """Takes the events of one source."""

    def take(self, frame: QiMessage) -> None:
        """Take an event. Raises `ProtocolError` where it is none that can be read."""
        ...


class QiConnection(asyncio.Protocol):
    """One connection. All of it belongs to the event loop in which it was opened."""

    def __init__(self, incoming: Incoming | None = None, longest: int = LONGEST) -> None:
        """Wait for `connection_made`, which the event loop calls."""
        self._incoming = incoming
        self._reader = QiMessageReader(longest)
        self._transport: asyncio.Transport | None = None
        self._numbers = itertools.count(1)
        self._pending: dict[int, asyncio.Future[QiMessage]] = {}
        self._listeners: dict[Source, MessageListener] = {}
        self._capabilities: dict[str, Any] = {}
        self._capabilities_set = asyncio.Event()
        self._reason = ""
        #: Messages that wait for their turn, and why what came behind them is none.
        self._received: deque[QiMessage] = deque()
        self._broken = ""
        self._next: asyncio.Handle | None = None
        self._reads = True
        self.lost: asyncio.Future[str] = asyncio.get_running_loop().create_future()

    # What the event loop calls.

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        assert isinstance(transport, asyncio.Transport)
        self._transport = transport
        if self.lost.done():
            transport.abort()

    def data_received(self, data: bytes) -> None:
        """Take what came; end the connection where it is no qi messaging."""
        if self.lost.done():
            return
        try:
            for frame in self._reader.feed(data):
                self._received.append(frame)
        except ProtocolError as error:
            self._broken = f"the other end does not keep to the protocol: {error}"
        if self._next is None:
            self._process_received(_TURN_S)

    def eof_received(self) -> None:
        """Tell everybody who waits, in this very turn of the loop."""
        self._process_received(math.inf)
        self._finish(self._reason or _loss(None))

    def connection_lost(self, exc: Exception | None) -> None:
        """Tell everybody who waits that the connection broke."""
        self._process_received(math.inf)
        self._finish(self._reason or _loss(exc))

    # What the rest of this package calls.

    def when_lost(self, call: Callable[[QiConnection], object]) -> None:
        """Call with this connection, soon after it is lost."""
        self.lost.add_done_callback(lambda _: call(self))

    @property
    def pending(self) -> int:
        """How many calls wait for their reply."""
        return len(self._pending)

    @property
    def socket(self) -> Any:
        """The connected socket, for options; it is not to be read, written or closed."""
        return self._transport.get_extra_info("socket") if self._transport else None

    def address(self, which: str) -> tuple[str, int]:
        """Return host and port: of the other end (`peername`) or of ours (`sockname`)."""
        found = self._transport.get_extra_info(which) if self._transport else None
        return (str(found[0]), int(found[1])) if found else ("", 0)

    def may(self, capability: str) -> bool:
        """Tell whether both ends can do that."""
        return bool(CAPABILITIES.get(capability)) and self._capabilities.get(capability) is True

    def learn(self, capabilities: Mapping[Any, Any]) -> None:
        """Take what the other end can do."""
        # Nothing else is ever asked for, and a robot could tell new ones for ever.
        self._capabilities |= {
            name: able for name, able in capabilities.items() if name in CAPABILITIES
        }
        self._capabilities_set.set()

    async def capabilities_known(self) -> None:
        """Return once the other end has said what it can do, unasked or not."""
        await self._capabilities_set.wait()

    def send(self, frame: QiMessage) -> None:
        """Send a message. Raises `ConnectionLostError`."""
        if self._transport is None or self._transport.is_closing() or self.lost.done():
            raise ConnectionLostError(self._reason or "the connection is closed")
        self._transport.write(frame.encoded())
        if self._transport.get_write_buffer_size() > _MOST_WAITING:
            self.end("the other end has stopped reading")

    def post(self, service: int, obj: int, action: int, payload: bytes) -> None:
        """Send a call that wants no answer. Raises `ConnectionLostError`."""
        self.send(QiMessage(MessageKind.POST, self._number(), service, obj, action, payload))

    async def ask(
        self, service: int, obj: int, action: int, payload: bytes, within: float
    ) -> QiMessage:
        """Call and return the message that answers: a reply, an error or that it was cancelled.

        A cancelled call is cancelled on the other end, too, where it lets itself be.

        Raises:
            CallTimeoutError: Nothing came within that many seconds; what comes later is dropped.
            ConnectionLostError: The connection ended meanwhile.
        """
        number = self._number()
        answer: asyncio.Future[QiMessage] = asyncio.get_running_loop().create_future()
        self._pending[number] = answer
        frame = QiMessage(MessageKind.CALL, number, service, obj, action, payload)
        try:
            self.send(frame)
            async with asyncio.timeout(within):
                return await answer
        except TimeoutError:
            raise CallTimeoutError(f"no answer within {within:g} s") from None
        except asyncio.CancelledError:
            self._cancel(frame)
            raise
        finally:
            self._pending.pop(number, None)

    def listener(self, source: Source) -> MessageListener | None:
        """Return who takes the events from there."""
        return self._listeners.get(source)

    def add_listener(self, source: Source, listener: MessageListener) -> None:
        """Give all events from there to one, from now on."""
        self._listeners[source] = listener

    def remove_listener(self, source: Source, listener: MessageListener) -> None:
        """Give events from there to this one no longer."""
        if self._listeners.get(source) is listener:
            del self._listeners[source]

    def hang_up(self, reason: str) -> None:
        """Close the connection once what was sent last is out."""
        self._reason = self._reason or reason
        if self._transport is not None:
            self._transport.close()

    def end(self, reason: str) -> None:
        """Close the connection at once; `lost` is done when this returns."""
        self._reason = self._reason or reason
        if self._transport is not None:
            self._transport.abort()
        self._finish(self._reason)

    # Inside.

    def _number(self) -> int:
        return next(self._numbers) & 0xFFFFFFFF

    def _cancel(self, call: QiMessage) -> None:
        if self.may("RemoteCancelableCalls") and not self.lost.done():
            number = encode("I", call.id)
            with contextlib.suppress(ConnectionLostError):  # then it is cancelled in any case
                self.send(
                    QiMessage(
                        MessageKind.CANCEL, self._number(), call.service, call.object, 0, number
                    )
                )

    def _process_received(self, seconds: float) -> None:
        """Take what has come, for so long; go on in the next turn of the loop, and read no more
        until then: an end that sends thousands of messages holds up nobody else.
        """
        self._next = None
        loop = self.lost.get_loop()
        until = loop.time() + seconds
        try:
            while self._received and not self.lost.done():
                with contextlib.suppress(ConnectionLostError):  # nobody is left to be answered
                    self._dispatch(self._received.popleft())
                if self._received and loop.time() > until:
                    self._reading(False)
                    self._next = loop.call_soon(self._process_received, seconds)
                    return
        except ProtocolError as error:
            self.end(f"the other end does not keep to the protocol: {error}")
        if self._broken and not self.lost.done():
            self.end(self._broken)
        self._reading(True)

    def _reading(self, on: bool) -> None:
        if on is self._reads or self._transport is None or self._transport.is_closing():
            return
        self._reads = on
        if on:
            self._transport.resume_reading()
        else:
            self._transport.pause_reading()

    def _dispatch(self, frame: QiMessage) -> None:
        if frame.kind in _ANSWERS:
            answer = self._pending.get(frame.id)
            if answer is not None and not answer.done():
                answer.set_result(frame)
        elif frame.kind == MessageKind.EVENT:
            listener = self._listeners.get((frame.service, frame.object, frame.action))
            if listener is not None:
                listener.take(frame)
        elif frame.kind == MessageKind.CAPABILITY:
            self.learn(ValueDecoder(frame.payload).value("{sm}"))
        elif frame.kind in _ASKING and self._incoming is not None:
            self._incoming(self, frame)
        elif frame.kind == MessageKind.CALL:
            self.send(frame.answer(MessageKind.ERROR, encode("m", "there are no services here")))

    def _finish(self, reason: str) -> None:
        if self.lost.done():
            return
        self._reason = reason
        self.lost.set_result(reason)
        for answer in self._pending.values():
            if not answer.done():
                answer.set_exception(ConnectionLostError(reason))
        self._listeners.clear()
        self._received.clear()
        if self._next is not None:
            self._next.cancel()


def _loss(error: Exception | None) -> str:
    if error is None:
        return "the other end has closed the connection"
    return f"the connection broke: {error}"
