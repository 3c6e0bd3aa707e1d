"""`woz page`: a running session in browsers, for a class that watches and for the participant."""

from __future__ import annotations

import asyncio
import contextlib
import ipaddress
import logging
import signal
import socket
import ssl
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Collection
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from woz_tui.cli.error_sentences import CommandErrors
from woz_tui.cli.session_choice import JoinedSession, add_session_choice, joined_session
from woz_tui.client import WozError, connect
from woz_tui.console.link.message_feed import Loss
from woz_tui.features.page.control import PageControl, open_pages, order
from woz_tui.features.page.kinds import MOST_TEXT, AskPageTell, PageFailed, PageOpened
from woz_tui.features.page.qr import MissingQrError, drawn, modules
from woz_tui.features.page.section import HERE
from woz_tui.features.page.visitors import PageRole, Visitors
from woz_tui.network.listen_address import ListenAddress, is_loopback
from woz_tui.system.tasks import TaskSet, end_tasks, until_first_ends

if TYPE_CHECKING:  # aiohttp
    from woz_tui.features.page.server import PageServer

#: Orders to a page that runs.
CODES, NEW_CODE = "codes", "new-code"
_ALL = tuple(role.value for role in PageRole)
#: What `--plain` means, in words for whoever began it.
OPEN = (
    "Without encryption: whoever is in this network can read the pages, what participants answer"
    " included. For a network of your own only."
)
#: The last line behind the addresses.
ENDS = "Nothing there plays or stops the robot. The codes end with this command (ctrl+c)."
#: For whom the page of a role is, above its QR code.
_FOR = {PageRole.WATCH: "To watch:", PageRole.ANSWER: "The participant:"}
#: Nobody listens there: it only says by which of its addresses this computer reaches others.
_ELSEWHERE = ("192.0.2.1", 9)


log = logging.getLogger(__name__)


class PageError(Exception):
    """Pages cannot be served so; the text says why."""


ERRORS = CommandErrors(PageError, MissingQrError)


def add(parser: ArgumentParser) -> None:
    add_session_choice(parser, "session")
    parser.add_argument(
        "of",
        nargs="?",
        default="",
        metavar="SESSION",
        help=f"behind `{CODES}`, which prints the addresses and codes of a page that runs, and"
        f" `{NEW_CODE}`, which replaces them: whoever came in by the old ones is out",
    )
    parser.add_argument(
        "--for",
        dest="roles",
        action="append",
        choices=[role.value for role in PageRole],
        help="for whom: to watch, or to answer (default: both)",
    )
    parser.add_argument(
        "--questionnaire",
        default="",
        metavar="NAME",
        help="begin this questionnaire by itself when the participant opens the page",
    )
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
        "--pictures",
        action="append",
        default=[],
        metavar="DRIVER",
        help="show all who watch the pictures of this driver's camera, and whoever is before it",
    )
    parser.add_argument(
        "--tablet",
        action="store_true",
        help="show the participant's page on the robot's own tablet (its verb `screen`)",
    )


def run(arguments: Namespace) -> int:
    """Serve until the session ends, or ctrl+c."""
    roles = [role for role in PageRole if role.value in (arguments.roles or _ALL)]
    if arguments.session in (CODES, NEW_CODE):
        return _order(arguments.of, roles if arguments.session == NEW_CODE else ())
    if arguments.of:
        raise PageError(f"{arguments.session!r} is no order: {CODES}, {NEW_CODE}, or a session")
    return _serve(arguments, roles)


def _order(session: str, renew: Collection[PageRole]) -> int:
    """Print addresses and codes of pages that run, with others for these roles."""
    pages = open_pages(session)
    answers = [told for told in (order(path, renew) for path in pages) if told is not None]
    if not answers:
        raise PageError("no page is open here; `woz page` opens one")
    if renew and len(answers) > 1 and not session:
        names = ", ".join(path.name.partition(".")[0] for path in pages)
        print(f"woz: all of these have new codes: {names}", file=sys.stderr)
    print("\n\n".join("\n".join(told) for told in answers))
    return 0


def _serve(arguments: Namespace, roles: Collection[PageRole]) -> int:
    at, tls = _address(arguments)
    if arguments.debrief and arguments.access is not None:
        raise PageError("--debrief needs the log, which is on the robot's computer: begin it there")
    if arguments.qr:
        modules("")  # else it would fail when somebody waits already
    with joined_session(arguments.access, arguments.session, "woz page") as session:
        if session is None:
            return 1
        with contextlib.suppress(KeyboardInterrupt):
            asyncio.run(_pages(session, at, tls, arguments, roles))
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
    if not (arguments.plain or is_loopback(at.host)):
        raise PageError(
            f"{arguments.at} is not this computer alone, and without a certificate"
            " everybody in the network can read the pages: --plain allows that, --certificate"
            f" encrypts, and `ssh -L 8080:{HERE} ROBOT` shows pages of {HERE} elsewhere"
        )
    return at, None


async def _pages(
    session: JoinedSession,
    at: ListenAddress,
    tls: ssl.SSLContext | None,
    arguments: Namespace,
    roles: Collection[PageRole],
) -> None:
    from woz_tui.features.page.server import PageServer  # noqa: PLC0415 - aiohttp, here alone

    say = partial(print, flush=True)
    explain: Callable[[Loss], Loss] | None = session.line.explained if session.line else None
    own = {socket.gethostname(), f"{socket.gethostname()}.local", "localhost", *arguments.name}
    is_open = tls is None and not is_loopback(at.host)
    name = "page, not encrypted" if is_open else "page"
    server = PageServer(
        session.path,
        own,
        say,
        explain,
        name=name,
        debrief=arguments.debrief,
        roles=roles,
        begins=arguments.questionnaire,
        cameras=arguments.pictures,
    )
    control: PageControl | None = None
    teller: SessionTeller | None = None
    on_tablet = TaskSet("the robot's tablet")
    stopped = asyncio.Event()
    asyncio.get_running_loop().add_signal_handler(signal.SIGTERM, stopped.set)
    try:
        host, port = await server.start(at, tls)
        scheme = "https" if tls is not None else "http"
        here = f"{scheme}://{_reached(host)}:{port}"
        _check_questionnaire(server, arguments.questionnaire)
        told = partial(_told, server.visitors, here)

        def show_on_tablet() -> None:
            if arguments.tablet and PageRole.ANSWER in roles:
                address = _participants_address(server.visitors, here)
                on_tablet.start(_show_on_tablet(session, address))

        async def renew(wanted: Collection[PageRole]) -> None:
            await server.renew(wanted)
            if PageRole.ANSWER in wanted:
                show_on_tablet()

        control = PageControl(session.path.stem, port, told, renew)
        await control.start()
        teller = SessionTeller(session.path, here, server)
        for line in told():
            say(line)
        for role in server.visitors.codes if arguments.qr else ():
            code = modules(f"{here}/join/{server.visitors.codes[role]}")
            say("", _FOR[role], *drawn(code, colours=sys.stdout.isatty()), sep="\n")
        if is_open:
            say(OPEN)
        show_on_tablet()
        await until_first_ends(server.until_over(), stopped.wait())
    finally:
        if control is not None:
            await control.close()
        await on_tablet.close()
        if teller is not None:
            await teller.close()
        await server.close()


class SessionTeller:
    """Tells the session where its pages are, and what of them has failed."""

    def __init__(self, path: Path, here: str, server: PageServer) -> None:
        self._path, self._here, self._server = path, here, server
        self._lines: asyncio.Queue[PageOpened | PageFailed] = asyncio.Queue()
        server.on_class_code = self.tell_opened
        server.failures.tell_session = self.tell_failed
        self.tell_opened()
        self._telling = asyncio.create_task(self._tell(), name="what is told of the pages")

    def tell_opened(self) -> None:
        """Where they are now, with the class's code."""
        visitors = self._server.visitors
        opened = PageOpened(
            address=self._here,
            class_code=visitors.class_code if PageRole.WATCH in visitors.codes else "",
            roles=[role.value for role in visitors.codes],
            encrypted=self._here.startswith("https:"),
        )
        self._lines.put_nowait(opened)

    def tell_failed(self, why: str) -> None:
        """What has failed."""
        self._lines.put_nowait(PageFailed(why=why[:MOST_TEXT]))

    async def close(self) -> None:
        """Nothing more is told."""
        await end_tasks(self._telling)

    async def _tell(self) -> None:
        """Nobody sits at this connection: it keeps no session up."""
        try:
            async with connect(self._path, name="page", unattended=True) as client:
                while True:
                    await client.request(AskPageTell(told=await self._lines.get()))
        except WozError as error:  # from another computer it may be no program
            log.info("the session is not told of its pages: %s", error)


def _check_questionnaire(server: PageServer, name: str) -> None:
    """Raise `PageError` unless the session has it."""
    there = [each.name for each in server.watching.state.settings.study.questionnaires]
    if name and server.watching.state.welcomed and name not in there:
        listed = f"there are {', '.join(there)}" if there else "there is none"
        raise PageError(f"the session has no questionnaire {name!r}; {listed}")


def _told(visitors: Visitors, here: str) -> list[str]:
    """Which address is for whom."""
    lines = []
    if PageRole.WATCH in visitors.codes:
        lines.append(f"To watch:         {here}/join/{visitors.codes[PageRole.WATCH]}")
        lines.append(f"For a class:      {here}/ with the code {visitors.class_code}")
    if PageRole.ANSWER in visitors.codes:
        lines.append(f"The participant:  {_participants_address(visitors, here)}")
    return [*lines, ENDS]


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
