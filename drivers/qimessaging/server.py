"""A server: services of ours with a directory of their own, for clients of any make.

    server = QiServer()
    speech = server.add(
        "ALTextToSpeech",
        methods=[
            HostedMethod("say", "(s)", "v", say),
            HostedMethod("getVolume", "()", "f", volume),
        ],
        signals=[HostedSignal("textDone", "()")],
    )
    endpoint = await server.listen("127.0.0.1", 9559)
    server.emit("ALTextToSpeech", "textDone")     # or speech.emit("textDone")
    await server.close()

Functions may be coroutine functions: each call is a task of its own, so that a slow one holds up
nobody. Plain functions run at once, in the order in which the calls come, and must not block.
"""

from __future__ import annotations

import ssl
from collections.abc import Iterable
from typing import Any

from qimessaging import directory
from qimessaging.directory import ServiceDirectory
from qimessaging.endpoints import Endpoint
from qimessaging.errors import RefusedError
from qimessaging.frames import LONGEST
from qimessaging.hosted_objects import (
    HostedMethod,
    HostedObject,
    HostedProperty,
    HostedSignal,
    Member,
)
from qimessaging.object_host import ObjectHost
from qimessaging.registering import Authenticator, ServiceListener
from qimessaging.remote import WITHIN, RemoteObject


class QiServer:
    """Services under names. All of it belongs to the event loop in which it listens."""

    def __init__(
        self, *, authenticator: Authenticator | None = None, longest: int = LONGEST
    ) -> None:
        """Begin with the directory alone.

        Args:
            authenticator: Told name and token, says who is let in; None lets everybody in.
            longest: The longest message accepted, in bytes.
        """
        self._host = ObjectHost()
        self._listener = ServiceListener(self._host, authenticator, longest)
        self._directory = ServiceDirectory(self._listener.endpoints)
        self._host.add(directory.NUMBER, self._directory.hosted)
        self._services: dict[str, tuple[int, HostedObject]] = {}
        self._called: dict[int, RemoteObject] = {}

    def add(
        self,
        name: str,
        *,
        methods: Iterable[HostedMethod] = (),
        signals: Iterable[HostedSignal] = (),
        properties: Iterable[HostedProperty] = (),
    ) -> HostedObject:
        """Offer a service; also while listening.

        Raises:
            RefusedError: There is a service of that name.
            ProtocolError: A signature is wrong.
        """
        members: list[Member] = [*methods, *signals, *properties]
        hosted = HostedObject(members)
        number = self._directory.add(name)
        self._host.add(number, hosted)
        self._services[name] = (number, hosted)
        return hosted

    def remove(self, name: str) -> None:
        """Offer a service no longer. Raises `RefusedError` where it is none of ours."""
        if name not in self._services:
            raise RefusedError(f"there is no service {name}")
        number, _ = self._services.pop(name)
        self._host.remove(number)
        self._directory.remove(number)

    async def listen(
        self, host: str, port: int = 0, *, tls: ssl.SSLContext | None = None
    ) -> Endpoint:
        """Listen on an address, and on another with each further call.

        Args:
            host: An address of this machine.
            port: 0 takes a free one.
            tls: Listens with TLS by these certificates.

        Returns:
            Where it listens; as text `tcp://127.0.0.1:9559`, or `tcps://..` with TLS.

        Raises:
            OSError: The address is taken or is none of this machine's.
        """
        return await self._listener.listen(host, port, tls)

    def emit(self, service: str, signal: str, *values: Any) -> None:
        """Emit a signal of a service. Raises as `HostedObject.emit`."""
        if service not in self._services:
            raise RefusedError(f"there is no service {service}")
        self._services[service][1].emit(signal, *values)

    async def call(self, service: str, method: str, *args: Any, within: float = WITHIN) -> Any:
        """Call a service which a client has registered here, over that client's connection.

        Raises as `RemoteObject.call`.
        """
        number = self._directory.number(service)
        owner = self._directory.owner(number)
        if owner is None:
            raise RefusedError(f"{service} is no service of a client")
        found = self._called.get(number)
        if found is None:
            found = await RemoteObject.fetch(owner, number, within)
            self._called[number] = found
            owner.lost.add_done_callback(lambda _: self._called.pop(number, None))
        return await found.call(method, *args, within=within)

    async def close(self) -> None:
        """End all connections and all calls that run. Never raises."""
        await self._listener.close()
        await self._host.close()
