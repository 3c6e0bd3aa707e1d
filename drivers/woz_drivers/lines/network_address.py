"""Host and port of a robot in the network, as a robot file has them."""

from __future__ import annotations

import re

from woz_tui.drivers.contract import RejectedError

#: IPv6 in brackets or a name without a colon; then a port.
_PLACE = re.compile(
    r"(?:\[(?P<six>[0-9A-Fa-f:.]+(?:%[\w.-]+)?)\]|(?P<name>[^:\[\]]+))(?::(?P<port>[^:]*))?"
)
_NAME = re.compile(r"[A-Za-z0-9_](?:[A-Za-z0-9_.-]{0,251}[A-Za-z0-9_.])?")


def host_and_port(place: str, usual: int, examples: str) -> tuple[str, int]:
    """Host (IPv6 without brackets) and port of `place`; the port is `usual` if there is none.

    Raises `RejectedError` with what is wrong, and `examples` as its remedy. Nothing of `place`,
    which may hold a password, is repeated.
    """
    if "/" in place:
        raise RejectedError("this is an address of a page", f"leave out http:// and /; {examples}")
    found = _PLACE.fullmatch(place)
    if found is None:
        if place.count(":") > 1 and "[" not in place:
            raise RejectedError(
                "an IPv6 address stands in brackets", f"write [ADDRESS] or [ADDRESS]:{usual}"
            )
        raise RejectedError("this is no address of a robot", examples)
    host = found["six"] or found["name"]
    if (found["six"] is None and not _NAME.fullmatch(host)) or ".." in host:
        raise RejectedError("this is no name of a host", examples)
    return host, usual if found["port"] is None else _port(found["port"], examples)


def _port(text: str, examples: str) -> int:
    if text.isascii() and text.isdigit() and len(text) <= 5 and 1 <= int(text) <= 65535:
        return int(text)
    raise RejectedError("what stands after the host is no port: 1 to 65535", examples)


def joined(host: str, port: int) -> str:
    """`host:port`, with IPv6 in brackets, as an URL has it."""
    return f"[{host}]:{port}" if ":" in host else f"{host}:{port}"
