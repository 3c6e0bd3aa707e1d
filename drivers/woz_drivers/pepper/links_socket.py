"""What the system does with the bytes of a connection that is being lost.

It goes on sending what it has for minutes after a connection was given up: a robot whose cable is
plugged in again would carry out what its wizard was told had failed. Neither library gives access
to all of its sockets, but they are files of this process like any others.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import re
import socket
import stat
import struct
import sys
from collections.abc import Iterable, Iterator
from functools import cache
from itertools import islice
from pathlib import Path
from typing import ClassVar

#: Bytes that the robot's side has not confirmed for so long are given up, in milliseconds: less
#: than what it takes the wizard to be told, and more than a bad wireless link needs.
UNCONFIRMED_MS = 1500
#: IP address and port; those of both ends.
_Place = tuple[str, int]
_Name = tuple[str, int, str, int]
_TCP_END = re.compile(r"tcps?://\[?([^\]]{1,255})\]?:(\d{1,5})", re.ASCII)
#: Other ends that a robot may name; it has a dozen processes.
_MOST_PEERS = 256
#: SO_LINGER: on, for 0 s.
_AT_ONCE = struct.pack("ii", 1, 0)
#: To "connect" to the address family AF_UNSPEC ends a TCP connection: connect(2), tcp(7).
_NOWHERE = struct.pack("H14x", socket.AF_UNSPEC)
#: Where Linux lists the files of a process; elsewhere nothing is found, and nothing done.
_FILES = Path("/proc/self/fd")


class Sockets:
    """Those of one link. Made before the link connects: what is there already is somebody else's.

    Two links that connect to the same robot in the same moment may take each other's for theirs;
    then both are lost when one is closed, and come back.
    """

    _taken: ClassVar[set[_Name]] = set()

    def __init__(self, peer: _Place) -> None:
        self._peers: set[_Place] = set()
        self._foreign: set[_Name] = set()
        self._mine: set[_Name] = set()
        self.expect({peer})

    def expect(self, peers: Iterable[_Place]) -> None:
        """The link may connect to these, too: other processes of the robot."""
        new = set(islice(set(peers) - self._peers, max(0, _MOST_PEERS - len(self._peers))))
        self._foreign |= {name for _, name in _connected(new)}
        self._peers |= new

    def keep_nothing_unsent(self) -> None:
        """Let what is not brought to the robot in time be forgotten, on all that there are now."""
        for held, name in _connected(self._peers):
            if name not in self._foreign and (name in self._mine or name not in self._taken):
                self._mine.add(name)
                self._taken.add(name)
                _keep_nothing(held)

    def throw_away_unsent(self) -> None:
        """End the connections now, with whatever is still on its way.

        What has reached the robot's system already is read there even so.
        """
        self.keep_nothing_unsent()
        for held, name in _connected(self._peers):
            if name in self._mine and sys.platform == "linux":
                # Closing is left to the library, which does it some time; this is at once.
                _libc().connect(held.fileno(), _NOWHERE, len(_NOWHERE))
        self._taken.difference_update(self._mine)


def elsewhere(services: Iterable[tuple[int, Iterable[str]]], directory: int) -> set[_Place]:
    """Where the robot's other processes listen.

    Args:
        services: Process and endpoints (`tcp://10.0.0.7:40123` ...) of each service.
        directory: The process with which we are connected.
    """
    ends = (end for process, ends in services if process != directory for end in ends)
    found = (_TCP_END.fullmatch(end) for end in ends)
    return {(end[1], int(end[2])) for end in found if end is not None}


def _connected(peers: Iterable[_Place]) -> Iterator[tuple[socket.socket, _Name]]:
    """This process's connections to these peers: second handles on them, and their names."""
    wanted = set(peers)
    for number in tuple(_sockets()) if wanted else ():
        with contextlib.suppress(OSError), socket.socket(fileno=os.dup(number)) as held:
            if held.type == socket.SOCK_STREAM and held.getpeername()[:2] in wanted:
                yield held, (*held.getsockname()[:2], *held.getpeername()[:2])


@cache
def _libc() -> ctypes.CDLL:
    return ctypes.CDLL(None, use_errno=True)


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
