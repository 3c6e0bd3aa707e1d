"""A session on another machine, as if it ran on this one: a socket here, its lines go there.

`woz attach --access FILE` starts it; while it runs, every program of this machine that can use a
local session can use that one. Requests are stamped with the time of the robot's computer, which is
asked again and again: the robot process refuses what was under way for too long, whatever the
network did with it. When the network is gone so is the socket, until the network is back.

It ends with standard input. Standard output has one JSON object a line: `socket` when the session
can be used, `trouble` (a sentence) when it cannot, with `reached` if the robot's computer is there.
"""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import os
import signal
import ssl
import sys
from argparse import ArgumentParser
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import aiohttp
import msgspec

from woz_tui.network.certificates import SERVER_NAME, AccessError, AccessFile
from woz_tui.network.clock_offset import ClockComparison, ClockOffset
from woz_tui.protocol import codec
from woz_tui.remote.parent_lines import announce, standard_input
from woz_tui.system import session_sockets
from woz_tui.system.clock import Clock, RealClock, boot_id
from woz_tui.system.tasks import end_tasks, until_first_ends

#: Connecting may take so long, and an answer of the other clock, in seconds.
_CONNECT_S, _ANSWER_S = 5.0, 3.0
#: The other clock is asked so often at first, later so often, in seconds.
_ASK_FIRST_S, _ASK_S, _ASK_FIRST = 0.1, 1.0, 5
_RETRY_S = 1.0
#: Seconds from one ping to the next; one that is not answered in half of it ends the connection.
_HEARTBEAT_S = 2.0
_READ = 1 << 16
#: How the other side closes a connection that it ends itself.
_CLOSED_THERE = (aiohttp.WSCloseCode.OK, aiohttp.WSCloseCode.GOING_AWAY)
_LONGEST_LINE = 16 * codec.MAX_LINE


class LineTranslator:
    """Gives lines the time of the machine that they go to. `address`: the robot's computer."""

    def __init__(self, address: str, clocks: ClockComparison, clock: Clock) -> None:
        self._address = address
        self._clocks = clocks
        self._clock = clock

    def request(self, line: bytes) -> bytes:
        """One to the robot, with `sent_us` in its time; a line that is none goes as it is."""
        with contextlib.suppress(codec.WireError):
            request = codec.decode_unknown(line)
            sent = request.get("sent_us") or self._clock.boot_us()
            if isinstance(sent, int):
                request["sent_us"] = max(1, self._clocks.best.there(sent))
            return msgspec.json.encode(request)
        return line

    def answer(self, line: bytes) -> bytes:
        """One from the robot. By the `boot_id` of the welcome a client knows that it may stamp its
        requests with the time of this machine, by `robot_at` that a network is between. Sound tells
        when it was sent, in the time of this machine.
        """
        if line.startswith(b'{"kind":"welcome"'):
            welcome = codec.decode_unknown(line)
            return msgspec.json.encode({**welcome, "boot_id": boot_id(), "robot_at": self._address})
        if line.startswith(b'{"kind":"sound"'):
            sound = codec.decode_unknown(line)
            if isinstance(sent := sound.get("sent_us"), int):
                return msgspec.json.encode({**sound, "sent_us": self._clocks.best.here(sent)})
        return line


class RemoteSessionError(Exception):
    """The session cannot be used at the moment; the text says why. `final`: nor later. `reached`:
    its computer was reached, and nobody listens there.
    """

    def __init__(self, text: str, *, final: bool = False, reached: bool = False) -> None:
        super().__init__(text)
        self.final = final
        self.reached = reached


class RemoteSession:
    """Keeps the local socket for as long as the other machine can be reached.

    Args:
        access: What lets us in.
        address: `host:port` of the robot's computer.
        clock: Ours.
    """

    def __init__(self, access: AccessFile, address: str, clock: Clock | None = None) -> None:
        self._address = address
        self._context = access.context()
        self._clock = clock or RealClock()
        self._clocks = ClockComparison()
        self._lines = LineTranslator(address, self._clocks, self._clock)
        self._client: aiohttp.ClientSession | None = None
        self._open: set[asyncio.Task[None]] = set()
        self._path: Path | None = None
        self._usable = asyncio.Event()

    async def usable(self) -> Path:
        """The local socket, as soon as the session can be joined there."""
        await self._usable.wait()
        assert self._path is not None
        return self._path

    async def run(self) -> None:
        """Serve until cancelled. Raises `RemoteSessionError` that is final."""
        while True:
            try:
                await self.connect_once()
            except RemoteSessionError as error:
                if error.final:
                    raise
                announce(trouble=str(error), reached=error.reached)
            await asyncio.sleep(_RETRY_S)

    async def connect_once(self) -> None:
        """Serve until the other machine is lost; raises `RemoteSessionError`, with why."""
        async with aiohttp.ClientSession() as client:
            self._client = client
            clock = await self._dial("/clock")
            try:
                async with asyncio.timeout(_ANSWER_S):
                    hello = await clock.receive_json()
                    self._clocks.forget()  # the robot's computer may have been started anew
                    for _ in range(_ASK_FIRST):
                        await self._ask(clock)
                        await asyncio.sleep(_ASK_FIRST_S)
                with self._listener(hello["session"]) as listener:
                    server = await asyncio.start_unix_server(
                        self._relay, sock=listener, limit=_LONGEST_LINE
                    )
                    self._usable.set()
                    announce(socket=str(self._path), name=hello["name"], role=hello["role"])
                    try:
                        while True:
                            async with asyncio.timeout(_ANSWER_S):
                                await self._ask(clock)
                            await asyncio.sleep(_ASK_S)
                    finally:
                        self._usable.clear()
                        server.close()
            except (TimeoutError, TypeError, KeyError, ValueError, aiohttp.ClientError) as error:
                if clock.close_code in _CLOSED_THERE:
                    raise RemoteSessionError(
                        f"{self._address} has ended the session's line", reached=True
                    ) from None
                silent = isinstance(error, TimeoutError)
                why = "{} does not answer" if silent else "the connection to {} broke"
                raise RemoteSessionError(why.format(self._address)) from None
            finally:
                await end_tasks(*self._open)

    async def _ask(self, clock: aiohttp.ClientWebSocketResponse[bool]) -> None:
        sent = self._clock.boot_us()
        await clock.send_str(str(sent))
        while (answer := await clock.receive_json())["asked"] != str(sent):
            pass
        self._clocks.add(ClockOffset.measured(sent, answer["boot_us"], self._clock.boot_us()))

    async def _dial(self, path: str) -> aiohttp.ClientWebSocketResponse[bool]:
        assert self._client is not None
        try:
            async with asyncio.timeout(_CONNECT_S):
                return await self._client.ws_connect(
                    f"wss://{self._address}{path}",
                    ssl=self._context,
                    server_hostname=SERVER_NAME,
                    heartbeat=_HEARTBEAT_S,
                    max_msg_size=_LONGEST_LINE,
                    timeout=aiohttp.ClientWSTimeout(ws_close=0.2),
                )
        except TimeoutError:
            raise RemoteSessionError(
                f"{self._address} does not answer; is the address right, and the network there?"
            ) from None
        except aiohttp.WSServerHandshakeError as error:
            raise RemoteSessionError(await self._refusal(path, error), final=True) from None
        except aiohttp.ClientConnectorCertificateError as error:
            raise RemoteSessionError(
                f"{self._address} is not the robot that this access file is for"
                f" ({error.certificate_error})",
                final=True,
            ) from None
        except (aiohttp.ClientError, ssl.SSLError, OSError) as error:
            cause = getattr(error, "os_error", error)
            if isinstance(cause, ConnectionRefusedError):
                raise RemoteSessionError(
                    f"no session listens at {self._address}", reached=True
                ) from None
            reason = getattr(cause, "strerror", None) or str(cause)
            raise RemoteSessionError(f"{self._address} cannot be reached: {reason}") from None

    async def _refusal(self, path: str, error: aiohttp.WSServerHandshakeError) -> str:
        """Why we are not let in, in the other's words."""
        assert self._client is not None
        with contextlib.suppress(aiohttp.ClientError, TimeoutError, OSError):
            async with self._client.get(
                f"https://{self._address}{path}",
                ssl=self._context,
                server_hostname=SERVER_NAME,
                timeout=aiohttp.ClientTimeout(total=_ANSWER_S),
            ) as answer:
                return f"{self._address} does not let us in: {(await answer.text())[:300]}"
        return f"{self._address} does not let us in: {error.status} {error.message}"

    # -- the local socket ----------------------------------------------------------------------

    @contextlib.contextmanager
    def _listener(self, session: str) -> Any:
        if self._path is None:
            self._path = self._free_path(session)
        try:
            listener = session_sockets.bind(self._path)
        except OSError as error:
            raise RemoteSessionError(str(error), final=True) from None
        own = session_sockets.inode(self._path)
        try:
            yield listener
        finally:
            listener.close()
            if session_sockets.inode(self._path) == own:
                self._path.unlink(missing_ok=True)

    def _free_path(self, session: str) -> Path:
        """Where nobody listens: several programs of this machine may have a line of their own."""
        host = self._address.rpartition(":")[0].strip("[]")
        word = "".join(sign if sign.isalnum() or sign in "-." else "-" for sign in host)
        before = None
        for number in itertools.count(1):
            more = f"-{number}" if number > 1 else ""
            try:
                path = session_sockets.socket_path(f"{session}@{word}{more}")
            except session_sockets.SessionSocketError as error:  # the other machine says its name
                raise RemoteSessionError(str(error), final=True) from error
            if not session_sockets.answers(path):
                return path
            if path == before:
                why = f"WOZ_SOCKET names {path}, where a session runs: unset it"
                raise RemoteSessionError(why, final=True)
            before = path
        raise AssertionError

    async def _relay(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        task = asyncio.current_task()
        assert task is not None
        self._open.add(task)
        try:
            peer = session_sockets.peer_uid(writer.get_extra_info("socket"))
            if peer != os.getuid() or not self._usable.is_set():
                return
            with contextlib.suppress(RemoteSessionError, ConnectionError, aiohttp.ClientError):
                other = await self._dial("/session")
                try:
                    await until_first_ends(
                        self._outward(reader, other), self._inward(other, writer)
                    )
                finally:
                    await other.close()
        except asyncio.CancelledError:
            # The line is lost. Python 3.11 would print that a task of its server was cancelled, on
            # the wizard's screen.
            pass
        finally:
            self._open.discard(task)
            writer.close()

    async def _outward(
        self, reader: asyncio.StreamReader, other: aiohttp.ClientWebSocketResponse[bool]
    ) -> None:
        while line := await reader.readline():
            await other.send_str(self._lines.request(line.rstrip(b"\n")).decode("utf-8", "replace"))

    async def _inward(
        self, other: aiohttp.ClientWebSocketResponse[bool], writer: asyncio.StreamWriter
    ) -> None:
        async for message in other:
            if message.type is not aiohttp.WSMsgType.TEXT:
                return
            for line in message.data.encode().split(b"\n"):
                if not line:
                    continue
                writer.write(self._lines.answer(line) + b"\n")
            await writer.drain()


async def _until_abandoned(session: RemoteSession) -> int:
    try:
        await until_first_ends(session.run(), (await standard_input()).read())
    except RemoteSessionError as error:
        announce(trouble=str(error), final=True)
        return 1
    return 0


def main(arguments: Sequence[str] | None = None) -> int:
    """Serve until standard input ends."""
    parser = ArgumentParser()
    parser.add_argument("--access", type=Path, required=True)
    parser.add_argument("--address", required=True)
    options = parser.parse_args(arguments)
    for number in (signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)  # who has started it decides
    try:
        session = RemoteSession(AccessFile.read(options.access), options.address)
        return asyncio.run(_until_abandoned(session))
    except (AccessError, OSError) as error:
        announce(trouble=str(error), final=True)
        return 1


if __name__ == "__main__":
    sys.exit(main())
