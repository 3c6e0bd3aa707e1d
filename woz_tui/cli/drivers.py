"""`woz drivers`: offer the drivers of this computer to a session on another one of the robot."""

from __future__ import annotations

import asyncio
import contextlib
import os
import signal
import socket
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Sequence
from datetime import datetime
from hashlib import sha256
from pathlib import Path
from typing import TextIO

from woz_tui.cli.argument_types import listen_address
from woz_tui.cli.error_sentences import CommandErrors
from woz_tui.config.loading import load_robot
from woz_tui.drivers import plugins
from woz_tui.network.certificates import AccessError, AccessFile
from woz_tui.network.driver_line import LineError
from woz_tui.network.driver_server import DriverServer, OfferedDriver
from woz_tui.network.listen_address import DRIVERS_LISTEN, ListenAddress
from woz_tui.network.zenoh_line import connect
from woz_tui.session.driver_faults import tell_faults
from woz_tui.system import session_sockets

ERRORS = CommandErrors(AccessError, LineError, ValueError, who="woz drivers")
#: How long until the session is looked for again, in seconds.
RETRY_S = 1.0
_PORT = DRIVERS_LISTEN.rpartition(":")[2]


def add(parser: ArgumentParser) -> None:
    parser.add_argument(
        "--serve",
        type=Path,
        required=True,
        metavar="ROBOT_FILE",
        help="the robot file of the session; drivers with `at: NAME` are offered here",
    )
    parser.add_argument(
        "--access",
        type=Path,
        default=None,
        metavar="FILE",
        help="what lets this computer in, and gives it its name: `woz access new NAME`",
    )
    parser.add_argument(
        "--at", default="", metavar="NAME", help="this computer's name (default: the access file's)"
    )
    parser.add_argument(
        "address",
        type=listen_address,
        nargs="?",
        default="",
        metavar="HOST:PORT",
        help=f"the session's computer (default: the access file's, port {_PORT})",
    )


def run(arguments: Namespace) -> int:
    """Offer them until ctrl+c or a signal to end, whatever becomes of the terminal."""
    access = AccessFile.read(arguments.access) if arguments.access is not None else None
    address: str = arguments.address
    if not address:  # the host is the access file's; its port is that of sessions over a network
        if access is None or not access.address:
            raise AccessError(f"where is the session? add HOST:PORT, such as robot.local:{_PORT}")
        address = f"{access.address.rpartition(':')[0]}:{_PORT}"
    if not ListenAddress.read(address).plain and access is None:
        raise AccessError(
            "this computer needs an access file: make one on the robot with `woz access new NAME`,"
            " then woz drivers --serve ROBOT_FILE --access NAME.access"
        )
    place, offers = _offers(arguments.serve, arguments.at or (access.name if access else ""))
    names = ", ".join(offer.name for offer in offers)
    with _only_one(place, address):
        tell(f"{place} offers {names} to the session at {address}; ctrl+c ends it")
        with contextlib.suppress(KeyboardInterrupt):
            asyncio.run(_serve(place, offers, arguments.serve.absolute().parent, address, access))
    return 0


@contextlib.contextmanager
def _only_one(place: str, address: str) -> Iterator[None]:
    """Raises `ValueError` if a program of this user offers the same already: one whose terminal was
    closed is not in sight.
    """
    # A name that is no file: the user's folder for sockets goes with the last login, it does not.
    what = sha256(f"{place} {address}".encode()).hexdigest()
    name = f"\0woz-drivers-{os.getuid()}-{what}"
    with socket.socket(socket.AF_UNIX) as mine:
        try:
            mine.bind(name)
        except OSError as error:
            message = f"a program here offers them to {address} already"
            with contextlib.suppress(OSError), socket.socket(socket.AF_UNIX) as other:
                other.setblocking(False)
                other.connect(name)
                message += f"; `kill {session_sockets.peer_pid(other)}` ends it"
            raise ValueError(message) from error
        mine.listen()
        yield


def _offers(file: Path, place: str) -> tuple[str, list[OfferedDriver]]:
    catalogue = plugins.installed()
    drivers = load_robot(file, catalogue)
    places = sorted({spec.at.name for spec in drivers if spec.at is not None})
    if not place and len(places) == 1:
        place = places[0]
    offers = [
        OfferedDriver(spec.name, spec.type, catalogue[spec.type], spec.settings)
        for spec in drivers
        if spec.at is not None and spec.at.name == place
    ]
    if not offers:
        has = f"its drivers are at {', '.join(places)}" if places else "it has no `at:`"
        raise ValueError(f"{file} has no driver with `at: {place or 'NAME'}`; {has}")
    return place, offers


def tell(text: str) -> None:
    """One line, with the time of day."""
    _print(f"{datetime.now().astimezone():%H:%M:%S} {text}", sys.stdout)


def _print(text: str, file: TextIO) -> None:
    with contextlib.suppress(OSError):  # the terminal is gone: nobody reads this
        print(text, file=file, flush=True)


async def _serve(
    place: str,
    offers: Sequence[OfferedDriver],
    folder: Path,
    address: str,
    access: AccessFile | None,
) -> None:
    loop, running = asyncio.get_running_loop(), asyncio.current_task()
    assert running is not None
    signal.signal(signal.SIGHUP, signal.SIG_IGN)  # a closed terminal does not take the robot away
    for number in (signal.SIGTERM, signal.SIGINT):
        loop.add_signal_handler(number, running.cancel)
    server = DriverServer(place, offers, folder=folder, tell=tell)
    tell_faults(server.made, f"its traceback is at {place}")
    told = ""
    with contextlib.suppress(asyncio.CancelledError):
        while True:
            connecting = loop.run_in_executor(None, connect, address, access)
            try:
                line = await asyncio.shield(connecting)
            except LineError as error:
                remedy = f" ({error.remedy})" if error.remedy else ""
                if str(error) != told:
                    told = str(error)
                    _print(f"woz drivers: {error}{remedy}; trying again", sys.stderr)
                await asyncio.sleep(RETRY_S)
                continue
            try:
                await server.run(line)
            finally:
                await asyncio.to_thread(line.close)
