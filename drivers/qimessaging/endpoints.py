"""Addresses of services: what the directory says, and which of them can be reached."""

from __future__ import annotations

import ipaddress
from dataclasses import astuple, dataclass
from typing import Any, Final
from urllib.parse import urlsplit

from qimessaging.errors import ProtocolError

DIRECTORY: Final = "ServiceDirectory"
#: Addresses of a service that are looked at; a robot has a handful.
_MOST_ENDPOINTS: Final = 32
#: What a directory of today adds to services which its own socket serves.
_SAME_SOCKET: Final = f"qi:{DIRECTORY}"


@dataclass(frozen=True, slots=True)
class Endpoint:
    """One address a service listens on."""

    host: str
    port: int
    tls: bool

    def __str__(self) -> str:
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"{'tcps' if self.tls else 'tcp'}://{host}:{self.port}"


@dataclass(frozen=True, slots=True)
class ServiceInfo:
    """What the directory knows of a service, in the order in which it is sent.

    Attributes:
        identity: 20 bytes that tell objects apart; directories before libqi 1.8 have none.
    """

    name: str
    service: int
    machine: str
    process: int
    endpoints: tuple[str, ...]
    session: str
    identity: str | bytes = ""

    @classmethod
    def of(cls, members: Any) -> ServiceInfo:
        """Take what was decoded, of today's form or of the older without identity.

        Raises `ProtocolError` for anything else.
        """
        if not isinstance(members, tuple | list) or len(members) not in (6, 7):
            raise ProtocolError("the directory does not describe a service as it should")
        name, service, machine, process, endpoints, session, *rest = members
        if not isinstance(endpoints, tuple | list):
            raise ProtocolError("a service's addresses are no list")
        identity = rest[0] if rest else ""
        return cls(
            _name(name),
            _number(service),
            _name(machine),
            _number(process),
            tuple(_name(each) for each in endpoints[:_MOST_ENDPOINTS]),
            _name(session),
            identity if isinstance(identity, str | bytes) else "",
        )

    def members(self) -> tuple[Any, ...]:
        """Return it as it is encoded."""
        return (*astuple(self)[:4], list(self.endpoints), self.session, self.identity)


def _name(value: Any) -> str:
    if isinstance(value, bytes):
        return value.decode(errors="replace")
    if not isinstance(value, str):
        raise ProtocolError("what the directory calls a service is not text")
    return value


def _number(value: Any) -> int:
    if not isinstance(value, int) or not 0 <= value < 1 << 32:
        raise ProtocolError("the directory gives a service no number")
    return value


def shares_socket(service: ServiceInfo, directory: ServiceInfo) -> bool:
    """Tell whether the directory's own connection serves this service, too."""
    if _SAME_SOCKET in service.endpoints:
        return True
    mine = {each for each in service.endpoints if not each.startswith("qi:")}
    its = {each for each in directory.endpoints if not each.startswith("qi:")}
    return bool(mine & its) and service.machine == directory.machine


def reachable(service: ServiceInfo, peer: str, tls: bool) -> list[Endpoint]:
    """Return the addresses to try for a service, the likeliest first.

    Args:
        service: What the directory says.
        peer: The address at which the directory's machine was reached.
        tls: Whether connections with TLS can be opened; without it they are left out.
    """
    readable = [each for each in map(_read, service.endpoints) if each is not None]
    usable = [each for each in readable if tls or not each.tls]
    at_home = is_loopback(peer)
    found = [each for each in usable if at_home or not is_loopback(each.host)]
    # Behind a forwarded port the robot's own addresses lead nowhere, its ports perhaps do.
    found += [Endpoint(peer, each.port, each.tls) for each in usable]
    ranked = sorted(found, key=lambda each: (each.host != peer, not is_loopback(each.host)))
    return list(dict.fromkeys(ranked))


def _read(text: str) -> Endpoint | None:
    """Read `tcp://host:port` or `tcps://..`; others are of no use here."""
    try:
        parts = urlsplit(text)
        host, port = parts.hostname, parts.port
    except ValueError:
        return None
    if parts.scheme not in ("tcp", "tcps") or not host or not port:
        return None
    return Endpoint(host, port, parts.scheme == "tcps")


def is_loopback(host: str) -> bool:
    """Tell whether an address leads to this machine itself."""
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"
