"""Serves one session to other machines: WebSocket with TLS, a certificate for each name.

A process of its own beside the robot process, so that nothing that strangers send can delay the
robot. What a client sends is examined here, request by request, and goes on to the session's
socket; the session decides as for local clients. Two paths: `/session` carries the lines of the
protocol, `/clock` tells this machine's time, so that a client can stamp its requests with it.

The robot process writes `{"roles": {NAME: ROLE}}` to standard input, as often as it changes; its
end ends this process. Standard output has one JSON object a line: `listening` (an address),
`refused` (who and why) or `trouble` (why there is nothing to listen on).
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import logging
import signal
import sys
from argparse import ArgumentParser
from collections.abc import AsyncIterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import msgspec
from aiohttp import WSMsgType, web
from aiohttp.http import HttpProcessingError

from woz_tui.network.certificates import AccessError, Authority
from woz_tui.network.listen_address import ListenAddress
from woz_tui.protocol import codec
from woz_tui.protocol.requests import AskAbout, AskStop, AskTakeOver, Beat, Hello, Reply, Request
from woz_tui.remote.parent_lines import announce, standard_input
from woz_tui.system.clock import Clock, RealClock
from woz_tui.system.tasks import until_first_ends

#: Role of a certificate -> what it may say hello as.
MAY_BE: Mapping[str, tuple[str, ...]] = {
    "wizard": ("wizard", "watcher", "participant"),
    "program": ("program", "watcher"),
    "watcher": ("watcher",),
    "participant": ("participant",),
}
#: Role of a certificate -> how it joins.
JOINS_BY: Mapping[str, str] = {
    "wizard": "join with `woz attach`",
    "program": "join with `woz attach --watch` or a command such as `woz bml`",
    "watcher": "join with `woz attach --watch`",
    "participant": "join with `woz attach --questionnaire`",
}
#: What everybody is called who comes from this machine without a certificate.
LOCAL = "local"
#: Seconds from one ping to the next; one that is not answered in half of it ends the connection.
HEARTBEAT_S = 2.0
#: How often it is seen whose certificate was revoked, in seconds.
LOOK_S = 1.0
#: Requests a second that one connection may send, and how many at once after a pause. A stop and a
#: beat do not count.
REQUESTS_S, BURST = 200.0, 400.0
#: Connections at the same time: of one name, and of all.
MOST_OF_ONE, MOST = 16, 64
#: Bytes read at once from the session; a line from it may be longer than one to it.
_READ = 1 << 16
_LONGEST_LINE = 16 * codec.MAX_LINE
#: A refusal of the same name for the same reason is told once in so many seconds.
_REFUSED_AGAIN_S = 30.0

log = logging.getLogger(__name__)


def _is_ours(record: logging.LogRecord) -> bool:
    """Whether it tells a failure of ours: what is no request at all is answered, and none."""
    raised = record.exc_info[1] if record.exc_info else None
    return not isinstance(raised, HttpProcessingError)


class StrangerError(Exception):
    """This client is not let in; the text says why."""


class RequestRate:
    """So many requests a second, and some more at once after a pause."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._left, self._seen_us = BURST, clock.now_us()

    def takes(self) -> bool:
        """Whether one more may come now."""
        now = self._clock.now_us()
        self._left = min(BURST, self._left + (now - self._seen_us) / 1e6 * REQUESTS_S)
        self._seen_us = now
        if self._left < 1:
            return False
        self._left -= 1
        return True


class RequestFilter:
    """What one client may ask, before the session sees it."""

    def __init__(self, name: str, role: str, clock: Clock) -> None:
        self._name = name
        self._role = role
        self._clock = clock
        self._rate = RequestRate(clock)

    def passed(self, line: bytes) -> tuple[bytes, Reply | None]:
        """What goes on to the session instead of `line`, and an answer that is given here."""
        if len(line) > codec.MAX_LINE:
            return b"", Reply(ref=0, ok=False, reason=f"a line has at most {codec.MAX_LINE} bytes")
        try:
            request = codec.decode_request(line)
        except codec.WireError as error:
            hint = "docs/reference/protocol.md"
            return b"", Reply(ref=codec.ref_of(line), ok=False, reason=str(error), hint=hint)
        reason = self._refusal(request)
        if reason:
            hint = JOINS_BY[self._role] if isinstance(request, Hello) else ""
            return b"", Reply(ref=request.ref, ok=False, reason=reason, hint=hint)
        if isinstance(request, Hello):
            request = msgspec.structs.replace(request, via=self._name)
        elif not request.sent_us:
            # How long it was under way is not known: it counts from here.
            request = msgspec.structs.replace(request, sent_us=self._clock.boot_us())
        return codec.encode(request), None

    def _refusal(self, request: Request) -> str:
        if isinstance(request, AskStop | Beat):
            return ""
        if not self._rate.takes():
            return f"too many requests: {REQUESTS_S:.0f} a second are the most"
        if isinstance(request, Hello) and request.role not in MAY_BE[self._role]:
            may_be = " or ".join(MAY_BE[self._role])
            return f"{self._name} may be {may_be} here, not {request.role} (session: access)"
        if isinstance(request, AskAbout):
            return "only programs on the robot's computer are told this without a hello"
        if isinstance(request, AskTakeOver) and self._role != "wizard":
            return f"{self._name} may not play the robot: the experiment says {self._role}"
        return ""


@dataclass(frozen=True, slots=True, eq=False)
class _Guest:
    """One connection. `serial` of the certificate; empty: one of this machine, without TLS."""

    name: str
    role: str
    serial: str
    transport: asyncio.Transport | None


class AccessServer:
    """Lets clients from other machines in.

    Args:
        session: The session's socket.
        authority: Says whose certificate it is.
        clock: This machine's.
    """

    def __init__(self, session: Path, authority: Authority, clock: Clock | None = None) -> None:
        self._clock = clock or RealClock()
        #: Name -> role, of the experiment file.
        self.roles: Mapping[str, str] = {}
        self._session = session
        self._authority = authority
        self._guests: set[_Guest] = set()
        self._watching: asyncio.Task[None] | None = None
        self._refused_us: dict[tuple[str, str], int] = {}
        self._runner: web.AppRunner | None = None

    async def listen(self, address: ListenAddress) -> str:
        """Begin to listen; returns the address. Raises `AccessError` or `OSError`."""
        context = None if address.plain else self._authority.context()
        application = web.Application()
        application.add_routes(
            [web.get("/session", self._serve_session), web.get("/clock", self._serve_clock)]
        )
        http_log = log.getChild("http")
        http_log.addFilter(_is_ours)
        self._runner = web.AppRunner(
            application,
            access_log=None,
            handle_signals=False,
            logger=http_log,
            lingering_time=0,  # whoever sends a body, which nothing here takes, is cut off
        )
        await self._runner.setup()
        site = web.TCPSite(
            *(self._runner, address.host or None, address.port), ssl_context=context, backlog=32
        )
        await site.start()
        self._watching = asyncio.create_task(self._watch())
        host, port = self._runner.addresses[0][:2]
        return f"[{host}]:{port}" if ":" in host else f"{host}:{port}"

    async def close(self) -> None:
        if self._watching is not None:
            self._watching.cancel()
        if self._runner is not None:
            await self._runner.cleanup()

    def adopt(self, roles: Mapping[str, str]) -> None:
        """The experiment gives these roles from now on. Who has another one has to come anew."""
        self.roles = roles
        self._cut_off()

    # -- who comes in ------------------------------------------------------------------------

    def _guest(self, request: web.Request) -> _Guest:
        """Who that is. Raises `StrangerError`."""
        transport = request.transport
        certificate = transport.get_extra_info("peercert") if transport is not None else None
        name, serial = LOCAL, ""
        if request.secure and not certificate:
            raise StrangerError("no certificate: `woz access new NAME` makes one on the robot")
        if certificate:
            subject = dict(pair for group in certificate["subject"] for pair in group)
            name, serial = subject["commonName"], certificate["serialNumber"]
            try:
                if self._authority.name_of(serial) != name:
                    raise StrangerError(self._authority.why_not(name, serial))
            except AccessError as error:
                raise StrangerError(str(error)) from error
        role = self.roles.get(name, "")
        if not role:
            raise StrangerError(
                f"{name} has no role: write under session: access what {name} may be, such as"
                f" `{name}: wizard`"
            )
        if request.headers.get("Origin"):
            raise StrangerError("a web page cannot connect")
        of_this_name = sum(guest.name == name for guest in self._guests)
        if of_this_name >= MOST_OF_ONE or len(self._guests) >= MOST:
            raise StrangerError(f"{name} has too many connections")
        return _Guest(name, role, serial, transport)

    async def _watch(self) -> None:
        while True:
            await asyncio.sleep(LOOK_S)
            self._cut_off()

    def _cut_off(self) -> None:
        """End connections of certificates that were revoked, and of those with another role now."""
        for guest in tuple(self._guests):
            counts = True
            if guest.serial:
                with contextlib.suppress(AccessError):
                    counts = self._authority.name_of(guest.serial) == guest.name
            if (not counts or self.roles.get(guest.name) != guest.role) and guest.transport:
                guest.transport.abort()

    def _announce_refusal(self, who: str, why: str) -> None:
        now, last = self._clock.now_us(), self._refused_us.get((who, why))
        if last is not None and now < last + _REFUSED_AGAIN_S * 1e6:
            return
        if len(self._refused_us) > MOST:
            self._refused_us.clear()
        self._refused_us[who, why] = now
        announce(refused=f"{who}: {why}")

    @contextlib.asynccontextmanager
    async def _websocket(
        self, request: web.Request
    ) -> AsyncIterator[tuple[web.WebSocketResponse, _Guest]]:
        """A connection of somebody who is let in, counted while it is open."""
        try:
            guest = self._guest(request)
        except StrangerError as error:
            self._announce_refusal(str(request.remote), str(error))
            raise web.HTTPForbidden(text=str(error)) from None
        socket = web.WebSocketResponse(
            heartbeat=HEARTBEAT_S, compress=False, max_msg_size=2 * codec.MAX_LINE, timeout=0.2
        )
        if not socket.can_prepare(request):
            raise web.HTTPBadRequest(text="this is for WebSocket; see docs/how-to/network.md")
        self._guests.add(guest)
        try:
            await socket.prepare(request)
            yield socket, guest
        finally:
            self._guests.discard(guest)

    # -- paths ---------------------------------------------------------------------------------

    async def _serve_clock(self, request: web.Request) -> web.StreamResponse:
        async with self._websocket(request) as (socket, guest):
            await socket.send_json(
                {"session": self._session.stem, "name": guest.name, "role": guest.role}
            )
            async for message in socket:
                if message.type is not WSMsgType.TEXT or len(message.data) > 64:
                    break
                await socket.send_json({"asked": message.data, "boot_us": self._clock.boot_us()})
        return socket

    async def _serve_session(self, request: web.Request) -> web.StreamResponse:
        async with self._websocket(request) as (socket, guest):
            try:
                reader, writer = await asyncio.open_unix_connection(
                    self._session, limit=_LONGEST_LINE
                )
            except OSError:
                await socket.close(code=1011, message=b"the robot process has ended")
                return socket
            requests = RequestFilter(guest.name, guest.role, self._clock)
            try:
                await until_first_ends(
                    self._inward(socket, writer, requests), _outward(reader, socket)
                )
            except ConnectionError:
                pass
            except Exception:
                log.exception("the connection of %s ended", guest.name)
            finally:
                writer.close()
        await socket.close()
        return socket

    async def _inward(
        self, socket: web.WebSocketResponse, writer: asyncio.StreamWriter, requests: RequestFilter
    ) -> None:
        async for message in socket:
            if message.type is not WSMsgType.TEXT:
                return
            for line in message.data.encode("utf-8", "surrogatepass").split(b"\n"):
                if line.strip():
                    passed, answer = requests.passed(line)
                    writer.write(passed)
                    if answer is not None:
                        await socket.send_str(codec.encode(answer).decode())
            await writer.drain()


async def _outward(reader: asyncio.StreamReader, socket: web.WebSocketResponse) -> None:
    """Whole lines, as many at once as have come."""
    rest = b""
    while data := await reader.read(_READ):
        whole, newline, rest_now = data.rpartition(b"\n")
        if not newline:
            rest += data
            continue
        await socket.send_str((rest + whole + newline).decode("utf-8", "replace"))
        rest = rest_now


# -- the process -----------------------------------------------------------------------------------


async def _serve(session: Path, address: ListenAddress) -> int:
    server = AccessServer(session, Authority())
    parent = await standard_input()
    try:
        first = await parent.readline()
        if not first:
            return 0
        server.adopt(json.loads(first)["roles"])
        announce(listening=await server.listen(address))
        while line := await parent.readline():
            server.adopt(json.loads(line)["roles"])
    except (AccessError, OSError) as error:
        announce(trouble=str(error))
        return 1
    finally:
        await server.close()
    return 0


def main(arguments: Sequence[str] | None = None) -> int:
    """Serve until standard input ends."""
    parser = ArgumentParser()
    parser.add_argument("--session", type=Path, required=True)
    parser.add_argument("--listen", type=ListenAddress.read, required=True)
    options = parser.parse_args(arguments)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the robot process decides
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    return asyncio.run(_serve(options.session, options.listen))


if __name__ == "__main__":
    sys.exit(main())
