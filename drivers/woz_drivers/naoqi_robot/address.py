"""Addresses of robots, as `robots:` lists them and the wizard types them."""

from __future__ import annotations

import contextlib
import re
from dataclasses import dataclass

from woz_drivers.lines.network_address import host_and_port
from woz_drivers.programs.simulated_process import SIMULATED
from woz_tui.drivers.contract import RejectedError
from woz_tui.drivers.secret_arguments import HIDDEN

#: Where NAOqi listens: up to 2.8, and from 2.9 on, where the line is secured.
PORT = 9559
SECURE_PORT = 9503
#: NAOqi's own user, for a secured line without a name.
USER = "nao"

_EXAMPLES = "write a host name, tcp://HOST:9559, tcps://USER@HOST:9503, or simulated"
_SCHEME = re.compile(r"([A-Za-z][A-Za-z0-9+.-]*)://(.*)", re.DOTALL)
_USER = re.compile(r"[\w.-]{1,64}")


@dataclass(frozen=True, slots=True)
class Address:
    """A robot's address. It never holds a password.

    Attributes:
        host: Name or IP address, IPv6 without brackets; empty: the simulated robot.
        port: 1 to 65535.
        secure: Whether the line is secured (tcps), with user and password.
        user: Who logs in on a secured line.
    """

    host: str = ""
    port: int = PORT
    secure: bool = False
    user: str = ""

    @property
    def simulated(self) -> bool:
        """Whether the driver starts this robot itself."""
        return not self.host

    @property
    def shown(self) -> str:
        """In as few words as the wizard needs."""
        if self.simulated:
            return SIMULATED
        usual = SECURE_PORT if self.secure else PORT
        host = f"[{self.host}]" if ":" in self.host else self.host
        return host if self.port == usual else f"{host}:{self.port}"


def parse(text: str) -> Address:
    """The address in `text`.

    Raises `RejectedError` with what is wrong. Nothing of what may be a password is repeated.
    """
    text = text.strip()
    if text.lower() == SIMULATED:
        return Address()
    scheme, rest = _split(text)
    user, place = _without_user(rest)
    secure = scheme == "tcps"
    if user and not secure:
        raise RejectedError(
            f"a user belongs to a secured line, not to {scheme}://",
            f"leave the user out, or write tcps://{user}@...",
        )
    host, port = host_and_port(place, SECURE_PORT if secure else PORT, _EXAMPLES)
    return Address(host, port, secure, (user or USER) if secure else "")


def without_password(text: str) -> str:
    """What everybody may see of `text`, which was given as an address: no password, and nothing
    that may be one because it stands where no port can. An address stays as it is.
    """
    with contextlib.suppress(RejectedError):
        parse(text)
        return text
    found = _SCHEME.fullmatch(text.strip())
    head, rest = (f"{found[1]}://", found[2]) if found else ("", text.strip())
    before, at, place = rest.rpartition("@")
    if not at:
        name, colon, _ = rest.partition(":")
        return f"{head}{name}:{HIDDEN}" if colon else text
    user, colon, _ = before.partition(":")
    login = user if colon and _USER.fullmatch(user) else HIDDEN
    return f"{head}{login}:{HIDDEN}@{_place_without_password(place)}"


def _place_without_password(place: str) -> str:
    try:
        host_and_port(place, PORT, _EXAMPLES)
    except RejectedError:
        return HIDDEN
    return place


def _split(text: str) -> tuple[str, str]:
    found = _SCHEME.fullmatch(text)
    if found is None:
        return "tcp", text
    scheme = found[1].lower()
    if scheme not in ("tcp", "tcps"):
        raise RejectedError(f"{scheme}:// is no way to a robot", _EXAMPLES)
    return scheme, found[2].removesuffix("/")


def _without_user(rest: str) -> tuple[str, str]:
    user, at, place = rest.rpartition("@")
    if not at:
        return "", rest
    if ":" in user:
        raise RejectedError(
            "a password must not stand in an address, where everybody reads it",
            "give the user alone, and the password in the environment variable that `password`"
            " names (WOZ_PEPPER_PASSWORD, WOZ_NAO_PASSWORD)",
        )
    if not _USER.fullmatch(user):
        raise RejectedError("the user before the @ is none: letters, digits, _ . -", _EXAMPLES)
    return user, place
