"""A client of NAOqi: services are looked up in its directory and called by name."""

from __future__ import annotations

import asyncio
import socket
import ssl
from collections.abc import Callable
from typing import Any, Final, Self

from qimessaging.authentication import Authenticator
from qimessaging.connection import QiConnection
from qimessaging.directory import MACHINE
from qimessaging.endpoints import (
    DIRECTORY,
    Endpoint,
    ServiceInfo,
    is_loopback,
    reachable,
    shares_socket,
)
from qimessaging.errors import (
    CallTimeoutError,
    ConnectionLostError,
    LoginError,
    ProtocolError,
    QiError,
    ServiceLostError,
)
from qimessaging.hosted_objects import HostedObject
from qimessaging.object_host import ObjectHost
from qimessaging.registering import Registration, ServiceListener, describe, register
from qimessaging.remote import RemoteObject, Unsubscribe

DIRECTORY_SERVICE: Final = 1
#: How long looking for a service, or opening, may take, in seconds.
TIMEOUT: Final = 5.0
#: Who calls a service of ours sends at most a second of sound, in bytes. Processes of a robot that
#: connect to it; whoever is in its network may try, too.
_LONGEST_CALL: Final = 1 << 20
_MOST_CALLERS: Final = 16


class NaoqiClient:
    """One client of one directory. All of it belongs to the event loop in which it was opened.

    Attributes:
        lost: Done when the connection to the directory is lost or closed, with the reason in
            words. Services that live elsewhere may be lost before; their calls tell it.
    """

    def __init__(
        self,
        connection: QiConnection,
        authenticator: Authenticator,
        host: ObjectHost,
        timeout: float,
    ) -> None:
        """Use a connection that has let us in; `open` makes it and the rest."""
        self._connection = connection
        self._authenticator = authenticator
        self._host = host
        self._listener = ServiceListener(host, longest=_LONGEST_CALL, most=_MOST_CALLERS)
        self._timeout = timeout
        self._directory = ServiceInfo(DIRECTORY, DIRECTORY_SERVICE, "", 0, (), "")
        self._searches: dict[str, asyncio.Future[RemoteObject]] = {}
        self._elsewhere: dict[Endpoint, QiConnection] = {}
        self.lost: asyncio.Future[str] = connection.lost

    @classmethod
    async def open(
        cls,
        host: str,
        port: int,
        *,
        tls: ssl.SSLContext | None = None,
        user: str = "",
        token: str = "",
        timeout: float = TIMEOUT,  # noqa: ASYNC109 - a setting of the client, too
        prepare: Callable[[socket.socket], None] | None = None,
    ) -> Self:
        """Connect to a directory.

        Args:
            host: A name or an address.
            port: 9559 before NAOqi 2.9, 9503 with TLS from then on.
            tls: How to connect with TLS; None connects without.
            user: The name to log in with; empty where the robot wants no login.
            token: The password.
            timeout: How long opening, and later finding a service, may take, in seconds.
            prepare: Called with the socket of each connection once we are let in: sets options.

        Raises:
            ConnectionLostError: Nobody listens there, TLS does not come about, or it hung up.
            CallTimeoutError: No answer came in time.
            LoginError: The robot does not let us in.
            ProtocolError: Something else listens there.
        """
        services = ObjectHost()
        authenticator = Authenticator(tls, user, token, services.handle, prepare=prepare)
        endpoint = Endpoint(host, port, tls is not None)
        try:
            async with asyncio.timeout(timeout):
                connection = await authenticator.connect(endpoint, timeout)
                client = cls(connection, authenticator, services, timeout)
                await client._begin()
        except TimeoutError:
            raise CallTimeoutError(f"{endpoint} does not answer within {timeout:g} s") from None
        return client

    @property
    def local_host(self) -> str:
        """The address of this machine on the line to the robot."""
        return self._connection.address("sockname")[0]

    @property
    def pending(self) -> int:
        """How many calls over the directory's connection wait for their reply."""
        return self._connection.pending

    async def services(self) -> list[ServiceInfo]:
        """Return what the directory knows. Raises as `RemoteObject.call`."""
        directory = await self.service(DIRECTORY)
        found = await directory.call("services", within=self._timeout)
        if not isinstance(found, list | tuple):
            raise ProtocolError("the directory's services are no list")
        return [ServiceInfo.of(each) for each in found]

    async def service(self, name: str) -> RemoteObject:
        """Return a service, which is looked up once. Raises as `RemoteObject.call`."""
        task = self._searches.get(name)
        if task is None:
            task = asyncio.create_task(self._find(name))
            self._searches[name] = task
            task.add_done_callback(lambda done: self._forget_failed(name, done))
        try:
            return await asyncio.shield(task)
        except asyncio.CancelledError:
            if task.cancelled() and self.lost.done():  # the search was ended, not who waits
                raise ConnectionLostError(self.lost.result()) from None
            raise

    async def call(self, service: str, method: str, *args: Any, within: float) -> Any:
        """Call `service.method(*args)` and return its value; objects come as `RemoteObject`.

        A cancelled call is cancelled on the robot, too, where it lets itself be.

        Raises:
            RefusedError: There is no such service or method, it does not take these arguments, it
                failed (`RemoteError`), or its process has gone (`ServiceLostError`).
            CallTimeoutError: No answer came within that many seconds; a late one is dropped.
            ConnectionLostError: The connection to the directory is lost.
        """
        found, left = await self._service_within(service, within)
        try:
            return await found.call(method, *args, within=left)
        except CallTimeoutError:
            raise CallTimeoutError(
                f"{service}.{method} gave no answer within {within:g} s"
            ) from None
        except ConnectionLostError as error:
            raise self._loss_of(service, error) from error

    async def listen(
        self, service: str, signal: str, listener: Callable[..., None], within: float = TIMEOUT
    ) -> Unsubscribe:
        """Call `listener(*values)` in the loop for each time the signal is emitted.

        Raises as `call`.
        """
        found, left = await self._service_within(service, within)
        try:
            return await found.listen(signal, listener, left)
        except ConnectionLostError as error:
            raise self._loss_of(service, error) from error

    async def property(self, service: str, name: str, within: float = TIMEOUT) -> Any:
        """Return the value of a service's property. Raises as `call`."""
        found, left = await self._service_within(service, within)
        try:
            return await found.property(name, left)
        except ConnectionLostError as error:
            raise self._loss_of(service, error) from error

    async def register(
        self, name: str, hosted: HostedObject, *, listen: bool = True
    ) -> Registration:
        """Register a service of ours, which the robot then calls by its name.

        Args:
            name: Its name at the robot.
            hosted: What it offers.
            listen: Whether processes of the robot may connect to it at this machine's address
                on the line to the robot. Without that only the process of the directory can
                call it, over this connection.

        Raises:
            RefusedError: The name is taken.
            ConnectionLostError: No address to listen on; otherwise as `call`.
        """
        if listen and not self._listener.endpoints:
            try:
                await self._listener.listen(self.local_host, 0)
            except OSError as error:
                raise ConnectionLostError(f"cannot listen on {self.local_host}: {error}") from error
        directory = await self.service(DIRECTORY)
        endpoints = self._listener.endpoints if listen else []
        # On one and the same machine its own name for it is used: libqi does not look for
        # services at 127.0.0.1 of another.
        same = is_loopback(self._connection.address("peername")[0])
        info = describe(name, endpoints, self._directory.machine if same else MACHINE)
        return await register(directory, self._host, info, hosted, self._timeout)

    async def close(self) -> None:
        """Let go. Never raises, never waits for the robot."""
        for task in tuple(self._searches.values()):
            task.cancel()
        for connection in tuple(self._elsewhere.values()):
            connection.end("closed")
        self._connection.end("closed")
        await self._listener.close()
        await self._host.close()
        await asyncio.sleep(0)  # in this turn the loop closes the sockets

    # Inside.

    async def _begin(self) -> None:
        try:
            directory = await RemoteObject.fetch(self._connection, DIRECTORY_SERVICE, self._timeout)
            members = await directory.call("service", DIRECTORY, within=self._timeout)
            self._directory = ServiceInfo.of(members)
            await directory.listen("serviceRemoved", self._removed, self._timeout)
            found = asyncio.get_running_loop().create_future()
            found.set_result(directory)
            self._searches[DIRECTORY] = found
        except ConnectionLostError as error:
            if objection := self._authenticator.objection:
                raise LoginError(f"the robot refuses the login: {objection}") from error
            raise
        except QiError as error:
            self._connection.end(str(error))
            raise
        except BaseException:
            self._connection.end("opening the connection was given up")
            raise

    async def _find(self, name: str) -> RemoteObject:
        directory = await self.service(DIRECTORY)
        info = ServiceInfo.of(await directory.call("service", name, within=self._timeout))
        if shares_socket(info, self._directory):
            connection = self._connection
        else:
            connection = await self._reach(info)
        return await RemoteObject.fetch(connection, info.service, self._timeout)

    async def _reach(self, info: ServiceInfo) -> QiConnection:
        """Connect to the process in which a service lives, where that is not done yet."""
        peer = self._connection.address("peername")[0]
        endpoints = reachable(info, peer, self._authenticator.tls is not None)
        for endpoint in endpoints:
            if endpoint in self._elsewhere:
                return self._elsewhere[endpoint]
        tried = []
        for endpoint in endpoints:
            try:
                return await self._connect_elsewhere(endpoint)
            except (ConnectionLostError, CallTimeoutError) as error:
                tried.append(str(error))
        why = "; ".join(tried) or "the directory names no address that can be reached from here"
        raise ServiceLostError(f"{info.name} cannot be reached: {why}")

    async def _connect_elsewhere(self, endpoint: Endpoint) -> QiConnection:
        connection = await self._authenticator.connect(endpoint, self._timeout)
        if endpoint in self._elsewhere:  # two services of one process were looked up at once
            connection.end("there is another")
            return self._elsewhere[endpoint]
        self._elsewhere[endpoint] = connection
        connection.when_lost(self._drop)
        if self.lost.done():
            connection.end("closed")
        return connection

    def _drop(self, connection: QiConnection) -> None:
        self._elsewhere = {at: one for at, one in self._elsewhere.items() if one is not connection}
        for name, task in tuple(self._searches.items()):
            if _result(task) and task.result().connection is connection:
                del self._searches[name]

    def _forget_failed(self, name: str, task: asyncio.Future[RemoteObject]) -> None:
        if not _result(task) and self._searches.get(name) is task:
            del self._searches[name]

    def _removed(self, *values: Any) -> None:
        """Look a service up again that has left the directory; it may come back elsewhere.

        `values`: its number and its name.
        """
        name = values[1] if len(values) == 2 else None
        if isinstance(name, str) and name != DIRECTORY:
            self._searches.pop(name, None)

    async def _service_within(self, name: str, within: float) -> tuple[RemoteObject, float]:
        task = self._searches.get(name)
        if task is not None and _result(task):
            return task.result(), within
        loop = asyncio.get_running_loop()
        end = loop.time() + within
        try:
            async with asyncio.timeout_at(end):
                found = await self.service(name)
        except TimeoutError:
            raise CallTimeoutError(f"{name} was not found within {within:g} s") from None
        return found, end - loop.time()

    def _loss_of(self, service: str, error: ConnectionLostError) -> QiError:
        if self.lost.done():
            return error
        return ServiceLostError(f"{service} has gone: {error}")


def _result(task: asyncio.Future[RemoteObject]) -> bool:
    """Tell whether a search has found its service (and take its error, if any, as known)."""
    return task.done() and not task.cancelled() and task.exception() is None
