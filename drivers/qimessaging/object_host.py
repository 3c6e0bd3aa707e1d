"""Answers calls to services and objects of ours, whichever connection they come over."""

from __future__ import annotations

import asyncio
import inspect
import itertools
from collections import Counter
from collections.abc import Awaitable, Callable
from typing import Any, Final

from qimessaging.connection import QiConnection
from qimessaging.decoding import ValueDecoder
from qimessaging.encoding import encode
from qimessaging.errors import ConnectionLostError, ProtocolError, RefusedError
from qimessaging.frames import DYNAMIC_PAYLOAD, RETURN_TYPE, MessageKind, QiMessage
from qimessaging.hosted_objects import FIRST_UID, HostedObject
from qimessaging.metaobject import MetaMethod
from qimessaging.remote import read_object

#: The number of a service's own object; objects it hands out have others.
MAIN: Final = 1


class ObjectHost:
    """All services and objects of ours."""

    def __init__(self) -> None:
        self._objects: dict[tuple[int, int], HostedObject] = {}
        self._holders: dict[tuple[int, int], Counter[QiConnection]] = {}
        self._running: dict[tuple[QiConnection, int], asyncio.Task[None]] = {}
        self._connections: set[QiConnection] = set()
        self._numbers = itertools.count(MAIN + 1)

    def add(self, service: int, hosted: HostedObject) -> None:
        """Offer a service under that number."""
        hosted.place = (service, MAIN)
        self._objects[hosted.place] = hosted

    def remove(self, service: int) -> None:
        """Offer a service no longer, nor the objects it has handed out."""
        for place in tuple(self._objects):
            if place[0] == service:
                self._drop(place)

    def handle(self, connection: QiConnection, frame: QiMessage) -> None:
        """Take a call, a post or that a call is to be cancelled; never raises."""
        if connection not in self._connections:
            self._connections.add(connection)
            connection.when_lost(self._forget)
        try:
            if frame.kind == MessageKind.CANCEL:
                number = ValueDecoder(frame.payload).value("I")
                if (task := self._running.get((connection, number))) is not None:
                    task.cancel()
                return
            hosted = self._objects.get((frame.service, frame.object))
            if hosted is None:
                raise RefusedError(f"there is no object {frame.object} of service {frame.service}")
            if frame.action < FIRST_UID:
                self._answer(connection, frame, self._built_in(connection, hosted, frame))
            else:
                self._call(connection, hosted, frame)
        except (RefusedError, ProtocolError) as error:
            self._refuse(connection, frame, str(error))
        except ConnectionLostError:
            pass  # nobody is left to be answered

    async def close(self) -> None:
        """End all calls that run."""
        running = tuple(self._running.values())
        for task in running:
            task.cancel()
        await asyncio.gather(*running, return_exceptions=True)

    # Methods of ours.

    def _call(self, connection: QiConnection, hosted: HostedObject, frame: QiMessage) -> None:
        method = hosted.methods.get(frame.action)
        if method is None and frame.kind == MessageKind.POST and hosted.relay(frame):
            return
        if method is None:
            raise RefusedError(f"there is no method {frame.action}")
        args, wanted = _arguments(connection, frame, hosted.meta.methods[frame.action])
        if method.with_caller:
            args = (connection, *args)
        returns = wanted or method.returns
        try:
            found = method.function(*args)
        except Exception as error:
            raise RefusedError(_text(error)) from error
        if inspect.isawaitable(found):
            self._run(connection, frame, returns, wanted, found)
        else:
            self._reply(connection, frame, returns, wanted, found)

    def _run(
        self,
        connection: QiConnection,
        frame: QiMessage,
        returns: str,
        wanted: str,
        found: Awaitable[Any],
    ) -> None:
        begun = False

        async def run() -> None:
            nonlocal begun
            begun = True
            try:
                self._reply(connection, frame, returns, wanted, await found)
            except asyncio.CancelledError:
                self._tell_cancelled(connection, frame)
                raise
            except ConnectionLostError:
                pass  # nobody is left to be answered
            except Exception as error:  # noqa: BLE001 - it belongs to the caller
                self._refuse(connection, frame, _text(error))

        def ended(_: asyncio.Task[None]) -> None:
            self._running.pop(key, None)
            if not begun:  # cancelled in the turn in which it came
                if inspect.iscoroutine(found):
                    found.close()
                self._tell_cancelled(connection, frame)

        key = (connection, frame.id)
        task = asyncio.create_task(run())
        self._running[key] = task
        task.add_done_callback(ended)

    def _reply(
        self, connection: QiConnection, frame: QiMessage, returns: str, wanted: str, value: Any
    ) -> None:
        if isinstance(value, HostedObject):
            self._hand_out(connection, frame.service, value)
        payload = encode(returns, value)
        if wanted:
            payload = encode("s", wanted) + payload
        self._answer(connection, frame, payload, DYNAMIC_PAYLOAD if wanted else 0)

    def _answer(
        self, connection: QiConnection, frame: QiMessage, payload: bytes, flags: int = 0
    ) -> None:
        if frame.kind == MessageKind.CALL:
            connection.send(frame.answer(MessageKind.REPLY, payload, flags))

    def _refuse(self, connection: QiConnection, frame: QiMessage, text: str) -> None:
        if frame.kind == MessageKind.CALL and not connection.lost.done():
            connection.send(frame.answer(MessageKind.ERROR, encode("m", _sendable(text))))

    def _tell_cancelled(self, connection: QiConnection, frame: QiMessage) -> None:
        if connection.lost.done() or frame.kind != MessageKind.CALL:
            return
        if connection.may("RemoteCancelableCalls"):
            connection.send(frame.answer(MessageKind.CANCELED))
        else:
            self._refuse(connection, frame, "Call has been canceled.")

    # Methods every object has.

    def _built_in(self, connection: QiConnection, hosted: HostedObject, frame: QiMessage) -> bytes:
        handler = _BUILT_IN.get(frame.action)
        if handler is None:
            raise RefusedError(f"there is no method {frame.action}")
        meta = hosted.meta.methods[frame.action]
        args, _ = _arguments(connection, frame, meta)
        if frame.action == _TERMINATE:
            self._let_go(connection, (frame.service, frame.object), 1)
            return b""
        return handler(connection, hosted, *args)

    # Objects that were handed out, and connections that have gone.

    def _hand_out(self, connection: QiConnection, service: int, hosted: HostedObject) -> None:
        if hosted.place is None:
            hosted.place = (service, next(self._numbers))
        if hosted.place[1] != MAIN:
            self._objects[hosted.place] = hosted
            self._holders.setdefault(hosted.place, Counter())[connection] += 1

    def _let_go(self, connection: QiConnection, place: tuple[int, int], times: int) -> None:
        """Forget an object which the other end was handed as often as it lets go."""
        holders = self._holders.get(place)
        if holders is None:
            return
        holders[connection] -= times
        if not +holders:
            self._drop(place)

    def _drop(self, place: tuple[int, int]) -> None:
        self._holders.pop(place, None)
        hosted = self._objects.pop(place, None)
        if hosted is not None:
            hosted.withdraw()

    def _forget(self, connection: QiConnection) -> None:
        self._connections.discard(connection)
        for hosted in self._objects.values():
            hosted.unregister(connection)
        for place in tuple(self._holders):
            self._let_go(connection, place, self._holders[place][connection])


def _arguments(
    connection: QiConnection, frame: QiMessage, method: MetaMethod
) -> tuple[tuple[Any, ...], str]:
    """Return a call's arguments and the signature it wants for the result, or none."""
    decoder = ValueDecoder(frame.payload, lambda each: read_object(each, connection))
    args = decoder.value("m" if frame.flags & DYNAMIC_PAYLOAD else method.parameters)
    if not isinstance(args, tuple | list):
        raise ProtocolError("the arguments are no tuple")
    if frame.flags & DYNAMIC_PAYLOAD:
        args = ValueDecoder(encode(method.parameters, args)).value(method.parameters)
    wanted = decoder.value("s") if frame.flags & RETURN_TYPE else ""
    return tuple(args), wanted if isinstance(wanted, str) else ""


def _register(connection: QiConnection, hosted: HostedObject, _: int, uid: int, link: int) -> bytes:
    hosted.register(connection, uid, link)
    return encode("L", link)


def _register_with_signature(
    connection: QiConnection,
    hosted: HostedObject,
    service: int,
    uid: int,
    link: int,
    _signature: str,
) -> bytes:
    """Register; the values stay as the signal says, as libqi does where it cannot convert."""
    return _register(connection, hosted, service, uid, link)


def _unregister(
    connection: QiConnection, hosted: HostedObject, _: int, _uid: int, link: int
) -> bytes:
    if not hosted.unregister(connection, link):
        raise RefusedError(f"there is no registration {link}")
    return b""


def _meta_object(_connection: QiConnection, hosted: HostedObject, _: int) -> bytes:
    return hosted.described


def _terminate(_connection: QiConnection, _hosted: HostedObject, _: int) -> bytes:
    return b""


def _get_property(_connection: QiConnection, hosted: HostedObject, which: Any) -> bytes:
    _, found = hosted.property(which)
    return encode("s", found.signature) + encode(found.signature, found.value)


def _set_property(_connection: QiConnection, hosted: HostedObject, which: Any, value: Any) -> bytes:
    _, found = hosted.property(which)
    hosted.set(found.name, value)
    found.changed(value)
    return b""


def _properties(_connection: QiConnection, hosted: HostedObject) -> bytes:
    return encode("[s]", [each.name for each in hosted.properties.values()])


_TERMINATE: Final = 3
_BUILT_IN: Final[dict[int, Callable[..., bytes]]] = {
    0: _register,
    1: _unregister,
    2: _meta_object,
    _TERMINATE: _terminate,
    5: _get_property,
    6: _set_property,
    7: _properties,
    8: _register_with_signature,
}


def _text(error: Exception) -> str:
    return str(error) or type(error).__name__


def _sendable(text: str) -> str:
    return text.encode(errors="replace").decode()
