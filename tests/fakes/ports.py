"""Ports for programs that are started one after the other, or come back to theirs."""

from __future__ import annotations

import contextlib
import random
import socket
from pathlib import Path


def free_port(in_a_row: int = 1) -> int:
    """One that nobody listens at, and that the system gives to nobody by itself; or the first of
    several.
    """
    given = Path("/proc/sys/net/ipv4/ip_local_port_range").read_text().split()
    while True:
        first = random.SystemRandom().randrange(int(given[0]) - 10_000, int(given[0]) - in_a_row)
        with contextlib.suppress(OSError), contextlib.ExitStack() as taken:
            for port in range(first, first + in_a_row):
                taken.enter_context(socket.create_server(("127.0.0.1", port)))
            return first
