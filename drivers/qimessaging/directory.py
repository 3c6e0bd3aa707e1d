"""The service directory of a server of ours: which services there are and where.

Names, numbers and errors are those of libqi's directory; its clients rely on the numbers.
"""

from __future__ import annotations

import itertools
import os
import uuid
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Final

from qimessaging.connection import QiConnection
from qimessaging.endpoints import DIRECTORY, Endpoint, ServiceInfo
from qimessaging.errors import RefusedError
from qimessaging.hosted_objects import HostedMethod, HostedObject, HostedSignal

#: The directory's own number; services have higher ones.
NUMBER: Final = 1

_INFO: Final = (
    "(sIsI[s]ss)<ServiceInfo,name,serviceId,machineId,processId,endpoints,sessionId,objectUid>"
)
#: One process is one machine to the directory: nothing of it is looked for on the real one.
MACHINE: Final = str(uuid.uuid4())


class ServiceDirectory:
    """Knows services of ours and those which clients register."""

    def __init__(self, endpoints: Sequence[Endpoint]) -> None:
        """Begin with the directory itself; `endpoints` are where its server listens now."""
        self._endpoints = endpoints
        self._numbers = itertools.count(NUMBER + 1)
        self._ready: dict[int, ServiceInfo] = {}
        self._pending: dict[int, ServiceInfo] = {}
        self._owners: dict[int, QiConnection] = {}
        self.hosted = HostedObject(
            [  # in the order of libqi's numbers, 100 to 109
                HostedMethod("service", "(s)", _INFO, self._service, with_caller=True),
                HostedMethod("services", "()", f"[{_INFO}]", self._services, with_caller=True),
                HostedMethod(
                    "registerService", f"({_INFO})", "I", self._register, with_caller=True
                ),
                HostedMethod("unregisterService", "(I)", "v", self.remove),
                HostedMethod("serviceReady", "(I)", "v", self._make_ready),
                HostedMethod("updateServiceInfo", f"({_INFO})", "v", self._update),
                HostedSignal("serviceAdded", "(Is)"),
                HostedSignal("serviceRemoved", "(Is)"),
                HostedMethod("machineId", "()", "s", lambda: MACHINE),
            ]
        )
        self._ready[NUMBER] = _ours(DIRECTORY, NUMBER)

    def add(self, name: str) -> int:
        """Add a service of ours; return its number. Raises `RefusedError` where there is one."""
        self._refuse_double(name)
        number = next(self._numbers)
        self._ready[number] = _ours(name, number)
        self.hosted.emit("serviceAdded", number, name)
        return number

    def remove(self, number: int) -> None:
        """Remove a service. Raises `RefusedError` where there is none."""
        found = self._ready.pop(number, None) or self._pending.pop(number, None)
        if found is None:
            raise RefusedError(f"Unregister Service: Can't find service #{number}")
        self._owners.pop(number, None)
        self.hosted.emit("serviceRemoved", number, found.name)

    def number(self, name: str) -> int:
        """Return a service's number. Raises `RefusedError`."""
        for number, info in self._ready.items():
            if info.name == name:
                return number
        raise RefusedError(f"Cannot find service '{name}' in index")

    def owner(self, number: int) -> QiConnection | None:
        """Return the connection over which a client has registered a service."""
        return self._owners.get(number)

    # Methods.

    def _service(self, caller: QiConnection, name: str) -> tuple[Any, ...]:
        return self._described(self._ready[self.number(name)], caller)

    def _services(self, caller: QiConnection) -> list[tuple[Any, ...]]:
        return [self._described(info, caller) for _, info in sorted(self._ready.items())]

    def _register(self, caller: QiConnection, members: tuple[Any, ...]) -> int:
        info = ServiceInfo.of(members)
        self._refuse_double(info.name)
        number = next(self._numbers)
        self._pending[number] = replace(info, service=number)
        if caller not in self._owners.values():
            caller.when_lost(self._remove_all_of)
        self._owners[number] = caller
        return number

    def _make_ready(self, number: int) -> None:
        info = self._pending.pop(number, None)
        if info is None:
            raise RefusedError(f"Can't find pending service #{number}")
        self._ready[number] = info
        self.hosted.emit("serviceAdded", number, info.name)

    def _update(self, members: tuple[Any, ...]) -> None:
        info = ServiceInfo.of(members)
        for services in (self._ready, self._pending):
            if info.service in services and info.service in self._owners:
                services[info.service] = info
                return
        raise RefusedError(f"updateServiceInfo: Can't find service #{info.service}")

    # Inside.

    def _described(self, info: ServiceInfo, caller: QiConnection) -> tuple[Any, ...]:
        """Say where a service of ours is by the address at which the caller has come."""
        if info.service in self._owners:
            return info.members()
        host = caller.address("sockname")[0]
        endpoints = [str(Endpoint(host, each.port, each.tls)) for each in self._endpoints]
        if caller.may("RelativeEndpointURI"):
            endpoints.insert(0, f"qi:{DIRECTORY}")
        return replace(info, endpoints=tuple(endpoints)).members()

    def _refuse_double(self, name: str) -> None:
        for info in (*self._ready.values(), *self._pending.values()):
            if info.name == name:
                raise RefusedError(
                    f'Service "{name}" (#{info.service}) is already registered. '
                    "Rejecting conflicting registration attempt."
                )

    def _remove_all_of(self, caller: QiConnection) -> None:
        for number, owner in tuple(self._owners.items()):
            if owner is caller:
                self.remove(number)


def _ours(name: str, number: int) -> ServiceInfo:
    session = "0" if number == NUMBER else str(uuid.uuid4())
    identity = os.urandom(20)
    return ServiceInfo(name, number, MACHINE, os.getpid(), (), session, identity)
