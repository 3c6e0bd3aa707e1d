"""The address at which other machines can join, as it is typed."""

from __future__ import annotations

import ipaddress
from dataclasses import dataclass

from woz_tui.protocol.sentence import Sentence

#: Where a session listens for the computers of its drivers, unless the robot file says otherwise.
DRIVERS_LISTEN = "0.0.0.0:7447"


@dataclass(frozen=True, slots=True)
class ListenAddress:
    """Where to listen. `plain`: without TLS, which is for this machine alone."""

    host: str
    port: int
    plain: bool = False

    @classmethod
    def read(cls, text: str) -> ListenAddress:
        """From `HOST:PORT`, `[IPv6]:PORT`, `:PORT` (everywhere), or of this machine alone
        `ws://127.0.0.1:PORT` and for drivers `tcp://127.0.0.1:PORT`.

        Raises `ValueError` with a sentence.
        """
        scheme, _, rest = text.rpartition("://")
        host, colon, port = rest.rpartition(":")
        host = host.removeprefix("[").removesuffix("]")
        if scheme not in ("", "ws", "wss", "tcp") or not (
            colon and port.isascii() and port.isdigit()
        ):
            raise ValueError(
                Sentence(
                    "check.no_address",
                    "{text!r} is no address; for example 0.0.0.0:8765 or robot.local:8765",
                    text=text,
                )
            )
        if int(port) > 0xFFFF:
            raise ValueError(
                Sentence(
                    "check.port_range", "{text!r}: ports go up to {most}", text=text, most=0xFFFF
                )
            )
        if scheme in ("ws", "tcp") and not is_loopback(host):
            raise ValueError(
                Sentence(
                    "check.plain_network",
                    "{text!r} would let the whole network in without certificates: without"
                    " `{scheme}://` the connection is encrypted, and each name has its certificate",
                    text=text,
                    scheme=scheme,
                )
            )
        return cls(host, int(port), scheme in ("ws", "tcp"))


def is_access_name(name: str) -> bool:
    """Whether somebody can be called so."""
    return name.isascii() and name.replace("-", "").replace("_", "").isalnum()


def is_loopback(host: str) -> bool:
    """Whether only this computer itself reaches it."""
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"
