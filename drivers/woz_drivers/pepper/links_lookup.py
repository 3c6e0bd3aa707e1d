"""Which IP address a robot has, and which of ours leads to it."""

from __future__ import annotations

import asyncio
import contextlib
import ipaddress
import socket
import threading
from typing import Any

from woz_drivers.pepper.address import Address


async def resolved(address: Address) -> tuple[str, int]:
    """IP address and port of the robot, IPv4 before IPv6. Raises `OSError` (`socket.gaierror`).

    Names are looked up in a thread of its own, which keeps nobody from ending: a look-up without a
    network takes half a minute.
    """
    with contextlib.suppress(ValueError):
        return str(ipaddress.ip_address(address.host)), address.port
    loop = asyncio.get_running_loop()
    found: asyncio.Future[list[Any]] = loop.create_future()

    def look_up() -> None:
        answer: list[Any] | OSError
        try:
            answer = socket.getaddrinfo(address.host, address.port, type=socket.SOCK_STREAM)
        except OSError as error:
            answer = error
        except UnicodeError:  # a part of it is longer than a name may be
            answer = socket.gaierror(socket.EAI_NONAME, "not known")
        with contextlib.suppress(RuntimeError):  # the loop has been closed meanwhile
            loop.call_soon_threadsafe(_settle, found, answer)

    threading.Thread(target=look_up, name="look up", daemon=True).start()
    infos = sorted(await found, key=lambda info: bool(info[0] != socket.AF_INET))
    return str(infos[0][4][0]), int(infos[0][4][1])


def _settle(found: asyncio.Future[list[Any]], answer: list[Any] | OSError) -> None:
    if found.done():
        return
    if isinstance(answer, OSError):
        found.set_exception(answer)
    else:
        found.set_result(answer)


def local_host_towards(ip: str, port: int) -> str:
    """This machine's address on the way to the robot; nothing is sent. Empty if there is none."""
    family = socket.AF_INET6 if ":" in ip else socket.AF_INET
    with contextlib.suppress(OSError), socket.socket(family, socket.SOCK_DGRAM) as asked:
        asked.connect((ip, port))
        return str(asked.getsockname()[0])
    return ""
