"""One robot behind a WebSocket: looks for it, reads it, notices the loss, connects again.

HTTP requests to the same robot go through `request`. The robot counts as there as long as anything
comes from it: it is asked with pings, since a cable that was pulled says nothing. When it is lost
the connection is broken off, so that nothing that lies in it is carried out late.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import os
import socket
import struct
from collections.abc import Awaitable, Callable, Coroutine, Mapping
from dataclasses import dataclass
from typing import Any

import aiohttp
import msgspec

from woz_tui.drivers.background import forget_outcome
from woz_tui.drivers.contract import DeviceLostError, DriverContext, DriverError, Health
from woz_tui.system.foreign_json import decode_foreign
from woz_tui.system.retry_pauses import RetryPauses
from woz_tui.system.tasks import end_tasks, wait_at_most

#: An attempt to connect may take so long, in seconds.
_CONNECT_S = 3.0
#: From one ping to the next, and the silence after which the robot is lost, in seconds.
_PING_S = 0.4
_SILENCE_S = 1.5
#: A message to a robot that takes no more may wait so long, in seconds.
_SEND_S = 1.0
#: The longest message that is read, in bytes: pictures are the longest.
_LONGEST_MESSAGE = 1 << 24
#: With this the socket is reset when it is closed, and what it still holds is thrown away.
_AT_ONCE = struct.pack("ii", 1, 0)

log = logging.getLogger(__name__)


class LateAnswerError(DriverError):
    """The robot has not answered a request in time: whether it does as asked, nobody knows."""


class AnswerError(DriverError):
    """The robot answered a request with an error.

    Attributes:
        status: Of HTTP, from 400 on.
    """

    def __init__(self, what: str, status: int) -> None:
        super().__init__(what, "look at the robot's own log")
        self.status = status


@dataclass(frozen=True, slots=True)
class WebPlace:
    """Where a robot's WebSocket is.

    Attributes:
        address: `host:port`, IPv6 in brackets.
        path: Begins with a slash.
        secure: Whether it is https and wss.
    """

    address: str
    path: str
    secure: bool = False


class WebSocketLine:
    """Keeps one WebSocket open for as long as it exists; everything runs in the event loop.

    `find()` gives the place, before each attempt; raises `DeviceLostError` if there is none yet.
    `get_ready()` is a coroutine that makes the robot ready after each opening, while its messages
    arrive already; it returns what is shown of the connected robot. When it raises `DriverError`
    the robot is lost for that reason. `on_message(message)` gets each decoded JSON message; one
    that makes it raise `ValueError` (`msgspec.ValidationError` is one) is reported and left out.
    `on_lost(error)` is called once for each opening that ended, before the next one.
    """

    def __init__(
        self,
        context: DriverContext,
        shown: str,
        find: Callable[[], Awaitable[WebPlace]],
        *,
        get_ready: Callable[[], Coroutine[Any, Any, str]],
        on_message: Callable[[Any], None],
        on_lost: Callable[[DeviceLostError], None],
        headers: Mapping[str, str] | None = None,
    ) -> None:
        self._context = context
        self._shown = shown
        self._find = find
        self._get_ready = get_ready
        self._on_message = on_message
        self._on_lost = on_lost
        self._headers = headers
        self._session: aiohttp.ClientSession | None = None
        self._socket: aiohttp.ClientWebSocketResponse[bool] | None = None
        self._base = ""
        self._ready = False
        self._trouble = DeviceLostError(f"{shown} is not connected yet", "wait until it is there")
        #: Ends the present connection with its error.
        self._broken: asyncio.Future[None] | None = None
        self._task: asyncio.Task[None] | None = None
        #: Loop time at which the robot was last heard.
        self._heard = 0.0
        self._pongs: dict[bytes, asyncio.Future[None]] = {}
        self._pings = 0
        self._misunderstood = False
        self._was_ready = False

    @property
    def ready(self) -> bool:
        """Whether the robot is connected, and `get_ready` is through."""
        return self._ready

    def need(self) -> None:
        """Raise `DeviceLostError` with the present reason unless the robot is connected."""
        self._open_socket()

    def start(self) -> None:
        """Begin to look for the robot; returns at once. Needs a running event loop."""
        self._context.health(Health.CONNECTING, f"connecting to {self._shown}")
        self._task = asyncio.create_task(self._keep_open(), name=f"line to {self._shown}")
        self._task.add_done_callback(self._failed)

    async def close(self) -> None:
        """Stop looking and let go of the robot."""
        task, self._task = self._task, None
        if task is not None:
            await end_tasks(task)
            self._trouble = DeviceLostError(f"{self._shown} was let go", "start the session again")

    # -- for the driver ------------------------------------------------------------------------

    async def send(self, message: Any) -> None:
        """Send a message. Raises `DeviceLostError`; a robot that takes none is lost with that."""
        opened = self._open_socket()
        text = msgspec.json.encode(message).decode()
        try:
            async with asyncio.timeout(_SEND_S):
                await opened.send_str(text)
        except (TimeoutError, ConnectionError, RuntimeError) as error:
            raise self._break(error) from error

    async def probe(self, within: float = _SILENCE_S) -> None:
        """Return when the robot has answered a ping that is sent now: do this before anything that
        must not happen late, such as driving.

        Raises:
            DeviceLostError: The robot is not connected, or was lost meanwhile.
            DriverError: It did not answer within `within` seconds.
        """
        opened = self._open_socket()
        self._pings += 1
        payload = str(self._pings).encode()
        loop = asyncio.get_running_loop()
        due = loop.time() + within
        pong = self._pongs[payload] = loop.create_future()
        pong.add_done_callback(forget_outcome)  # it may come when nobody waits any more
        try:
            async with asyncio.timeout_at(due):
                await opened.ping(payload)
            await wait_at_most([pong], due - loop.time())
            if not pong.done():
                raise TimeoutError
            pong.result()
        except TimeoutError:
            raise DriverError(
                f"{self._shown} did not answer within {within:g} s",
                "look at its network; try again",
            ) from None
        except (ConnectionError, RuntimeError) as error:
            raise self._break(error) from error
        finally:
            self._pongs.pop(payload, None)

    async def request(
        self,
        method: str,
        path: str,
        *,
        json: Any = None,
        data: Any = None,
        params: Mapping[str, str] | None = None,
        within: float = 2.0,
    ) -> Any:
        """The decoded JSON answer to an HTTP request to the same place, None if it is empty.

        Raises:
            DeviceLostError: The robot is not connected, or was lost meanwhile.
            AnswerError: It answered with an error.
            LateAnswerError: It did not answer within `within` seconds.
            DriverError: It broke this request off, or answered with what is no JSON.
        """
        self._open_socket()
        assert self._session is not None
        try:
            async with self._session.request(
                method,
                self._base + path,
                json=json,
                data=data,
                params=params,
                timeout=aiohttp.ClientTimeout(total=within),
            ) as answer:
                body = await answer.read()
        except TimeoutError:
            raise LateAnswerError(
                f"{self._shown} did not answer {path} within {within:g} s", "try again"
            ) from None
        except (aiohttp.ClientError, ConnectionError, RuntimeError) as error:
            if self._socket is None:
                raise DeviceLostError(self._trouble.what, self._trouble.remedy) from error
            raise DriverError(
                f"{self._shown} did not answer {path}: {failure_reason(error)}", "try again"
            ) from error
        if answer.status >= 400:
            words = body.decode("utf-8", "replace").strip()[:200]
            raise AnswerError(f"{self._shown} refused {path}: {words}", answer.status)
        if not body:
            return None
        try:
            return decode_foreign(body)
        except ValueError:
            raise DriverError(
                f"{self._shown} answered {path} with something else than JSON",
                "check the address: is this the robot?",
            ) from None

    def lose(self, error: DeviceLostError) -> None:
        """The robot is of no use although its line is there: end the present connection."""
        if self._broken is not None and not self._broken.done():
            self._broken.set_exception(error)

    # -- opening and losing --------------------------------------------------------------------

    def _open_socket(self) -> aiohttp.ClientWebSocketResponse[bool]:
        if self._socket is None:
            raise DeviceLostError(self._trouble.what, self._trouble.remedy)
        return self._socket

    def _break(self, error: BaseException) -> DeviceLostError:
        """End the present connection; returns why, or why it has ended already."""
        if self._socket is None or self._broken is None:
            return DeviceLostError(self._trouble.what, self._trouble.remedy)
        why = DeviceLostError(
            f"{self._shown} did not take a message: {str(error) or 'it does not answer'}",
            "look at the robot and its network; it is connected again by itself",
        )
        self.lose(why)
        return why

    async def _keep_open(self) -> None:
        pauses = RetryPauses()
        while True:
            try:
                await self._one_connection()
            except DriverError as error:
                self._trouble = DeviceLostError(error.what, error.remedy)
                self._context.health(Health.LOST, error.what, error.remedy)
            await asyncio.sleep(pauses.after(self._was_ready))

    async def _one_connection(self) -> None:
        """Connect, and end with the `DriverError` that says why the robot is lost."""
        self._was_ready = False
        place = await self._find()
        web, sockets = ("https", "wss") if place.secure else ("http", "ws")
        async with aiohttp.ClientSession(
            headers=self._headers, connector=resetting_connector()
        ) as session:
            opened = await self._connect(session, f"{sockets}://{place.address}{place.path}")
            self._session, self._socket = session, opened
            self._base = f"{web}://{place.address}"
            self._heard = asyncio.get_running_loop().time()
            self._misunderstood = False
            self._broken = asyncio.get_running_loop().create_future()
            try:
                await self._serve(opened, self._broken)
            except DriverError as error:
                self._trouble = DeviceLostError(error.what, error.remedy)
                raise
            finally:
                self._was_ready, self._ready = self._ready, False
                self._session = self._socket = self._broken = None
                for pong in self._pongs.values():
                    if not pong.done():
                        pong.set_exception(ConnectionError("the connection was lost"))
                self._on_lost(self._trouble)
                await opened.close()  # without waiting: see `ws_close` below

    async def _connect(
        self, session: aiohttp.ClientSession, url: str
    ) -> aiohttp.ClientWebSocketResponse[bool]:
        try:
            async with asyncio.timeout(_CONNECT_S):
                return await session.ws_connect(
                    url,
                    autoping=False,
                    max_msg_size=_LONGEST_MESSAGE,
                    timeout=aiohttp.ClientWSTimeout(ws_close=0.1),
                )
        except TimeoutError:
            raise DeviceLostError(
                f"{self._shown} does not answer", "switch it on; check its address and the network"
            ) from None
        except aiohttp.WSServerHandshakeError as error:
            shown = url.partition("?")[0]  # what follows may hold a token
            raise DeviceLostError(
                f"{self._shown} answers, but offers no {shown}: {error.status} {error.message}",
                "check the address and port: is this the robot, and does its software run?",
            ) from None
        except (aiohttp.ClientError, OSError) as error:
            raise DeviceLostError(
                f"{self._shown} cannot be reached: {failure_reason(error)}",
                "check its address, that it is switched on and that its software runs",
            ) from None

    async def _serve(
        self, opened: aiohttp.ClientWebSocketResponse[bool], broken: asyncio.Future[None]
    ) -> None:
        """Read, ask and make ready until one of the three, or `broken`, says that it is lost."""
        every: tuple[asyncio.Future[None], ...] = (
            broken,
            asyncio.create_task(self._read(opened), name=f"reading {self._shown}"),
            asyncio.create_task(self._watch(opened), name=f"watching {self._shown}"),
            asyncio.create_task(self._make_ready(), name=f"making {self._shown} ready"),
        )
        going = {*every}
        try:
            while True:
                done, going = await asyncio.wait(going, return_when=asyncio.FIRST_COMPLETED)
                for task in done:
                    task.result()
        finally:
            for task in going:
                task.cancel()
            # Also those that ended in the same moment as the one whose error is told.
            await asyncio.gather(*every, return_exceptions=True)

    async def _make_ready(self) -> None:
        detail = await self._get_ready()
        self._ready = True
        self._context.health(Health.CONNECTED, detail)

    async def _read(self, opened: aiohttp.ClientWebSocketResponse[bool]) -> None:
        loop = asyncio.get_running_loop()
        while True:
            message = await opened.receive()
            self._heard = loop.time()
            match message.type:
                case aiohttp.WSMsgType.TEXT | aiohttp.WSMsgType.BINARY:
                    self._deliver(message.data)
                case aiohttp.WSMsgType.PING:
                    with contextlib.suppress(ConnectionError):
                        await opened.pong(message.data)
                case aiohttp.WSMsgType.PONG:
                    pong = self._pongs.get(bytes(message.data))
                    if pong is not None and not pong.done():
                        pong.set_result(None)
                case _:
                    raise DeviceLostError(
                        f"{self._shown} was lost: {_end_of(message)}",
                        "it is connected again by itself when it is back",
                    )

    def _deliver(self, data: str | bytes) -> None:
        try:
            self._on_message(decode_foreign(data))
        except ValueError as error:
            log.info("%s sent %.200r: %s", self._shown, data, error)
            if not self._misunderstood:
                self._misunderstood = True
                self._context.notice(
                    "warning",
                    f"{self._shown} sends what this program does not understand: {error}",
                    "compare the version of its software with the robot's page in docs",
                )

    async def _watch(self, opened: aiohttp.ClientWebSocketResponse[bool]) -> None:
        """Ask in the silence; raise `DeviceLostError` when nothing has come for too long."""
        loop = asyncio.get_running_loop()
        while True:
            asked = loop.time()
            with contextlib.suppress(TimeoutError, ConnectionError):
                async with asyncio.timeout(_PING_S):
                    await opened.ping()
            await asyncio.sleep(_PING_S)
            now = loop.time()
            if now - asked > _SILENCE_S:
                # This process itself stood still: what has come meanwhile is not read yet.
                self._heard = now
            elif now - self._heard > _SILENCE_S:
                raise DeviceLostError(
                    f"{self._shown} has not answered for {now - self._heard:.1f} s",
                    "look at the robot and its network; it is connected again by itself",
                )

    def _failed(self, task: asyncio.Task[None]) -> None:
        """A mistake of ours must not end the line in silence."""
        error = None if task.cancelled() else task.exception()
        if error is not None:
            log.error("the line to %s ended", self._shown, exc_info=error)
            what = f"the connection ended because of an error in this program: {error!r}"
            self._trouble = DeviceLostError(what, "start the session again; please report it")
            self._context.health(Health.FAULTED, what, self._trouble.remedy)


def resetting_connector() -> aiohttp.TCPConnector:
    """Connections whose end throws away what has not been sent yet: nothing arrives late."""
    return aiohttp.TCPConnector(socket_factory=_resetting_socket)


def _resetting_socket(place: aiohttp.AddrInfoType) -> socket.socket:
    family, kind, protocol, _, _ = place
    made = socket.socket(family, kind, protocol)
    made.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, _AT_ONCE)
    return made


def failure_reason(error: BaseException) -> str:
    """Why a connection failed, in the system's words without the library's."""
    cause = getattr(error, "os_error", error)
    if isinstance(cause, socket.gaierror):
        return "no host is called so"
    number = getattr(cause, "errno", None)
    return os.strerror(number) if number else str(cause) or type(cause).__name__


def _end_of(message: Any) -> str:
    if message.type is aiohttp.WSMsgType.ERROR:
        return str(message.data)
    code, words = message.data, message.extra
    if isinstance(code, int):
        return f"it closed the connection ({code}{': ' + str(words) if words else ''})"
    return "the connection broke"
