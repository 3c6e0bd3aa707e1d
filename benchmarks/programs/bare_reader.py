"""The floor of all latencies: an asyncio program that notes the keys of its terminal.

    python benchmarks/programs/bare_reader.py JOURNAL [--second]

Raw mode, `add_reader`, one `write(2)` to the journal for each key: nanoseconds of CLOCK_MONOTONIC
and the key. No screen. With `--second` the key is not noted here, but sent over a Unix socket to a
second program of the same kind, which notes it.
"""

from __future__ import annotations

import asyncio
import os
import socket
import sys
import time
import tty


async def read(fd: int, journal: int, onward: socket.socket | None = None) -> None:
    """Note keys, or send them on, until their source is gone."""
    loop = asyncio.get_running_loop()
    over: asyncio.Future[None] = loop.create_future()

    def ready() -> None:
        data = os.read(fd, 4096)
        if onward is not None:
            onward.send(data)
            return
        now = time.monotonic_ns()
        if not data:
            loop.remove_reader(fd)
            over.set_result(None)
        for key in data:
            os.write(journal, f"{now} {chr(key)}\n".encode())

    loop.add_reader(fd, ready)
    if fd == 0:
        os.write(1, b"ready\n")
    await over


def main() -> None:
    """Run one program or two until they are killed."""
    tty.setraw(0)
    journal = os.open(sys.argv[1], os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)
    if sys.argv[2:] != ["--second"]:
        asyncio.run(read(0, journal))
        return
    here, there = socket.socketpair()
    if os.fork():
        there.close()
        asyncio.run(read(0, journal, here))
    else:
        here.close()
        asyncio.run(read(there.fileno(), journal))


if __name__ == "__main__":
    main()
