"""`woz hands`: what the hands at this computer hold plays a session, here or elsewhere."""

from __future__ import annotations

import asyncio
import contextlib
import os
import shlex
import socket
import sys
import threading
from argparse import ArgumentParser, Namespace
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

from woz_tui.cli.error_sentences import CommandErrors
from woz_tui.cli.session_choice import (
    JoinedSession,
    add_session_choice,
    find_session,
    joined_session,
)
from woz_tui.console.hand_client import HandClient
from woz_tui.drivers import plugins
from woz_tui.drivers.contract import DriverError
from woz_tui.protocol.codec import MAX_LINE
from woz_tui.system.clock import RealClock
from woz_tui.system.tasks import until_first_ends

ERRORS = CommandErrors(DriverError)
#: The driver that knows gamepads, Stream Decks and the others.
DRIVER = "hands"
#: How often what is held is looked at, in seconds, and how soon a lost session is looked for.
TICK_S, AGAIN_S = 0.02, 2.0
#: A line from the session may be long: the welcome holds the whole state.
_LINE_LIMIT = 16 * MAX_LINE
#: So that a dead network is noticed; the session itself lets go long before.
_SSH = ("ssh", "-T", "-o", "ServerAliveInterval=5", "-o", "ServerAliveCountMax=2")


def add(parser: ArgumentParser) -> None:
    add_session_choice(parser)
    parser.add_argument(
        "--to", default="", metavar="HOST", help="the session runs there; ssh is started"
    )
    parser.add_argument(
        "--device",
        action="append",
        default=[],
        metavar="[PANEL=]DEVICE",
        help="only this device: a path, or part of its name; may be repeated",
    )
    parser.add_argument(
        "--take-over", action="store_true", help="take panels that are in other hands"
    )
    parser.add_argument(
        "--woz", default="woz", metavar="COMMAND", help="with --to: how woz is called there"
    )
    mode = parser.add_mutually_exclusive_group()
    mode.add_argument(
        "--show", action="store_true", help="show the names of controls that are moved, and no more"
    )
    mode.add_argument(
        "--into",
        action="store_true",
        help="connect standard input and output to the session: what --to starts by ssh",
    )


def run(arguments: Namespace) -> int:
    """Read devices until the session ends, or ctrl+c."""
    if arguments.to and arguments.access is not None:
        print("woz: --to goes by ssh, --access does not: leave one out", file=sys.stderr)
        return 2
    if arguments.into:
        return _into(arguments)
    return asyncio.run(_watch_devices(arguments))


# -- standard input and output as a session's socket -----------------------------------------------


def _into(arguments: Namespace) -> int:
    """Carry bytes both ways; whoever ends first ends both, so that the session lets go at once."""
    path = find_session(arguments.name, "woz hands --to ROBOT")
    if path is None:
        return 1
    with socket.socket(socket.AF_UNIX) as session:
        session.connect(str(path))
        threading.Thread(target=_copy_in, args=(session,), daemon=True).start()
        with contextlib.suppress(OSError):
            while data := session.recv(1 << 16):
                while data:
                    data = data[os.write(sys.stdout.fileno(), data) :]
    return 0


def _copy_in(session: socket.socket) -> None:
    with contextlib.suppress(OSError):
        while data := os.read(sys.stdin.fileno(), 1 << 16):
            session.sendall(data)
    with contextlib.suppress(OSError):
        session.shutdown(socket.SHUT_RDWR)


# -- reading devices -------------------------------------------------------------------------------


async def _watch_devices(arguments: Namespace) -> int:
    catalogue = plugins.installed()
    if DRIVER not in catalogue:
        raise plugins.PluginError(f"no installed package offers the driver {DRIVER!r}")
    split = [argument.rpartition("=") for argument in arguments.device]
    panel_of = {device: panel for panel, _, device in split}
    panels: Any = catalogue[DRIVER]
    watch = panels.watch(list(panel_of))
    watch.on_trouble = _say_trouble
    if arguments.show:
        watch.on_found = _ShownDevice
        await watch.run()
    client = HandClient(RealClock(), _say, panel_of=panel_of, take_over=arguments.take_over)
    watch.on_found = client.add
    return await _play(arguments, client, watch)


def _say(line: str) -> None:
    print(line, flush=True)


def _say_trouble(what: str, remedy: str) -> None:
    _say(f"{what}{remedy and f' ({remedy})'}")


class _ShownDevice:
    """Prints what is moved on a device."""

    def __init__(self, device: Any) -> None:
        self._device = device
        self._before: dict[str, float] = {}
        device.on_change, device.on_gone = self._changed, self._gone
        _say(f"{device.path}: {device.name} ({device.kind})")

    def _changed(self) -> None:
        held = self._device.held
        for name in sorted(self._before.keys() | held.keys()):
            value = held.get(name, 0.0)
            if value != self._before.get(name, 0.0):
                _say(f"  {name} {value:g}")
        self._before = {**held}

    def _gone(self) -> None:
        _say(f"{self._device.path}: gone")


async def _play(arguments: Namespace, client: HandClient, watch: Any) -> int:
    """Until the session ends, or devices cannot be read any more."""
    welcomed = asyncio.Event()
    with contextlib.ExitStack() as stack:
        session = None
        if not arguments.to:
            joining = joined_session(arguments.access, arguments.name, "woz hands")
            session = stack.enter_context(joining)
            if session is None:
                return 1
        code: int = await until_first_ends(
            _follow(arguments, session, client, welcomed),
            _read(client, watch, welcomed),
            _tick(client),
        )
    return code


async def _read(client: HandClient, watch: Any, welcomed: asyncio.Event) -> None:
    """Read the devices of the session's panels, from the first welcome on."""
    await welcomed.wait()
    await watch.run({one.device for one in client.panels.values()})


async def _tick(client: HandClient) -> None:
    while True:
        client.tick()
        await asyncio.sleep(TICK_S)


async def _follow(
    arguments: Namespace,
    session: JoinedSession | None,
    client: HandClient,
    welcomed: asyncio.Event,
) -> int:
    """Hand on what the session says, over one connection after the other; the exit code."""
    path = session.path if session is not None else None
    while True:
        connected = False
        try:
            async with _connected(arguments, path) as (
                reader,
                writer,
            ):
                client.connect(writer.write)
                while line := await _line(reader):
                    connected = True
                    client.receive(line)
                    if client.turned_away:
                        return 1
                    if client.welcomed:
                        welcomed.set()
        except OSError:
            if not welcomed.is_set():
                raise
        finally:
            client.disconnect()
        if client.ended:
            _say("the session has ended")
            return 0
        if not welcomed.is_set():
            _say("no session answered; if woz was not found there, say where it is: --woz PATH")
            return 1
        if session is not None and session.barred:
            _say(session.barred)
            return 1
        if connected:
            _say("the connection to the session is lost; looking for it again")
        await asyncio.sleep(AGAIN_S)


async def _line(reader: asyncio.StreamReader) -> bytes:
    """The next line; empty at the end."""
    with contextlib.suppress(OSError, ValueError):
        return await reader.readline()
    return b""


@asynccontextmanager
async def _connected(
    arguments: Namespace, path: Path | None
) -> AsyncIterator[tuple[asyncio.StreamReader, asyncio.StreamWriter]]:
    """The session's end of a line: its socket here, or ssh's pipes. Raises `OSError`."""
    if path is not None:
        reader, writer = await asyncio.open_unix_connection(path, limit=_LINE_LIMIT)
        try:
            yield reader, writer
        finally:
            writer.close()
        return
    into = f"{arguments.woz} hands --into"
    if arguments.name:
        into += f" {shlex.quote(arguments.name)}"
    ssh = await asyncio.create_subprocess_exec(
        *_SSH,
        arguments.to,
        into,
        stdin=asyncio.subprocess.PIPE,
        stdout=asyncio.subprocess.PIPE,
        limit=_LINE_LIMIT,
    )
    assert ssh.stdin is not None
    assert ssh.stdout is not None
    try:
        yield ssh.stdout, ssh.stdin
    finally:
        ssh.stdin.close()
        with contextlib.suppress(ProcessLookupError):
            ssh.terminate()
        await ssh.wait()
