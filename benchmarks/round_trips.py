"""A verb's round trip through each door of a session, beside a bare echo on the same transport.

    python benchmarks/round_trips.py [--trips 1000] [--quick]

In turns, on one machine, with one session: a `say` of a driver that does nothing but note the call,
up to its `command.done`, by a socket of one's own, by `woz_tui.client` and its blocking twin; the
same from a session that was joined with an access file, which is two more processes and TLS between
them; the same of a driver that another program serves; and a stop, until it and the local one have
confirmed it. The floors are a line to a program that sends it back.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import json
import os
import socket
import subprocess
import sys
import time
from collections.abc import Awaitable, Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import aiohttp

from benchmarks.figures import machine, trips
from benchmarks.programs.echo import ASKED, ECHOED, bare_zenoh, put
from benchmarks.sessions import PROGRAMS, ROOT, bench
from tests.fakes.ports import free_port
from woz_tui.client import WozClient, WozFailedError, blocking, connect
from woz_tui.network.certificates import SERVER_NAME, AccessFile, Authority

#: Rounds that are not counted: caches, first lines.
WARM = 20
#: Between the rounds, in seconds: more than 200 requests a second are refused over a network.
PAUSE_S = 0.02
#: A way of which more trips fail is given up; so long a line may be lost meanwhile, in seconds.
MOST_FAILED, LOST_S = 10, 1.0
HELLO = b'{"kind":"hello","role":"program","protocol":2,"stream":"actions"}\n'
VERB = b'{"kind":"verb","verb":"say","on":"near","args":{"text":"a"}}\n'
MARKER = b'{"kind":"marker"}\n'
ROBOT = """\
drivers:
  near: {{type: probe, journal: {folder}/near}}
  far: {{type: probe, journal: {folder}/far, at: {{name: other, listen: '127.0.0.1:{port}'}}}}
"""
STUDY = """\
title: Bench
robot: robot.yaml
session: {access: {other: program}}
panels: [{title: P, actions: [{key: a, label: A, say: a, on: near}]}]
"""
Trip = Callable[[], Awaitable[object]]


@dataclass
class Way:
    """One way there and back. `before` is not counted: what others asked for comes to every
    connection, and is read there.
    """

    name: str
    trip: Trip
    before: Trip | None = None
    took: list[float] = field(default_factory=list)
    failed: int = 0

    async def go(self) -> None:
        """Once, in milliseconds. What failed, as it came too late, is counted and made again."""
        if self.before is not None:
            await self.before()
        began = time.perf_counter_ns()
        try:
            await self.trip()
        except WozFailedError:
            self.failed += 1
            if self.failed > MOST_FAILED:
                raise
            await asyncio.sleep(LOST_S)
            await self.go()
        else:
            self.took.append((time.perf_counter_ns() - began) / 1e6)


class RawLines:
    """Lines of JSON over a Unix socket of one's own."""

    def __init__(self, path: Path) -> None:
        self._socket = socket.socket(socket.AF_UNIX)
        self._socket.connect(str(path))
        self._lines = self._socket.makefile("rb")

    async def ask(self, line: bytes, kind: str) -> None:
        """Send a line, and read up to one of this kind."""
        self._socket.sendall(line)
        while json.loads(self._lines.readline())["kind"] != kind:
            pass


@contextlib.contextmanager
def program(*command: str, ready: str, environ: Mapping[str, str]) -> Iterator[str]:
    """A program while the block lasts: its line with `ready` in it."""
    process = subprocess.Popen(
        [sys.executable, *command],
        cwd=ROOT,
        env={**os.environ, **environ},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        assert process.stdout is not None
        found = next((line for line in process.stdout if ready in line), "")
        if not found:
            raise RuntimeError(f"{' '.join(command)} did not start")
        yield found
    finally:
        process.terminate()
        process.communicate()


@dataclass
class Doors:
    """Where everything listens."""

    folder: Path
    session: Path
    joined: Path
    echo: Path
    echo_wss: str
    echo_zenoh: int


@contextlib.contextmanager
def doors() -> Iterator[Doors]:
    """The session, the computer that joins it, the one with the other driver, the echo."""
    with contextlib.ExitStack() as opened:
        it = opened.enter_context(bench())
        folder, path = it.folder, Path(it.environ()["WOZ_SOCKET"])
        os.environ |= {"XDG_CONFIG_HOME": str(folder), "XDG_RUNTIME_DIR": str(folder)}
        Authority().new("other", 2, "", folder / "other.access")
        drivers, network, zenoh = free_port(), free_port(), free_port()
        (folder / "robot.yaml").write_text(ROBOT.format(folder=folder, port=drivers))
        (folder / "study.yaml").write_text(STUDY)

        def start(*command: str, ready: str, **environ: str) -> str:
            environ = {**it.environ(), **environ}
            return opened.enter_context(program(*command, ready=ready, environ=environ))

        access = ("--access", f"{folder}/other.access")
        host = ("-m", "woz_tui", "host", f"{folder}/study.yaml", "--announce", *it.options())
        start(*host, "--listen", f"127.0.0.1:{network}", ready="socket")
        serve = ("-m", "woz_tui", "drivers", "--serve", f"{folder}/robot.yaml", *access)
        start(*serve, f"127.0.0.1:{drivers}", ready="uses it")
        join = ("-P", "-m", "woz_tui.remote.remote_session", *access)
        joined = start(*join, "--address", f"127.0.0.1:{network}", ready="socket", WOZ_SOCKET="")
        words = (f"{folder}/echo", str(zenoh))
        echo = start(str(PROGRAMS / "echo.py"), *words, ready=":").strip()
        joined_at = Path(json.loads(joined)["socket"])
        yield Doors(folder, path, joined_at, folder / "echo", echo, zenoh)


async def measured(at: Doors, count: int) -> dict[str, list[Way]]:
    """The ways of each transport, with their times; the first one is its floor."""
    loop, back = asyncio.get_running_loop(), asyncio.Event()
    async with contextlib.AsyncExitStack() as opened:
        bare, raw = RawLines(at.echo), RawLines(at.session)
        await raw.ask(HELLO, "welcome")
        twin = opened.enter_context(blocking.connect(at.session))
        near = await opened.enter_async_context(connect(at.session))
        far = await opened.enter_async_context(connect(at.joined))
        http = await opened.enter_async_context(aiohttp.ClientSession())
        access = AccessFile.read(at.folder / "other.access")
        tls = await opened.enter_async_context(
            http.ws_connect(
                f"wss://{at.echo_wss}/", ssl=access.context(), server_hostname=SERVER_NAME
            )
        )
        zenoh = bare_zenoh(at.echo_zenoh, str(access.path))
        opened.callback(zenoh.close)
        held = zenoh.declare_subscriber(ECHOED, lambda _: loop.call_soon_threadsafe(back.set))
        opened.callback(held.undeclare)

        def said(client: WozClient, driver: str) -> tuple[Trip, Trip]:
            words = {"text": "a"}
            return lambda: client.perform("say", words, driver=driver), client.mark

        async def blocked() -> None:
            twin.perform("say", {"text": "a"}, driver="near")

        async def read_blocked() -> None:
            twin.mark()

        async def over_websocket() -> None:
            await tls.send_str(VERB.decode())
            await tls.receive()

        async def stop() -> None:
            if missing := (await near.stop()).missing:
                await near.release(["near", "far"])  # whoever is late by now
                raise WozFailedError(f"the stop was not confirmed by {' and '.join(missing)}", "")

        async def over_zenoh() -> None:
            back.clear()
            put(zenoh, ASKED, VERB)
            await back.wait()

        ways = {
            "over a Unix socket": [
                Way("bare echo", lambda: bare.ask(VERB, "verb")),
                Way(
                    "a socket of one's own",
                    lambda: raw.ask(VERB, "command.done"),
                    lambda: raw.ask(MARKER, "reply"),
                ),
                Way("client, asyncio", *said(near, "near")),
                Way("client, blocking", blocked, read_blocked),
            ],
            "from another machine, WebSocket with TLS": [
                Way("bare echo", over_websocket),
                Way("client, asyncio", *said(far, "near")),
            ],
            "a driver at another computer, Zenoh with TLS": [
                Way("bare echo", over_zenoh),
                Way("client, asyncio", *said(near, "far")),
                Way("a stop, confirmed", stop, near.mark),
            ],
        }
        for number in range(WARM + count):
            for way in (each for several in ways.values() for each in several):
                await way.go()
                if number < WARM:
                    way.took.clear()
            await near.release()
            await asyncio.sleep(PAUSE_S)
    return ways


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument("--trips", type=int, default=1000, help="by each way")
    parser.add_argument("--quick", action="store_true", help="only to see that it works")
    arguments = parser.parse_args()
    with doors() as at:
        found = asyncio.run(measured(at, 20 if arguments.quick else arguments.trips))
    for transport, ways in found.items():
        took = {way.name: way.took for way in ways}
        trips(f"A verb's round trip, {transport}", took, "bare echo")
        for way in ways:
            if way.failed:
                print(
                    f"  {way.name}: {way.failed} failed, as something was late, and were made again"
                )
    print(f"\n{machine()}")


if __name__ == "__main__":
    main()
