"""A verb's round trip from a program: sent, recorded, performed, and its end received.

    python benchmarks/client_latency.py [--trips 1000] [--quick]

In turns, over Unix sockets: a line to a bare asyncio program that sends it back (the floor); a verb
to a robot process by a socket of the program's own, up to its `command.done`; the same by
`woz_tui.client`, and by its blocking twin. The driver does nothing but note the call.
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
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from benchmarks.figures import machine, trips
from benchmarks.sessions import PROGRAMS, ROOT, bench
from woz_tui.client import blocking, connect

#: Trips that are not counted: caches, first lines.
WARM = 20
_NAMES = ("bare echo", "raw socket", "client, asyncio", "client, blocking")


@contextlib.contextmanager
def program(command: Sequence[str], ready: str, environ: dict[str, str]) -> Iterator[None]:
    """A program that has said that it is ready."""
    process = subprocess.Popen(
        command,
        cwd=ROOT,
        env={**os.environ, **environ},
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    try:
        assert process.stdout is not None
        if ready not in process.stdout.readline():
            raise RuntimeError(f"{command[-1]} did not start")
        yield
    finally:
        process.terminate()
        process.communicate()


class RawLines:
    """Lines of JSON over a socket of one's own."""

    def __init__(self, path: str) -> None:
        self._socket = socket.socket(socket.AF_UNIX)
        self._socket.connect(path)
        self._lines = self._socket.makefile("rb")

    def send(self, line: bytes) -> None:
        """Send a whole line."""
        self._socket.sendall(line)

    def line(self) -> bytes:
        """The next line."""
        return self._lines.readline()

    def until(self, kind: str) -> None:
        """Read up to a line of this kind."""
        while json.loads(self.line())["kind"] != kind:
            pass


def measured(count: int) -> dict[str, list[float]]:
    """Milliseconds of each trip, by its way."""
    took: dict[str, list[float]] = {name: [] for name in _NAMES}
    with contextlib.ExitStack() as opened:
        it = opened.enter_context(bench())
        path, echo = it.environ()["WOZ_SOCKET"], str(it.folder / "echo")
        opened.enter_context(program([*it.host_command()], "", it.environ()))
        opened.enter_context(
            program([sys.executable, str(PROGRAMS / "echo.py"), echo], "ready", {})
        )
        wait_for(Path(path))
        bare, raw = RawLines(echo), RawLines(path)
        raw.send(b'{"kind":"hello","role":"program","protocol":2,"stream":"actions"}\n')
        raw.until("welcome")
        verb = b'{"kind":"verb","verb":"say","args":{"text":"a"}}\n'

        def by_hand() -> None:
            raw.send(verb)
            raw.until("command.done")

        def echoed() -> None:
            bare.send(verb)
            bare.line()

        twin = opened.enter_context(blocking.connect(path))
        loop = asyncio.new_event_loop()
        opened.callback(loop.close)
        opening = connect(path)
        woz = loop.run_until_complete(opening.__aenter__())
        opened.callback(lambda: loop.run_until_complete(opening.__aexit__(None, None, None)))

        async def several() -> None:
            for number in range(WARM + count):
                # What others asked for comes to every connection: it is read outside of the times.
                twin.mark("drained")
                await woz.mark("drained")
                began = time.perf_counter_ns()
                await woz.say("a")
                if number >= WARM:
                    took["client, asyncio"].append((time.perf_counter_ns() - began) / 1e6)
                for name, trip in ways:
                    raw.send(b'{"kind":"marker","text":"drained"}\n')
                    raw.until("reply")
                    _trip(took[name], trip, number)

        ways: list[tuple[str, Callable[[], object]]] = [
            ("bare echo", echoed),
            ("raw socket", by_hand),
            ("client, blocking", lambda: twin.say("a")),
        ]
        loop.run_until_complete(several())
    return took


def _trip(took: list[float], trip: Callable[[], object], number: int) -> None:
    began = time.perf_counter_ns()
    trip()
    if number >= WARM:
        took.append((time.perf_counter_ns() - began) / 1e6)


def wait_for(path: Path) -> None:
    """Until a program has made its socket. Raises `RuntimeError` if that takes long."""
    until = time.monotonic() + 30
    while not path.exists():
        if time.monotonic() > until:
            raise RuntimeError("the robot process did not start")
        time.sleep(0.05)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument("--trips", type=int, default=1000, help="by each way")
    parser.add_argument("--quick", action="store_true", help="only to see that it works")
    arguments = parser.parse_args()
    took = measured(30 if arguments.quick else arguments.trips)
    trips("A verb's round trip, from the call to its end", took, "bare echo")
    print(f"\n{machine()}")


if __name__ == "__main__":
    main()
