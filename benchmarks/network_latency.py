"""A verb's round trip from another machine: over TLS and back, with its end received.

    python benchmarks/network_latency.py [--trips 500] [--quick]

In turns, on one machine: a line to a bare WebSocket server with TLS that sends it back (the floor);
a verb over the session's own socket, up to its `command.done`; the same over a session that was
joined with an access file, which is two more processes and TLS between them.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import os
import subprocess
import sys
import time
from collections.abc import Awaitable, Callable, Iterator
from pathlib import Path

import aiohttp
import msgspec

from benchmarks.client_latency import program, wait_for
from benchmarks.figures import machine, trips
from benchmarks.sessions import PROGRAMS, bench
from woz_tui.client import WozClient, connect
from woz_tui.network.certificates import SERVER_NAME, AccessFile, Authority

#: Trips that are not counted: caches, first lines.
WARM = 20
#: Between the rounds, in seconds: more than 200 requests a second are refused on this way.
_PAUSE_S = 0.03
_NAMES = ("bare echo, WebSocket with TLS", "the session's socket", "from another machine")


@contextlib.contextmanager
def joined(access: AccessFile, address: str, environ: dict[str, str]) -> Iterator[Path]:
    """The local socket of a session that was joined over the network."""
    process = subprocess.Popen(
        [
            *(sys.executable, "-P", "-m", "woz_tui.remote.remote_session"),
            *("--access", str(access.path), "--address", address),
        ],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        env=environ,
    )
    assert process.stdin is not None
    assert process.stdout is not None
    try:
        yield Path(msgspec.json.decode(process.stdout.readline())["socket"])
    finally:
        process.stdin.close()
        process.wait()


def measured(count: int) -> dict[str, list[float]]:
    """Milliseconds of each trip, by its way."""
    with contextlib.ExitStack() as opened:
        it = opened.enter_context(bench())
        environ = {**it.environ(), "XDG_CONFIG_HOME": str(it.folder)}
        os.environ["XDG_CONFIG_HOME"] = str(it.folder)
        Authority().new("bench", 2, "", it.folder / "bench.access")
        access = AccessFile.read(it.folder / "bench.access")
        path = Path(environ["WOZ_SOCKET"])
        opened.enter_context(program([*it.host_command()], "", it.environ()))
        wait_for(path)
        server = subprocess.Popen(
            [sys.executable, str(PROGRAMS / "tls_server.py"), str(path)],
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, **environ},
        )
        opened.callback(server.terminate)
        assert server.stdout is not None
        address, echo = server.stdout.readline().split()
        elsewhere = {**os.environ, "XDG_RUNTIME_DIR": str(it.folder)}
        elsewhere.pop("WOZ_SOCKET", None)
        far = opened.enter_context(joined(access, address, elsewhere))
        return asyncio.run(_measured(count, (path, far), access, echo))


async def _measured(
    count: int, sockets: tuple[Path, Path], access: AccessFile, echo: str
) -> dict[str, list[float]]:
    took: dict[str, list[float]] = {name: [] for name in _NAMES}
    async with contextlib.AsyncExitStack() as opened:
        near, far = [await opened.enter_async_context(connect(each)) for each in sockets]
        session = await opened.enter_async_context(aiohttp.ClientSession())
        bare = await opened.enter_async_context(
            session.ws_connect(f"wss://{echo}/", ssl=access.context(), server_hostname=SERVER_NAME)
        )

        async def echoed() -> None:
            await bare.send_str('{"kind":"verb","verb":"say","args":{"text":"a"}}')
            await bare.receive()

        ways: list[tuple[str, Callable[[], Awaitable[object]]]] = [
            (_NAMES[0], echoed),
            (_NAMES[1], lambda: near.say("a")),
            (_NAMES[2], lambda: far.say("a")),
        ]
        for number in range(WARM + count):
            await asyncio.sleep(_PAUSE_S)
            for name, trip in ways:
                await _drain([near, far])
                began = time.perf_counter_ns()
                await trip()
                if number >= WARM:
                    took[name].append((time.perf_counter_ns() - began) / 1e6)
    return took


async def _drain(clients: list[WozClient]) -> None:
    """What others asked for comes to every connection: it is read outside of the times."""
    for client in clients:
        await client.mark("drained")


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument("--trips", type=int, default=500, help="by each way")
    parser.add_argument("--quick", action="store_true", help="only to see that it works")
    arguments = parser.parse_args()
    took = measured(20 if arguments.quick else arguments.trips)
    trips("A verb's round trip, from the call to its end", took, _NAMES[0])
    print(f"\n{machine()}")


if __name__ == "__main__":
    main()
