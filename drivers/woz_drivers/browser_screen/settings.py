"""What a robot file may say about a browser as a screen."""

from __future__ import annotations

import ipaddress
from dataclasses import dataclass
from typing import Annotated

from woz_tui.drivers.fields import Doc, OneOf, Pattern, Seconds, Section

_ADDRESS = r"(\[[0-9a-fA-F:]+\]|[\w.-]+):\d{1,5}"


@dataclass(frozen=True, slots=True)
class BrowserScreenSettings(Section):
    """What a robot file may say about a browser as a screen."""

    listen: Annotated[
        str,
        Pattern(_ADDRESS, "HOST:PORT, such as 127.0.0.1:8071"),
        Doc("where the browser finds it"),
    ] = "127.0.0.1:8071"
    plain: Annotated[
        bool,
        Doc("allow other computers, without encryption: their network can see what is shown"),
    ] = False
    code: Annotated[
        str,
        Pattern(r"[\w-]{8,64}|", "8 letters or digits at least"),
        Doc(
            "last part of the address, which a stranger must not guess; empty: a new one each time"
        ),
    ] = ""
    background: Annotated[
        str, OneOf(("black", "white", "grey")), Doc("colour around and behind all that is shown")
    ] = "black"
    patience: Annotated[
        float, Seconds(0.2, 60), Doc("what is not painted after so long has failed")
    ] = 5.0

    @property
    def host(self) -> str:
        """Where it listens, without the port."""
        return self.listen.rpartition(":")[0].removeprefix("[").removesuffix("]")

    @property
    def port(self) -> int:
        """The port."""
        return int(self.listen.rpartition(":")[2])

    def problems(self) -> list[tuple[str, str]]:
        """What is wrong between settings: pairs of a setting's name and a sentence."""
        found = []
        if self.port > 0xFFFF:
            found.append(("listen", f"ports go up to {0xFFFF}"))
        if not self.plain and not _is_here(self.host):
            found.append(
                (
                    "listen",
                    f"{self.host} lets other computers in, and nothing is encrypted: `plain: true`"
                    " says that this is meant, in a network of your own",
                )
            )
        return found


def _is_here(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"
