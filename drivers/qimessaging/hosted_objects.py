"""Services of ours: their methods, signals and properties, and who listens to them."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Any, Final

from qimessaging.connection import QiConnection
from qimessaging.decoding import ValueDecoder
from qimessaging.encoding import encode
from qimessaging.errors import ProtocolError, RefusedError
from qimessaging.frames import DYNAMIC_PAYLOAD, MessageKind, QiMessage
from qimessaging.metaobject import SIGNATURE, MetaMethod, MetaObject, MetaSignal
from qimessaging.signature import SignatureType, parse, parse_members

#: Numbers below belong to libqi's own methods.
FIRST_UID: Final = 100
#: Registrations of one signal, of all clients together.
_MOST_HEARERS: Final = 1000

_BUILT_IN: Final = (
    MetaMethod(0, "registerEvent", "(IIL)", "L"),
    MetaMethod(1, "unregisterEvent", "(IIL)", "v"),
    MetaMethod(2, "metaObject", "(I)", SIGNATURE),
    MetaMethod(3, "terminate", "(I)", "v"),
    MetaMethod(5, "property", "(m)", "m"),
    MetaMethod(6, "setProperty", "(mm)", "v"),
    MetaMethod(7, "properties", "()", "[s]"),
    MetaMethod(8, "registerEventWithSignature", "(IILs)", "L"),
)


@dataclass(frozen=True, slots=True)
class HostedMethod:
    """A method of a service.

    Attributes:
        name: Its name; several methods of one name are overloads.
        parameters: The signature of its parameters, `(sf)`.
        returns: The signature of what it returns; `v` for nothing.
        function: Called with the arguments; may be a coroutine function. What it raises goes to
            the caller as an error with the exception's text.
        with_caller: Whether the function wants the caller's connection before the arguments.
    """

    name: str
    parameters: str
    returns: str
    function: Callable[..., Any]
    with_caller: bool = False


@dataclass(frozen=True, slots=True)
class HostedSignal:
    """A signal of a service: its name and the signature of its values, `(ff)`."""

    name: str
    signature: str


@dataclass(slots=True)
class HostedProperty:
    """A property of a service.

    Attributes:
        name: Its name.
        signature: The signature of its value, without parentheses.
        value: Its value.
        changed: Called with the new value after a client has set it.
    """

    name: str
    signature: str
    value: Any
    changed: Callable[[Any], None] = field(default=lambda _value: None)


Member = HostedMethod | HostedSignal | HostedProperty


class HostedObject:
    """A service of ours, or an object which a method of ours returns."""

    def __init__(self, members: Iterable[Member]) -> None:
        """Number the members in their order. Raises `ProtocolError` for a wrong signature."""
        self.meta = MetaObject({each.uid: each for each in _BUILT_IN})
        self.methods: dict[int, HostedMethod] = {}
        self.properties: dict[int, HostedProperty] = {}
        self.place: tuple[int, int] | None = None
        self._kinds: dict[int, SignatureType] = {}
        self._uids: dict[str, int] = {}
        self._hearing: dict[int, dict[tuple[QiConnection, int], None]] = {}
        for uid, member in enumerate(members, FIRST_UID):
            self._add(uid, member)
        self.described = self.meta.encoded()

    def emit(self, signal: str, *values: Any) -> None:
        """Emit a signal to all who hear it.

        Raises:
            RefusedError: There is no such signal.
            ProtocolError: The values do not fit it.
        """
        if signal not in self._uids:
            raise RefusedError(f"there is no signal {signal}")
        uid = self._uids[signal]
        payload = encode(self._kinds[uid], values)
        if self.place is None:
            return
        service, obj = self.place
        frame = QiMessage(MessageKind.EVENT, 0, service, obj, uid, payload)
        for connection, _link in tuple(self._hearing.get(uid, ())):
            if not connection.lost.done():
                connection.send(frame)

    def get(self, name: str) -> Any:
        """Return a property's value. Raises `RefusedError`."""
        return self.property(name)[1].value

    def set(self, name: str, value: Any) -> None:
        """Set a property and tell all who hear it. Raises `RefusedError` and `ProtocolError`."""
        _, found = self.property(name)
        encode(found.signature, value)
        found.value = value
        self.emit(name, value)

    def hearers(self, signal: str) -> int:
        """Return how many registrations a signal has. Raises `RefusedError`."""
        if signal not in self._uids:
            raise RefusedError(f"there is no signal {signal}")
        return len(self._hearing.get(self._uids[signal], ()))

    # What `ObjectHost` calls.

    def passed(self) -> bytes:
        """Return this object as it is written into a message; `ObjectHost` gives it its place."""
        if self.place is None:
            raise ProtocolError("an object is returned as such or not at all")
        return self.described + encode("(II)", self.place)

    def withdraw(self) -> None:
        """Be nowhere, and be heard by nobody."""
        self.place = None
        self._hearing.clear()

    def property(self, which: Any) -> tuple[int, HostedProperty]:
        """Return a property by its name or number. Raises `RefusedError`."""
        for uid, found in self.properties.items():
            if which in (uid, found.name):
                return uid, found
        raise RefusedError(f"there is no property {which}")

    def register(self, connection: QiConnection, uid: int, link: int) -> None:
        """Send a signal's events to a connection from now on. Raises `RefusedError`."""
        if uid not in self._kinds:
            raise RefusedError("No such signal")
        hearing = self._hearing.setdefault(uid, {})
        if len(hearing) >= _MOST_HEARERS:
            raise RefusedError("too many registrations")
        hearing[connection, link] = None

    def relay(self, frame: QiMessage) -> bool:
        """Emit a signal of ours which a client sets off; tell whether it is one."""
        meta = self.meta.signals.get(frame.action)
        if meta is None:
            return False
        wanted = "m" if frame.flags & DYNAMIC_PAYLOAD else meta.signature
        values = ValueDecoder(frame.payload).value(wanted)
        if not isinstance(values, tuple | list):
            raise ProtocolError("the values of a signal are no tuple")
        self.emit(meta.name, *values)
        return True

    def unregister(self, connection: QiConnection, link: int | None = None) -> bool:
        """Send no more of it, or nothing at all; tell whether there was something to stop."""
        found = False
        for hearing in self._hearing.values():
            for each in tuple(hearing):
                if each[0] is connection and link in (None, each[1]):
                    del hearing[each]
                    found = True
        return found

    def _add(self, uid: int, member: Member) -> None:
        if isinstance(member, HostedMethod):
            parse_members(member.parameters)
            parse(member.returns)
            self.methods[uid] = member
            self.meta.methods[uid] = MetaMethod(uid, member.name, member.parameters, member.returns)
            return
        whole = member.signature
        if isinstance(member, HostedProperty):
            whole = f"({member.signature})"
            self.properties[uid] = member
            self.meta.properties[uid] = MetaSignal(uid, member.name, member.signature)
        parse_members(whole)
        self.meta.signals[uid] = MetaSignal(uid, member.name, whole)
        self._kinds[uid] = parse(whole)
        self._uids[member.name] = uid
