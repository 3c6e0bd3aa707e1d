"""Ports for programs that are started one after the other, or come back to theirs."""

from __future__ import annotations

import contextlib
import random
import socket
from pathlib import Path


def free_port() -> int:
    """One that nobody listens at, and that the system gives to nobody by itself."""
    given = Path("/proc/sys/net/ipv4/ip_local_port_range").read_text().split()
    while True:
        port = random.SystemRandom().randrange(int(given[0]) - 10_000, int(given[0]))
        with contextlib.suppress(OSError), socket.create_server(("127.0.0.1", port)):
            return port
