"""The stand-in as a process: `python -m naoqi_simulator`."""

from __future__ import annotations

import argparse
import asyncio
import importlib.util
import json
import os
import signal
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Protocol

from naoqi_simulator.control import Control
from naoqi_simulator.life import STATES
from naoqi_simulator.passing import PacedTime
from naoqi_simulator.pepper import Pepper
from naoqi_simulator.table import Service
from naoqi_simulator.world import Clients, Options, World

SERVERS = ("auto", "qi", "own")
#: The package `qi` calls from threads of its own; a real robot has no interpreter to wait for.
SWITCH_S = 0.0005

EPILOG = """\
The first line on standard output says where it listens: {"address": "tcp://127.0.0.1:PORT"}.

To rehearse: start it with `--port 9559`, write `robots: [127.0.0.1]` in the robot file, and play.
Or write `robots: [simulated]`, and the driver starts one by itself.

--control takes one JSON object a line on standard input and answers one a line:
  {"do": "get", "name": "state"}                        everything that can be seen
  {"do": "set", "name": "front", "value": 0.3}          something stands 0.3 m ahead
  {"do": "set", "name": "drift", "value": true}         it changes its autonomy by itself now
  {"do": "person", "who": {"distance": 1.2, "talking": true, "name": "Ada"}}
  {"do": "person", "who": null}                         nobody; "auto": by the seed again
  {"do": "touch", "x": 0.5, "y": 0.5}                   somebody touches the tablet
  {"do": "fault", "kind": "slow:300", "seconds": 5}     every answer 300 ms late
  {"do": "trace"}, {"do": "clear"}
Faults: killed, frozen, deaf, slow:MS, refuse:SERVICE.METHOD,...=TEXT, says-no (moves),
moody, invalid-signature (ALMemory), none. The service StandIn on the wire does the same.
"""


class Host(Clients, Protocol):
    """What carries the services: the package qi, or our own server."""

    def offer(self, services: Mapping[str, Service]) -> None:
        """Offer all services as soon as it listens."""
        ...

    async def listen(self, host: str, port: int) -> str:
        """Listen and return the address. Raises OSError when that port cannot be had."""
        ...

    async def close(self) -> None:
        """Hang up on everybody."""
        ...


def parser() -> argparse.ArgumentParser:
    """What the command line takes."""
    made = argparse.ArgumentParser(
        prog="python -m naoqi_simulator",
        description="A simulated Pepper that speaks NAOqi's protocol.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add = made.add_argument
    add("--host", default="127.0.0.1", help="address to listen on (default: this machine only)")
    add("--port", type=int, default=0, help="0: any that is free")
    add("--server", choices=SERVERS, default="auto", help="auto: qi if it is installed, else own")
    add("--pace", type=float, default=1.0, help="how fast its time passes; 10: ten times as fast")
    add("--seed", type=int, default=7, help="of the visitors and of moods")
    add("--visitors", choices=("seeded", "none"), default="seeded", help="people who come and go")
    add("--life", choices=STATES, default="solitary", help="autonomous life at the start")
    add("--moody", action="store_true", help="it changes its autonomy by itself now and then")
    add("--naoqi", default="2.5.10.7", metavar="VERSION", help="what ALSystem says it is")
    add("--subscriber", action="store_true", help="ALMemory.subscriber works, unlike in 2.5.8")
    add("--files", type=Path, help="folder that is the root of its file system")
    add("--control", action="store_true", help="orders on standard input, see below")
    return made


def chosen_server(wanted: str) -> str:
    """`qi` or `own`."""
    if wanted == "auto":
        return "qi" if importlib.util.find_spec("qi") else "own"
    return wanted


def main(arguments: list[str] | None = None) -> int:
    """Run until SIGTERM, SIGINT, or the end of the orders."""
    given = parser().parse_args(arguments)
    out = _own_output()
    try:
        sys.setswitchinterval(SWITCH_S)
        asyncio.run(_serve(given, out))
    except (OSError, ValueError) as error:
        sys.stderr.write(f"{error}\n")
        return 2
    finally:
        os.close(out)
    # The library's threads may still be busy; nothing of ours is left to save.
    sys.stderr.flush()
    os._exit(0)


def _own_output() -> int:
    """Our own standard output: whatever a library prints goes to standard error from here on."""
    out = os.dup(1)
    os.dup2(2, 1)
    return out


async def _serve(given: argparse.Namespace, out: int) -> None:
    loop = asyncio.get_running_loop()
    options = Options(
        seed=given.seed,
        visitors=given.visitors == "seeded",
        life=given.life,
        moody=given.moody,
        invalid_signature=not given.subscriber,
        version=given.naoqi,
        files=given.files,
    )
    pepper = Pepper(World(PacedTime(given.pace), options))
    host, address = await start(pepper, chosen_server(given.server), given.host, given.port)
    ended = asyncio.Event()
    for one in (signal.SIGTERM, signal.SIGINT):
        loop.add_signal_handler(one, ended.set)
    os.write(out, json.dumps({"address": address}).encode() + b"\n")
    tasks = {asyncio.ensure_future(pepper.live()), asyncio.ensure_future(ended.wait())}
    if given.control:
        tasks.add(asyncio.ensure_future(Control(pepper, out).run()))
    done, going = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    for task in going:
        task.cancel()
    await host.close()
    for task in done:
        task.result()


async def start(pepper: Pepper, server: str, host: str, port: int) -> tuple[Host, str]:
    """Let a robot be reached; how to hang up, and the address. Raises OSError."""
    hosting = _host(pepper, server)
    hosting.offer(pepper.services)
    address = await hosting.listen(host, port)
    pepper.world.clients = hosting
    return hosting, address


def _host(pepper: Pepper, server: str) -> Host:
    desk = pepper.world.desk
    if server == "own":
        from naoqi_simulator.host_own import OwnHost  # noqa: PLC0415 - only the one is needed

        return OwnHost(desk)
    try:
        from naoqi_simulator.host_qi import QiHost  # noqa: PLC0415 - only where it is installed

        return QiHost(desk, asyncio.get_running_loop())
    except ImportError as error:
        raise OSError(f"{error}; install woz-tui[pepper], or use --server own") from None
