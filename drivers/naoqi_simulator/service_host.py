"""Puts the services on the wire, with the server of `qimessaging`."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Mapping, Sequence
from typing import Any

from qimessaging import QiError
from qimessaging import hosted_objects as wire
from qimessaging.server import QiServer

from naoqi_simulator.faults import CallRecord
from naoqi_simulator.service_table import Service, ServiceMethod, methods_of
from naoqi_simulator.world import ConnectedClients


class ServiceHost(ConnectedClients):
    """A server in the running loop."""

    def __init__(self, desk: CallRecord) -> None:
        self._desk = desk
        self._server = QiServer()
        #: Calls that go on although their client is gone or has cancelled them.
        self._going: set[asyncio.Task[Any]] = set()

    async def listen(self, host: str, port: int) -> str:
        """Listen and return the address. Raises OSError when that port cannot be had."""
        return str(await self._server.listen(host, port))

    def offer(self, services: Mapping[str, Service]) -> None:
        """Offer all services; before listening, so that nobody finds one missing."""
        for name, service in services.items():
            methods, signals = self._methods(service), _signals(service)
            hosted = self._server.add(name, methods=methods, signals=signals)
            service.sinks.append(_emitter(hosted))

    async def call(self, service: str, method: str, *args: Any) -> Any:
        """Call a service that a client has registered. Raises LookupError when it cannot."""
        try:
            return await self._server.call(service, method, *args)
        except QiError as error:
            raise LookupError(str(error)) from None

    async def close(self) -> None:
        """Hang up on everybody."""
        for task in self._going:
            task.cancel()
        await self._server.close()

    def _methods(self, service: Service) -> list[wire.HostedMethod]:
        return [
            wire.HostedMethod(one.name, one.takes, one.gives, self._bound(service, one))
            for one in methods_of(service)
        ]

    def _bound(self, service: Service, method: ServiceMethod) -> Callable[..., Awaitable[Any]]:
        async def entered(*args: Any) -> Any:
            task = asyncio.ensure_future(self._carry_out(service, method, args))
            self._going.add(task)
            task.add_done_callback(self._going.discard)
            return await (task if method.cancellable else asyncio.shield(task))

        return entered

    async def _carry_out(self, service: Service, method: ServiceMethod, args: Sequence[Any]) -> Any:
        value = await self._desk.enter(service, method, args)
        if not isinstance(value, Service):
            return value
        hosted = wire.HostedObject([*self._methods(value), *_signals(value)])
        value.sinks.append(_emitter(hosted))
        return hosted


def _signals(service: Service) -> list[wire.HostedSignal]:
    return [wire.HostedSignal(name, signature) for name, signature in service.signals.items()]


def _emitter(hosted: wire.HostedObject) -> Callable[[str, Sequence[Any]], None]:
    return lambda signal, values: hosted.emit(signal, *values)
