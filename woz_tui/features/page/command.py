"""`woz page`: a running session in browsers, for a class that watches and for the participant."""

from __future__ import annotations

import asyncio
import contextlib
import ipaddress
import signal
import socket
import ssl
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

from woz_tui.cli.error_sentences import CommandErrors
from woz_tui.cli.session_choice import JoinedSession, add_session_choice, joined_session
from woz_tui.client import WozError, connect
from woz_tui.console.link.message_feed import Loss
from woz_tui.features.page.qr import MissingQrError, drawn, modules
from woz_tui.features.page.visitors import PageRole, Visitors
from woz_tui.network.listen_address import ListenAddress
from woz_tui.system.tasks import until_first_ends

#: Where it listens unless something else is said: on this computer alone.
HERE = "127.0.0.1:8080"
#: What `--plain` means, in words for whoever began it.
OPEN = (
    "Without encryption: whoever is in this network can read the pages, what participants answer"
    " included. For a network of your own only."
)
#: For whom the page of a role is, above its QR code.
_FOR = {PageRole.WATCH: "To watch:", PageRole.ANSWER: "The participant:"}
#: Nobody listens there: it only says by which of its addresses this computer reaches others.
_ELSEWHERE = ("192.0.2.1", 9)


class PageError(Exception):
    """Pages cannot be served so; the text says why."""


ERRORS = CommandErrors(PageError, MissingQrError)


def add(parser: ArgumentParser) -> None:
    add_session_choice(parser, "session")
    parser.add_argument(
        "--at",
        default=HERE,
        metavar="HOST:PORT",
        help=f"where browsers find it (default {HERE}: on this computer, or through `ssh -L`)",
    )
    parser.add_argument(
        "--plain",
        action="store_true",
        help="allow another address than this computer's own without encryption: everybody in the"
        " network can read the pages and what participants answer",
    )
    parser.add_argument(
        "--certificate",
        type=Path,
        metavar="FILE",
        help="encrypt with this certificate (PEM, with what signed it); needs --key",
    )
    parser.add_argument("--key", type=Path, metavar="FILE", help="the certificate's private key")
    parser.add_argument(
        "--name",
        action="append",
        default=[],
        metavar="NAME",
        help="a further name by which browsers call this computer, such as robot.local",
    )
    parser.add_argument(
        "--debrief",
        action="store_true",
        help="when the session is over, show its report to all who watch, conditions included;"
        " until ctrl+c",
    )
    parser.add_argument(
        "--qr",
        action="store_true",
        help="print the addresses for the participant and to watch as QR codes, too",
    )
    parser.add_argument(
        "--tablet",
        action="store_true",
        help="show the participant's page on the robot's own tablet (its verb `screen`)",
    )


def run(arguments: Namespace) -> int:
    """Serve until the session ends, or ctrl+c."""
    at, tls = _address(arguments)
    if arguments.debrief and arguments.access is not None:
        raise PageError("--debrief needs the log, which is on the robot's computer: begin it there")
    if arguments.qr:
        modules("")  # else it would fail when somebody waits already
    with joined_session(arguments.access, arguments.session, "woz page") as session:
        if session is None:
            return 1
        with contextlib.suppress(KeyboardInterrupt):
            asyncio.run(_pages(session, at, tls, arguments))
    return 0


def _address(arguments: Namespace) -> tuple[ListenAddress, ssl.SSLContext | None]:
    """Where to listen, and with which encryption. Raises `PageError`."""
    try:
        at = ListenAddress.read(arguments.at)
    except ValueError as error:
        raise PageError(str(error)) from error
    if (arguments.certificate is None) != (arguments.key is None):
        raise PageError("--certificate and --key belong together")
    if arguments.certificate is not None:
        tls = ssl.create_default_context(ssl.Purpose.CLIENT_AUTH)
        try:
            tls.load_cert_chain(arguments.certificate, arguments.key)
        except (OSError, ssl.SSLError) as error:
            raise PageError(f"{arguments.certificate}: {error}") from error
        return at, tls
    if not (arguments.plain or _is_here(at.host)):
        raise PageError(
            f"{arguments.at} is not this computer alone, and without a certificate"
            " everybody in the network can read the pages: --plain allows that, --certificate"
            f" encrypts, and `ssh -L 8080:{HERE} ROBOT` shows pages of {HERE} elsewhere"
        )
    return at, None


def _is_here(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


async def _pages(
    session: JoinedSession, at: ListenAddress, tls: ssl.SSLContext | None, arguments: Namespace
) -> None:
    from woz_tui.features.page.server import PageServer  # noqa: PLC0415 - aiohttp, here alone

    say = partial(print, flush=True)
    explain: Callable[[Loss], Loss] | None = session.line.explained if session.line else None
    own = {socket.gethostname(), f"{socket.gethostname()}.local", "localhost", *arguments.name}
    is_open = tls is None and not _is_here(at.host)
    name = "page, not encrypted" if is_open else "page"
    server = PageServer(session.path, own, say, explain, name=name, debrief=arguments.debrief)
    stopped = asyncio.Event()
    asyncio.get_running_loop().add_signal_handler(signal.SIGTERM, stopped.set)
    try:
        host, port = await server.start(at, tls)
        scheme = "https" if tls is not None else "http"
        here = f"{scheme}://{_reached(host)}:{port}"
        for line in _told(server.visitors, here):
            say(line)
        for role in PageRole if arguments.qr else ():
            code = modules(f"{here}/join/{server.visitors.codes[role]}")
            say("", _FOR[role], *drawn(code, colours=sys.stdout.isatty()), sep="\n")
        if is_open:
            say(OPEN)
        if arguments.tablet:
            await _show_on_tablet(session, _participants_address(server.visitors, here))
        await until_first_ends(server.until_over(), stopped.wait())
    finally:
        await server.close()


def _told(visitors: Visitors, here: str) -> Iterator[str]:
    """Which address is for whom."""
    yield f"To watch:         {here}/join/{visitors.codes[PageRole.WATCH]}"
    yield f"For a class:      {here}/ with the code {visitors.class_code}"
    yield f"The participant:  {_participants_address(visitors, here)}"
    yield "Nothing there plays or stops the robot. The codes end with this command (ctrl+c)."


def _participants_address(visitors: Visitors, here: str) -> str:
    return f"{here}/join/{visitors.codes[PageRole.ANSWER]}"


async def _show_on_tablet(session: JoinedSession, address: str) -> None:
    """Have the robot's tablet show an address; why it does not is printed, and the pages go on."""
    try:
        async with connect(session.path, name="page") as client:
            await client.perform("screen", file=address)
    except WozError as error:
        print(f"woz: the robot's tablet does not show the page: {error}", file=sys.stderr)


def _reached(host: str) -> str:
    """How others call an address on which this computer listens; of all, that of its network."""
    if ipaddress.ip_address(host).is_unspecified:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            try:
                probe.connect(_ELSEWHERE)  # sends nothing
            except OSError:
                return socket.gethostname()
            return str(probe.getsockname()[0])
    return f"[{host}]" if ":" in host else host
