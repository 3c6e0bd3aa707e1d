"""The simulated Pepper with libqi, the robot's own library, at its end of the wire.

`python -m tests.fakes.naoqi_by_libqi` takes what `python -m naoqi_simulator` takes.
"""

from __future__ import annotations

import asyncio
import os
import sys
from collections.abc import Callable, Coroutine, Mapping, Sequence
from typing import Any

from naoqi_simulator.faults import CallRecord
from naoqi_simulator.service_table import CallRefusedError, Service, ServiceMethod, methods_of
from naoqi_simulator.simulator_process import main
from naoqi_simulator.world import ConnectedClients


class QiHost(ConnectedClients):
    """A listening session. Calls come in threads of the library and are carried out in our loop.

    The library cannot put bytes into a value of any type (`m`): pictures come as a typed tuple, and
    sound reaches only a `processRemote` that is declared to take raw data (`r`).
    """

    def __init__(self, desk: CallRecord) -> None:
        # Before the import: the library writes its log to standard output.
        os.environ.setdefault("QI_LOG_LEVEL", "0")
        import qi  # noqa: PLC0415 - not installed everywhere

        self._qi: Any = qi
        self._desk, self._loop = desk, asyncio.get_running_loop()
        self._session: Any = qi.Session()
        self._objects: list[Any] = []
        self._services: dict[str, Service] = {}

    async def listen(self, host: str, port: int) -> str:
        """Listen and return the address. Raises OSError when that port cannot be had."""
        try:
            self._session.listenStandalone(f"tcp://{host}:{port}")
        except RuntimeError as error:
            raise OSError(f"cannot listen on {host}:{port}: {error}") from None
        self._register()
        return str(self._session.endpoints()[0])

    def offer(self, services: Mapping[str, Service]) -> None:
        """Offer all services as soon as it listens: the library takes them no earlier."""
        self._services = dict(services)

    def _register(self) -> None:
        for name, service in self._services.items():
            self._session.registerService(name, self._object(service))

    async def close(self) -> None:
        """Hang up on everybody."""
        self._session.close()

    async def call(self, service: str, method: str, *args: Any) -> Any:
        """Call a service that a client has registered. Raises LookupError when there is none."""
        try:
            proxy = await self._wait(self._session.service(service, _async=True))
        except RuntimeError:
            raise LookupError(service) from None
        return await self._wait(proxy.call(method, *args, _async=True))

    async def _wait(self, future: Any) -> Any:
        waiting: asyncio.Future[Any] = self._loop.create_future()

        def done(ended: Any) -> None:
            self._loop.call_soon_threadsafe(_settle, waiting, ended)

        future.addCallback(done)
        return await waiting

    def _object(self, service: Service) -> Any:
        """An object of a class made for this service: the library looks at classes for methods."""
        members: dict[str, Any] = {"__qi_threading__": "multi"}
        for number, method in enumerate(methods_of(service)):
            members[f"{method.name}_{number}"] = self._bound(service, method)
        made = type(service.name, (), members)()
        for signal, signature in service.signals.items():
            setattr(made, signal, self._qi.Signal(signature))
        service.sinks.append(lambda signal, *values: getattr(made, signal)(*values))
        self._objects.append(made)
        return made

    def _bound(self, service: Service, method: ServiceMethod) -> Callable[..., Any]:
        def entered(_self: Any, *args: Any) -> Any:
            return self._start(self._carry_out(service, method, args), method.cancellable)

        entered.__name__ = method.name
        vars(entered).update(
            __qi_name__=method.name,
            __qi_signature__=method.takes,
            __qi_return_signature__=method.gives_typed,
        )
        return entered

    async def _carry_out(self, service: Service, method: ServiceMethod, args: Sequence[Any]) -> Any:
        value = await self._desk.enter(service, method, args)
        return self._object(value) if isinstance(value, Service) else value

    def _start(self, work: Coroutine[Any, Any, Any], cancellable: bool) -> Any:
        """Begin in our loop; the future that the library waits for."""
        running: list[asyncio.Task[Any]] = []

        def cancel(_promise: Any) -> None:
            if cancellable:
                self._loop.call_soon_threadsafe(lambda: [task.cancel() for task in running])

        promise = self._qi.Promise(cancel)
        self._loop.call_soon_threadsafe(
            lambda: running.append(asyncio.ensure_future(_into(promise, work)))
        )
        return promise.future()


async def _into(promise: Any, work: Coroutine[Any, Any, Any]) -> None:
    """Put how the work ended into a promise of the library."""
    try:
        value = await work
    except asyncio.CancelledError:
        promise.setCanceled()
    except CallRefusedError as refused:
        promise.setError(str(refused))
    else:
        promise.setValue(value)


def _settle(waiting: asyncio.Future[Any], ended: Any) -> None:
    if waiting.done():
        return
    if ended.hasError():
        waiting.set_exception(RuntimeError(ended.error()))
    else:
        waiting.set_result(ended.value())


if __name__ == "__main__":
    # The library calls from threads of its own; a real robot has no interpreter to wait for.
    sys.setswitchinterval(0.0005)
    sys.exit(main(hosting=QiHost))
