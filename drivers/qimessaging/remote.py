"""Objects of the other end: calling their methods, hearing their signals, reading properties."""

from __future__ import annotations

import asyncio
import itertools
import logging
from collections.abc import Awaitable, Callable
from typing import Any, Final

from qimessaging import metaobject
from qimessaging.authentication import error_text
from qimessaging.connection import QiConnection
from qimessaging.decoding import ValueDecoder
from qimessaging.encoding import encode
from qimessaging.errors import CallCancelledError, ProtocolError, RefusedError, RemoteError
from qimessaging.frames import DYNAMIC_PAYLOAD, MessageKind, QiMessage
from qimessaging.metaobject import MetaMethod, MetaObject, MetaSignal
from qimessaging.signature import SignatureType, parse, parse_members

#: Takes back what was subscribed. Raises nothing where the connection is lost.
Unsubscribe = Callable[[], Awaitable[None]]

REGISTER_EVENT: Final = 0
UNREGISTER_EVENT: Final = 1
META_OBJECT: Final = 2
TERMINATE: Final = 3
GET_PROPERTY: Final = 5
SET_PROPERTY: Final = 6

#: How long the other end may take for what needs no time, in seconds.
WITHIN: Final = 5.0
#: How long a service that is ready may still refuse to describe itself, and how often it is
#: asked meanwhile, in seconds.
_SETTLING: Final = 1.0
_PAUSE: Final = 0.01

_links = itertools.count(1)

log = logging.getLogger(__name__)


class RemoteObject:
    """One object of the other end: a service, or what a call returned."""

    def __init__(self, connection: QiConnection, service: int, obj: int, meta: MetaObject) -> None:
        """Stand for the object of these numbers."""
        self.connection = connection
        self.service = service
        self.object = obj
        self.meta = meta

    @classmethod
    async def fetch(cls, connection: QiConnection, service: int, within: float) -> RemoteObject:
        """Ask a service what it offers. Raises as `call`."""
        this = cls(connection, service, 1, MetaObject())
        reply = await this._described(within)
        this.meta = metaobject.read(ValueDecoder(reply.payload))
        return this

    async def _described(self, within: float) -> QiMessage:
        """Ask again where a service does not answer for itself yet.

        libqi tells the directory that a service is ready while another thread of it still makes
        the service known to its connections; until then calls are refused.
        """
        loop = asyncio.get_running_loop()
        end = loop.time() + min(within, _SETTLING)
        while True:
            try:
                return await self.ask(META_OBJECT, encode("I", 1), within)
            except RemoteError:
                if loop.time() >= end:
                    raise
                await asyncio.sleep(_PAUSE)

    async def call(self, method: str, *args: Any, within: float = WITHIN) -> Any:
        """Call the overload that fits and return its value; objects come as `RemoteObject`.

        Raises:
            RefusedError: There is no such method, or it does not take these arguments.
            RemoteError: The method failed; the text is the other end's.
            CallTimeoutError: No answer came within that many seconds.
            ConnectionLostError: The connection ended.
        """
        chosen = self.meta.choose(method, args)
        reply = await self.ask(chosen.uid, _arguments(chosen, args), within)
        return self.values(reply, chosen.returns)

    async def listen(
        self, signal: str, heard: Callable[..., None], within: float = WITHIN
    ) -> Unsubscribe:
        """Call `heard(*values)` for each time the signal, or the property, is set off.

        Raises as `call`. `heard` runs in the event loop, soon after the event has come.
        """
        found = self.meta.signal(signal)
        hearing = self.connection.listener((self.service, self.object, found.uid))
        if not isinstance(hearing, SignalSubscription):
            hearing = SignalSubscription(self, found, within)
        return await hearing.join(heard)

    async def property(self, name: str, within: float = WITHIN) -> Any:
        """Return a property's value. Raises as `call`."""
        uid = self.meta.property(name).uid
        reply = await self.ask(GET_PROPERTY, _dynamic_uid(uid), within)
        return self.values(reply, "m")

    async def set_property(self, name: str, value: Any, within: float = WITHIN) -> None:
        """Set a property. Raises as `call`."""
        uid = self.meta.property(name).uid
        await self.ask(SET_PROPERTY, _dynamic_uid(uid) + encode("m", value), within)

    def release(self) -> None:
        """Tell the other end that this object is no longer needed; not for services."""
        if not self.connection.lost.done():
            payload = encode("I", self.object)
            self.connection.post(self.service, self.object, TERMINATE, payload)

    async def ask(self, action: int, payload: bytes, within: float) -> QiMessage:
        """Call the action of that number and return its reply. Raises as `call`."""
        answer = await self.connection.ask(self.service, self.object, action, payload, within)
        if answer.kind == MessageKind.ERROR:
            raise RemoteError(error_text(answer) or "the robot reports an error without a text")
        if answer.kind == MessageKind.CANCELED:
            raise CallCancelledError("the robot has cancelled the call")
        return answer

    def values(self, reply: QiMessage, returns: SignatureType | str) -> Any:
        """Read what a message from this object holds. Raises `ProtocolError`."""
        wanted = "m" if reply.flags & DYNAMIC_PAYLOAD else returns
        return ValueDecoder(reply.payload, self._make_object).value(wanted)

    def _make_object(self, decoder: ValueDecoder) -> RemoteObject | None:
        return read_object(decoder, self.connection)


class SignalSubscription:
    """One signal of one object: registered once over there, for all who listen here.

    The other end sends an event once for each registration; with one a listener, every event
    would be heard by each as many times as there are listeners.
    """

    def __init__(self, remote: RemoteObject, signal: MetaSignal, within: float) -> None:
        """Register for the signal. Raises `ProtocolError` for types that cannot be read."""
        self._kind = parse(signal.signature)
        self._remote = remote
        self._uid = signal.uid
        self._link = next(_links)
        self._listeners: list[Callable[..., None]] = []
        self._odd = False
        self._source = (remote.service, remote.object, signal.uid)
        self._loop = asyncio.get_running_loop()
        remote.connection.add_listener(self._source, self)
        self._registered = asyncio.create_task(self._register(within))
        # Whoever waited for it may have given up; then its error is nobody's.
        self._registered.add_done_callback(lambda task: task.cancelled() or task.exception())

    async def join(self, heard: Callable[..., None]) -> Unsubscribe:
        """Add a listener; return when the other end knows. Raises as `RemoteObject.call`."""

        def listener(*values: Any) -> None:
            heard(*values)

        self._listeners.append(listener)
        try:
            await asyncio.shield(self._registered)
        except BaseException:
            if self._leave(listener):
                self._take_back()
            raise

        async def unsubscribe() -> None:
            if self._leave(listener) and not self._remote.connection.lost.done():
                await self._remote.ask(UNREGISTER_EVENT, self._registration(), WITHIN)

        return unsubscribe

    async def _register(self, within: float) -> None:
        try:
            await self._remote.ask(REGISTER_EVENT, self._registration(), within)
        except BaseException:
            self._remote.connection.remove_listener(self._source, self)
            raise

    def _registration(self) -> bytes:
        # The first number is the service's: libqi sends it, NAOqi expects it.
        return encode("(IIL)", (self._remote.service, self._uid, self._link))

    def _leave(self, listener: Callable[..., None]) -> bool:
        """Forget a listener; tell whether it was the last."""
        if listener not in self._listeners:
            return False
        self._listeners.remove(listener)
        if self._listeners:
            return False
        self._remote.connection.remove_listener(self._source, self)
        return True

    def _take_back(self) -> None:
        """Take back a registration which is under way, without waiting: it was given up."""
        failed = self._registered.done() and self._registered.exception() is not None
        connection = self._remote.connection
        if not failed and not connection.lost.done():
            connection.post(
                self._remote.service, self._remote.object, UNREGISTER_EVENT, self._registration()
            )

    def take(self, frame: QiMessage) -> None:
        """Hand an event's values to all listeners; one that holds others is left out."""
        try:
            values = self._remote.values(frame, self._kind)
        except ProtocolError as error:
            if not self._odd:  # the line itself is whole: one odd signal must not end it
                log.warning("events of %s are left out: %s", self._source, error)
            self._odd = True
            return
        if not isinstance(values, tuple):
            values = (values,)  # a property, announced with its value's type alone
        for listener in tuple(self._listeners):
            # Soon instead of at once: what a listener raises is its own trouble, not the line's.
            self._loop.call_soon(listener, *values)


def read_object(decoder: ValueDecoder, connection: QiConnection) -> RemoteObject | None:
    """Read an object that was passed; None where it is the null object."""
    meta = metaobject.read(decoder)
    service, obj = decoder.value("I"), decoder.value("I")
    return RemoteObject(connection, service, obj, meta) if obj else None


def _arguments(method: MetaMethod, args: tuple[Any, ...]) -> bytes:
    """Write the arguments. Raises `RefusedError` where one does not fit."""
    if method.parameters == "m":
        return encode("m", args)
    parts = []
    for at, (kind, value) in enumerate(zip(parse_members(method.parameters), args, strict=True)):
        try:
            parts.append(encode(kind, value))
        except ProtocolError as error:
            raise RefusedError(f"argument {at + 1} of {method}: {error}") from error
    return b"".join(parts)


def _dynamic_uid(uid: int) -> bytes:
    """Write a property's number as a dynamic value of type `I`, as libqi does."""
    return encode("s", "I") + encode("I", uid)
