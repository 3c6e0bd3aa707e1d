"""From a session to a driver at another computer and back, beside a bare echo over Zenoh.

    python benchmarks/remote_driver_latency.py [--runs 2000] [--quick]

The other computer is another process of this machine. In turns: a bare echo over a line of its own
without TLS (a put, a callback there that puts it back, a callback here), a verb that is done at
once, and a stop with nothing under way, each until its answer is in the event loop of the session.
Without TLS, then with it, as between two computers. Milliseconds.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path

import zenoh

from benchmarks.figures import Spread, machine, table
from woz_tui.drivers.contract import Driver, Health, Job, Scope, Verb
from woz_tui.network.certificates import AccessFile, Authority
from woz_tui.network.driver_line import DriverLine, DriverRouter, LineError, connect
from woz_tui.network.driver_server import DriverServer, OfferedDriver
from woz_tui.network.remote_driver import RemoteDriver
from woz_tui.protocol.messages import Json
from woz_tui.testing import PlainJob, RecordingContext, until

ROOT = Path(__file__).parents[1]
PLACE = "other"
#: A machine that is busy measuring is not gone.
SILENCE_S = 5.0
ASKED, ECHOED = "echo/to", "echo/from"
PAUSE_S = 0.002


class BriefDriver(Driver):
    """Does at once what it is asked for."""

    Settings = argparse.Namespace
    summary = "a driver that does nothing"

    @classmethod
    def verbs(cls, settings: object) -> tuple[Verb, ...]:
        """One."""
        return (Verb("blink", "blink"),)

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Nothing."""
        return {}

    async def stop(self, scope: Scope) -> None:
        """Nothing."""


def bare(mode: str, side: str, port: int) -> zenoh.Session:
    """A line of zenoh with nothing of ours."""
    config = zenoh.Config()
    config.insert_json5("mode", f'"{mode}"')
    config.insert_json5(f"{side}/endpoints", f'["tcp/127.0.0.1:{port}"]')
    config.insert_json5("scouting/multicast/enabled", "false")
    return zenoh.open(config)


def put(session: zenoh.Session, key: str, data: bytes) -> None:
    """At once, as the line does it."""
    session.put(key, data, express=True, congestion_control=zenoh.CongestionControl.DROP)


async def serve(address: str, echo_port: int, access: AccessFile | None) -> None:
    """The other computer."""
    echo = bare("client", "connect", echo_port)
    held = echo.declare_subscriber(
        ASKED, lambda sample: put(echo, ECHOED, sample.payload.to_bytes())
    )
    line: DriverLine | None = None
    while line is None:
        with contextlib.suppress(LineError):
            line = await asyncio.to_thread(connect, address, access, SILENCE_S)
    offer = OfferedDriver("brief", "brief", BriefDriver, argparse.Namespace())
    server = DriverServer(PLACE, [offer], folder=ROOT, tell=lambda _: None, silence_s=SILENCE_S)
    await server.run(line)
    held.undeclare()  # type: ignore[no-untyped-call]


async def measure(
    port: int, echo_port: int, runs: int, folder: Path | None
) -> dict[str, list[float]]:
    """The session's side; `folder`: for certificates, None: without TLS."""
    address, authority, words = f"tcp://127.0.0.1:{port}", Authority(folder), ["--serve"]
    if folder is not None:
        address = f"127.0.0.1:{port}"
        authority.new(PLACE, 1, "", folder / "file.access")
        words = ["--access", str(folder / "file.access"), *words]
    router = DriverRouter(address, [PLACE], authority, SILENCE_S)
    context = RecordingContext()
    driver = RemoteDriver(
        *("brief", argparse.Namespace(), context),
        local=BriefDriver,
        kind="brief",
        router=router,
        place=PLACE,
    )
    loop, back = asyncio.get_running_loop(), asyncio.Event()
    echo = bare("router", "listen", echo_port)
    held = echo.declare_subscriber(ECHOED, lambda _: loop.call_soon_threadsafe(back.set))
    await driver.open()
    words = [*words, address, "--echo", str(echo_port)]
    command = [sys.executable, "-m", "benchmarks.remote_driver_latency", *words]
    with subprocess.Popen(command, cwd=ROOT) as process:  # noqa: ASYNC220 - for a moment only
        try:
            await until(lambda: context.healths[-1][0] is Health.CONNECTED, 30)
            figures: dict[str, list[float]] = {"bare echo": [], "verb": [], "stop": []}
            for _ in range(runs):
                begun = time.perf_counter()
                back.clear()
                put(echo, ASKED, b"x" * 60)
                await back.wait()
                figures["bare echo"].append(time.perf_counter() - begun)
                begun = time.perf_counter()
                await driver.perform(PlainJob("blink"))
                figures["verb"].append(time.perf_counter() - begun)
                begun = time.perf_counter()
                await driver.stop(Scope.ALL)
                figures["stop"].append(time.perf_counter() - begun)
                await asyncio.sleep(PAUSE_S)
            await driver.close()
        finally:
            process.kill()
            held.undeclare()  # type: ignore[no-untyped-call]
            echo.close()  # type: ignore[no-untyped-call]
    return figures


async def main(runs: int) -> None:
    """Print both tables."""
    print(machine())
    for name in ("without TLS", "with TLS"):
        servers = [await asyncio.start_server(lambda *_: None, "127.0.0.1", 0) for _ in range(2)]
        port, echo_port = (server.sockets[0].getsockname()[1] for server in servers)
        for server in servers:
            server.close()
        with tempfile.TemporaryDirectory() as folder:
            authority = Path(folder) if name == "with TLS" else None
            figures = await measure(port, echo_port, runs, authority)
        spreads = {each: Spread.of([1000 * one for one in of]) for each, of in figures.items()}
        table(
            f"{name}, {runs} runs, there and back (ms)",
            ["", "p50", "p99", "worst", "times the echo"],
            [
                [
                    each,
                    *(f"{one:.2f}" for one in (spread.p50, spread.p99, spread.worst)),
                    f"{spread.over(spreads['bare echo'])[0]:.1f}",
                ]
                for each, spread in spreads.items()
            ],
        )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--runs", type=int, default=2000)
    parser.add_argument("--quick", action="store_true", help="only to see that it runs")
    parser.add_argument("--serve", metavar="ADDRESS", help=argparse.SUPPRESS)
    parser.add_argument("--echo", type=int, help=argparse.SUPPRESS)
    parser.add_argument("--access", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.serve:
        given = AccessFile.read(options.access) if options.access else None
        asyncio.run(serve(options.serve, options.echo, given))
    else:
        asyncio.run(main(50 if options.quick else options.runs))
