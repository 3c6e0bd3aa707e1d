"""What the system does with the bytes of a connection that is being lost.

It goes on sending what it has for minutes after a connection was given up: a robot whose cable is
plugged in again would carry out what its wizard was told had failed. Neither library gives access
to all of its sockets, but they are files of this process like any others.
"""

from __future__ import annotations

import asyncio
import contextlib
import os
import socket
import stat
import struct
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path

from woz_drivers.pepper.address import Address

#: Bytes that the robot's side has not confirmed for so long are given up, in milliseconds: less
#: than what it takes the wizard to be told, and more than a bad wireless link needs.
UNCONFIRMED_MS = 1500
#: SO_LINGER: on, for 0 s.
_AT_ONCE = struct.pack("ii", 1, 0)
#: Where Linux lists the files of a process; elsewhere nothing is found, and nothing done.
_FILES = Path("/proc/self/fd")


def keep_nothing_unsent(peers: Iterable[tuple[str, int]]) -> int:
    """Let what was not brought to these peers (IP address, port) be forgotten on loss.

    What has reached the robot's system already is read there even so. Returns how many sockets
    are so now.
    """
    wanted = set(peers)
    count = 0
    for number in _sockets():
        with contextlib.suppress(OSError), socket.socket(fileno=os.dup(number)) as held:
            if held.type == socket.SOCK_STREAM and held.getpeername()[:2] in wanted:
                _keep_nothing(held)
                count += 1
    return count


def _sockets() -> Iterator[int]:
    with contextlib.suppress(OSError):
        for entry in _FILES.iterdir():
            with contextlib.suppress(OSError, ValueError):
                if stat.S_ISSOCK(os.fstat(int(entry.name)).st_mode):
                    yield int(entry.name)


def _keep_nothing(held: socket.socket) -> None:
    """Give up what is not confirmed after a while, and everything on closing."""
    held.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, _AT_ONCE)
    if sys.platform == "linux":
        held.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, UNCONFIRMED_MS)


async def resolved(address: Address) -> tuple[str, int]:
    """IP address and port of the robot, IPv4 before IPv6. Raises `OSError` (`socket.gaierror`)."""
    found = await asyncio.get_running_loop().getaddrinfo(
        address.host, address.port, type=socket.SOCK_STREAM
    )
    found.sort(key=lambda info: info[0] != socket.AF_INET)
    place = found[0][4]
    return str(place[0]), int(place[1])


def local_host_towards(ip: str, port: int) -> str:
    """This machine's address on the way to the robot; nothing is sent. Empty if there is none."""
    family = socket.AF_INET6 if ":" in ip else socket.AF_INET
    with contextlib.suppress(OSError), socket.socket(family, socket.SOCK_DGRAM) as asked:
        asked.connect((ip, port))
        return str(asked.getsockname()[0])
    return ""
