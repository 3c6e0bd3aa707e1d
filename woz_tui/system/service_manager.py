"""Tells systemd, if it started this process (`Type=notify`), that it is ready and that it ends."""

from __future__ import annotations

import contextlib
import os
import socket


def notify(*lines: str) -> None:
    """Send `lines`, such as `READY=1`, as sd_notify(3) does; without a manager nothing happens."""
    address = os.environ.get("NOTIFY_SOCKET", "")
    if not address.startswith(("/", "@")):
        return
    if address.startswith("@"):  # a name of the kernel's, without a file
        address = f"\0{address[1:]}"
    # One that does not read keeps no session from its robot.
    with (
        contextlib.suppress(OSError),
        socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as manager,
    ):
        manager.setblocking(False)
        manager.sendto("\n".join(lines).encode(), address)
