"""Registering a service of ours at a robot, which then calls it.

The robot's processes reach it in two ways. The one that holds the directory calls over the
connection which registered it. All others connect to an address of ours, so a service that is
for them has to listen.
"""

from __future__ import annotations

import contextlib
import os
import uuid
from collections.abc import Awaitable, Callable
from dataclasses import dataclass

from qimessaging.directory import MACHINE
from qimessaging.endpoints import Endpoint, ServiceInfo
from qimessaging.errors import ProtocolError, QiError, Refused
from qimessaging.host import Host
from qimessaging.hosting import Hosted
from qimessaging.remote import RemoteObject
from qimessaging.signature import parse_members

_SESSION = str(uuid.uuid4())


@dataclass(frozen=True, slots=True)
class Registration:
    """A service of ours that is known at a robot's directory.

    Attributes:
        name: Its name there.
        service: Its number there.
        withdraw: Takes it back; never raises.
    """

    name: str
    service: int
    withdraw: Callable[[], Awaitable[None]]


def describe(name: str, endpoints: list[Endpoint], machine: str = MACHINE) -> ServiceInfo:
    """Return what a directory is told of a service of ours, which it will number."""
    addresses = tuple(map(str, endpoints))
    return ServiceInfo(name, 0, machine, os.getpid(), addresses, _SESSION, os.urandom(20))


async def register(
    directory: RemoteObject, host: Host, info: ServiceInfo, hosted: Hosted, within: float
) -> Registration:
    """Make a service known. Raises as `RemoteObject.call`."""
    methods = directory.meta.overloads("registerService")
    wanted = parse_members(methods[0].parameters) if len(methods) == 1 else ()
    if len(wanted) != 1:
        raise Refused("the directory takes no services as it should")
    # Directories from before libqi 1.8 know nothing of an identity.
    members = info.members()[: len(wanted[0].inner)]
    number = await directory.call("registerService", members, within=within)
    if not isinstance(number, int):
        raise ProtocolError("the directory gives a service no number")

    async def withdraw() -> None:
        host.remove(number)
        with contextlib.suppress(QiError):  # it is forgotten at the latest with the connection
            await directory.call("unregisterService", number, within=within)

    host.add(number, hosted)
    try:
        await directory.call("serviceReady", number, within=within)
    except BaseException:
        host.remove(number)
        raise
    return Registration(info.name, number, withdraw)
