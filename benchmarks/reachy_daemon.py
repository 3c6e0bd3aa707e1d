"""The driver for Reachy Mini at the vendor's own daemon: calls, stops, faults.

    python benchmarks/reachy_daemon.py [--calls 300] [--stops 30] [--faults 50] [--backend mujoco]

`make peers` installs the daemon; it moves a mockup, whose joints are at once where they are sent,
or a robot in MuJoCo, whose joints have masses.

* Calls: from the command until the daemon has answered it, beside a bare client of aiohttp with one
  connection; a setpoint is not answered: until it has been handed to the system.
* Stops: in the middle of a pose, a gesture, a gaze, waking up; from the stop until the driver has
  confirmed it, and until the robot is within a degree (a millimetre) of where it stays.
* Faults: the daemon is killed and started again, frozen (SIGSTOP), or its network is cut. Known:
  until the wizard sees it and the command under way has ended. Back: from then on until connected.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import random
import signal
import sys
import tempfile
import time
from collections.abc import Awaitable, Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

import aiohttp
import pytest
from woz_drivers.reachy_mini import ReachyMini, ReachyMiniSettings
from woz_drivers.reachy_mini.pose import HOME, goto_body, target_message

from benchmarks.figures import Spread, machine, table
from tests.fakes.dropping_proxy import dropping_proxy
from tests.peers.vendors_daemon import BACKENDS, VendorsDaemon
from woz_tui.drivers.contract import DriverError, Health, Scope
from woz_tui.testing import PlainJob, RecordingContext, until

STOPPED: tuple[tuple[str, Mapping[str, Any]], ...] = (
    ("pose", {"joints": {"pan": 60.0, "tilt": 15.0}, "seconds": 3.0}),
    ("play", {"move": "look-around", "speed": 1.0, "amplitude": 1.0}),
    ("gaze", {"yaw": 100.0}),
    ("wake_up", {}),
)
FAULTS = ("killed", "frozen", "cut")
_PATIENCE_S = 60.0
T = TypeVar("T")


class DaemonPlayer:
    """A driver that is connected to an address."""

    def __init__(self, address: str) -> None:
        self.context = RecordingContext(Path(tempfile.gettempdir()))
        settings = ReachyMiniSettings(address, libraries=False)
        self.driver = ReachyMini("reachy", settings, self.context)

    async def becomes(self, health: Health) -> None:
        """Wait for what the wizard sees."""
        told = self.context.healths
        await until(lambda: bool(told) and told[-1][0] is health, _PATIENCE_S)

    async def do(self, verb: str, **args: Any) -> None:
        """Carry out a verb."""
        await self.driver.perform(PlainJob(verb, args))

    async def __aenter__(self) -> DaemonPlayer:
        await self.driver.open()
        await self.becomes(Health.CONNECTED)
        await self.do("torque", on=True, by_hand=False)
        await self.do("home", seconds=0.0)
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.driver.close()


async def calls(it: DaemonPlayer, address: str, count: int) -> list[list[str]]:
    """Commands of the driver and the same calls of a bare client, in turns."""
    took: dict[str, list[float]] = {}

    async def timed(name: str, call: Callable[[], Awaitable[T]]) -> T:
        begun = time.perf_counter()
        result = await call()
        took.setdefault(name, []).append((time.perf_counter() - begun) * 1000)
        return result

    link = it.driver._link
    async with (
        aiohttp.ClientSession(f"http://{address}/api/") as session,
        session.ws_connect(f"http://{address}/ws/sdk") as line,
    ):

        async def post(path: str, body: Any) -> Any:
            async with session.post(path, json=body) as answer:
                return await answer.json()

        async def read() -> None:
            async for _ in line:
                pass

        reading = asyncio.create_task(read())

        async def bare_goto(pose: dict[str, float]) -> str:
            return str((await post("move/goto", goto_body(pose, 5.0)))["uuid"])

        async def bare(pose: dict[str, float]) -> None:
            uuid = await timed("goto: bare client", lambda: bare_goto(pose))
            await timed("stop by uuid: bare client", lambda: post("move/stop", {"uuid": uuid}))
            await timed("setpoint: bare client", lambda: line.send_json(target_message(pose)))

        async def own(pose: dict[str, float]) -> None:
            uuid = await timed("goto: driver", lambda: link.goto(pose, 5.0))
            await timed("stop by uuid: driver", lambda: link.end(uuid))
            await timed("setpoint: driver", lambda: link.setpoint(pose))

        for turn in range(count):
            for measured in (bare, own) if turn % 2 else (own, bare):
                await measured({**HOME, "pan": float(turn % 20)})
                await asyncio.sleep(random.uniform(0.0, 0.02))
        reading.cancel()
    rows = []
    for name, values in took.items():
        spread = Spread.of(values)
        rows.append([name, str(spread.count), *(f"{value:.2f}" for value in _three(spread))])
    return rows


def _three(spread: Spread) -> tuple[float, float, float]:
    return spread.p50, spread.p99, spread.worst


async def stops(it: DaemonPlayer, count: int) -> list[list[str]]:
    """In the middle of something that moves."""
    confirmed: list[float] = []
    still: list[float] = []
    missing = 0
    link = it.driver._link
    for turn in range(count):
        verb, args = STOPPED[turn % len(STOPPED)]
        await it.do("pose", joints={"pan": -30.0, "tilt": 0.0, "roll": 10.0}, seconds=0.5)
        command = asyncio.ensure_future(it.do(verb, **args))
        await asyncio.sleep(random.uniform(0.25, 0.35))
        begun = asyncio.get_running_loop().time()
        stopping = asyncio.ensure_future(it.driver.stop(Scope.ALL))
        await asyncio.sleep(0)
        command.cancel()
        report = await stopping
        confirmed.append((asyncio.get_running_loop().time() - begun) * 1000)
        missing += bool(report is None or report.missing)
        await asyncio.gather(command, return_exceptions=True)
        await asyncio.sleep(0.4)
        *poses, (_, stays) = [(at, pose) for at, pose in link._poses if at > begun]
        away = [
            (at - begun) * 1000
            for at, pose in poses
            if max(abs(pose[name] - stays[name]) for name in stays) > 1.0
        ]
        still.append(max(away, default=0.0))
        await it.driver.resume()
    return [
        ["confirmed", str(count), *_range(confirmed), str(missing)],
        ["stands still", str(count), *_range(still), ""],
    ]


def _range(values: list[float]) -> list[str]:
    spread = Spread.of(values)
    return [f"{value:.0f}" for value in (min(values), spread.p50, spread.worst)]


async def faults(daemon: VendorsDaemon, count: int, away_s: float) -> list[list[str]]:
    """Kills, freezes and cut cables, in turns."""
    known: dict[str, list[float]] = {fault: [] for fault in FAULTS}
    back: dict[str, list[float]] = {fault: [] for fault in FAULTS}
    port = int(daemon.address.rpartition(":")[2])
    async with (
        dropping_proxy(port) as network,
        DaemonPlayer(network.address.removeprefix("tcp://")) as it,
    ):
        for turn in range(count):
            fault = FAULTS[turn % len(FAULTS)]
            command = asyncio.ensure_future(
                it.do("pose", joints={"pan": 30.0 if turn % 2 else -30.0}, seconds=30.0)
            )
            await asyncio.sleep(random.uniform(0.2, 0.5))
            begun = time.perf_counter()
            if fault == "killed":
                await daemon.end()
            elif fault == "frozen":
                daemon.send(signal.SIGSTOP)
            else:
                network.cut()
            await it.becomes(Health.LOST)
            with contextlib.suppress(DriverError):
                await command
            known[fault].append((time.perf_counter() - begun) * 1000)
            await asyncio.sleep(max(0.0, away_s - (time.perf_counter() - begun)))
            if fault == "killed":
                await daemon.start()
            elif fault == "frozen":
                daemon.send(signal.SIGCONT)
            else:
                network.heal()
            recovered = time.perf_counter()
            await it.becomes(Health.CONNECTED)
            back[fault].append((time.perf_counter() - recovered) * 1000)
            await it.driver.stop(Scope.ALL)
            await it.driver.resume()
    return [
        [fault, str(len(known[fault])), *_range(known[fault]), *_range(back[fault])]
        for fault in FAULTS
        if known[fault]
    ]


async def measure(given: argparse.Namespace) -> None:
    """One daemon for all of it."""
    with tempfile.TemporaryDirectory() as folder:
        daemon = VendorsDaemon(given.backend, Path(folder))
        await daemon.start()
        try:
            async with DaemonPlayer(daemon.address) as it:
                rows = await calls(it, daemon.address, given.calls)
                table("calls, ms", ("", "calls", "p50", "p99", "worst"), rows)
                head = ("", "stops", "least", "p50", "worst", "not confirmed")
                table("from the stop, ms", head, await stops(it, given.stops))
            columns = ("faults", "known ms: least", "p50", "worst", "back: least", "p50", "worst")
            rows = await faults(daemon, given.faults, given.away)
            table("a daemon that goes", ("", *columns), rows)
        finally:
            daemon.send(signal.SIGCONT)
            await daemon.end()


def main() -> int:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument("--calls", type=int, default=300, help="of each kind")
    parser.add_argument("--stops", type=int, default=30)
    parser.add_argument("--faults", type=int, default=50)
    parser.add_argument("--away", type=float, default=2.5, help="seconds until it comes back")
    parser.add_argument("--backend", choices=sorted(BACKENDS), default="mockup")
    parser.add_argument("--quick", action="store_true", help="a few of each")
    given = parser.parse_args()
    if given.quick:
        given.calls, given.stops, given.faults, given.away = 5, 4, 3, 0.5
    print(f"{given.backend}; {machine()}")
    try:
        asyncio.run(measure(given))
    except pytest.skip.Exception as absent:
        print(absent)
    return 0


if __name__ == "__main__":
    sys.exit(main())
