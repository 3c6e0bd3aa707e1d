"""Objects of the other end: calling their methods, hearing their signals, reading properties."""

from __future__ import annotations

import asyncio
import itertools
from collections.abc import Awaitable, Callable
from typing import Any, Final

from woz_drivers.qimessaging import metaobject
from woz_drivers.qimessaging.connection import Connection
from woz_drivers.qimessaging.decoding import Decoder
from woz_drivers.qimessaging.encoding import encode
from woz_drivers.qimessaging.errors import Cancelled, ProtocolError, Refused, RemoteError
from woz_drivers.qimessaging.frames import DYNAMIC_PAYLOAD, Frame, Kind
from woz_drivers.qimessaging.handshake import error_text
from woz_drivers.qimessaging.metaobject import MetaMethod, MetaObject, MetaSignal
from woz_drivers.qimessaging.signature import parse, parse_members

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

_links = itertools.count(1)


class RemoteObject:
    """One object of the other end: a service, or what a call returned."""

    def __init__(self, connection: Connection, service: int, obj: int, meta: MetaObject) -> None:
        """Stand for the object of these numbers."""
        self.connection = connection
        self.service = service
        self.object = obj
        self.meta = meta

    @classmethod
    async def fetch(cls, connection: Connection, service: int, within: float) -> RemoteObject:
        """Ask a service what it offers. Raises as `call`."""
        this = cls(connection, service, 1, MetaObject())
        reply = await this._ask(META_OBJECT, encode("I", 1), within)
        this.meta = metaobject.read(Decoder(reply.payload))
        return this

    async def call(self, method: str, *args: Any, within: float = WITHIN) -> Any:
        """Call the overload that fits and return its value; objects come as `RemoteObject`.

        Raises:
            Refused: There is no such method, or it does not take these arguments.
            RemoteError: The method failed; the text is the other end's.
            TimedOut: No answer came within that many seconds.
            ConnectionLost: The connection ended.
        """
        chosen = self.meta.choose(method, args)
        reply = await self._ask(chosen.uid, _arguments(chosen, args), within)
        return self._value(reply, chosen.returns)

    async def listen(
        self, signal: str, heard: Callable[..., None], within: float = WITHIN
    ) -> Unsubscribe:
        """Call `heard(*values)` for each time the signal, or the property, is set off.

        Raises as `call`. `heard` runs in the event loop, soon after the event has come.
        """
        found = self.meta.signal(signal)
        parse(found.signature)
        take = self._taker(found, heard)
        source = (self.service, self.object, found.uid)
        link = next(_links)
        self.connection.hear(source, take)
        try:
            # The first number is the service's: libqi sends it, NAOqi expects it.
            payload = encode("(IIL)", (self.service, found.uid, link))
            await self._ask(REGISTER_EVENT, payload, within)
        except BaseException:
            self.connection.unhear(source, take)
            raise

        async def unsubscribe() -> None:
            self.connection.unhear(source, take)
            if not self.connection.lost.done():
                payload = encode("(IIL)", (self.service, found.uid, link))
                await self._ask(UNREGISTER_EVENT, payload, within)

        return unsubscribe

    async def property(self, name: str, within: float = WITHIN) -> Any:
        """Return a property's value. Raises as `call`."""
        uid = self.meta.property(name).uid
        reply = await self._ask(GET_PROPERTY, _dynamic_uid(uid), within)
        return self._value(reply, "m")

    async def set_property(self, name: str, value: Any, within: float = WITHIN) -> None:
        """Set a property. Raises as `call`."""
        uid = self.meta.property(name).uid
        await self._ask(SET_PROPERTY, _dynamic_uid(uid) + encode("m", value), within)

    def release(self) -> None:
        """Tell the other end that this object is no longer needed; not for services."""
        if not self.connection.lost.done():
            payload = encode("I", self.object)
            self.connection.post(self.service, self.object, TERMINATE, payload)

    async def _ask(self, action: int, payload: bytes, within: float) -> Frame:
        answer = await self.connection.ask(self.service, self.object, action, payload, within)
        if answer.kind == Kind.ERROR:
            raise RemoteError(error_text(answer) or "the robot reports an error without a text")
        if answer.kind == Kind.CANCELED:
            raise Cancelled("the robot has cancelled the call")
        return answer

    def _value(self, reply: Frame, returns: str) -> Any:
        wanted = "m" if reply.flags & DYNAMIC_PAYLOAD else returns
        return Decoder(reply.payload, self._make_object).value(wanted)

    def _make_object(self, decoder: Decoder) -> RemoteObject | None:
        return read_object(decoder, self.connection)

    def _taker(self, signal: MetaSignal, heard: Callable[..., None]) -> Callable[[Frame], None]:
        loop = asyncio.get_running_loop()

        def take(frame: Frame) -> None:
            values = self._value(frame, signal.signature)
            if not isinstance(values, tuple):
                values = (values,)  # a property, announced with its value's type alone
            loop.call_soon(heard, *values)

        return take


def read_object(decoder: Decoder, connection: Connection) -> RemoteObject | None:
    """Read an object that was passed; None where it is the null object."""
    meta = metaobject.read(decoder)
    service, obj = decoder.value("I"), decoder.value("I")
    return RemoteObject(connection, service, obj, meta) if obj else None


def _arguments(method: MetaMethod, args: tuple[Any, ...]) -> bytes:
    """Write the arguments. Raises `Refused` where one does not fit."""
    if method.parameters == "m":
        return encode("m", args)
    parts = []
    for at, (kind, value) in enumerate(zip(parse_members(method.parameters), args, strict=True)):
        try:
            parts.append(encode(kind, value))
        except ProtocolError as error:
            raise Refused(f"argument {at + 1} of {method}: {error}") from error
    return b"".join(parts)


def _dynamic_uid(uid: int) -> bytes:
    """Write a property's number as a dynamic value of type `I`, as libqi does."""
    return encode("s", "I") + encode("I", uid)
